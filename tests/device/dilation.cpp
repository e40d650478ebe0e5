// The mean dilation on the host-run device: against the reference backend, the same bits in any order of lanes where sums
// are deterministic, and a run that another backend goes on with.

#include "device/device_support.hpp"
#include "parity/heat_scenes.hpp"
#include "support/results.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

const std::string averaged = "/solver/dilation=averaged";

/// Every shape and transfer in turn, in every order of a step; walls, contact, a filter, an axis and three dimensions.
std::vector<Mix> mixes() {
  std::vector<Mix> all;
  const auto add = [&](Mix mix) {
    mix.overrides.push_back(averaged);
    REQUIRE(!is_refused(mix));
    all.push_back(mix);
  };
  const std::vector<std::string> shapes{"bspline_quadratic", "linear", "gimp", "cpdi"},
      transfers{"apic", "flip", "mls", "tpic"};
  for (std::size_t k = 0; k < orders.size(); ++k) {
    Mix mix;
    mix.shape = transfer_named(shapes[k]), mix.transfer = transfer_named(transfers[k]), mix.stress_update = orders[k];
    mix.close = true, mix.boundaries = R"({"all": "slip", "x_max": "stick", "y_max": "separate"})";
    if (k % 2 == 0) mix.contact = R"({"type": "coulomb", "friction": 0.2})";
    add(mix);
  }
  Mix filtered;
  filtered.transfer = transfer_named("pic"), filtered.filter = R"({"type": "fmpm", "order": 2, "every_steps": 2})";
  filtered.boundaries = R"({"all": "slip", "x_min": "periodic", "x_max": "periodic"})";
  add(filtered);
  Mix ring;
  ring.transfer = transfer_named("flip"), ring.stress_update = "averaged";
  ring.overrides = {set("/grid/symmetry", "axisymmetric"), set("/gravity", "[0, -1.3]")};
  add(ring);
  Mix deep;
  deep.dimension = 3, deep.stress_update = "first";
  add(deep);
  return all;
}

}  // namespace

TEST_CASE("the mean dilation on the host-run device is the reference backend's", "[device][dilation]") {
  const std::vector<Mix> all = mixes();
  for (std::size_t k = 0; k < all.size(); ++k) check_on_device(all[k], precisions_in_turn(false, k));
  Mix plain;
  plain.overrides = {averaged}, plain.more = R"(, "output": {"ledger": false})";
  check_on_device(plain, {"float"});
}

TEST_CASE("the mean dilation on the host-run device in both precisions", "[device][dilation][slow]") {
  for (const Mix& mix : mixes()) check_on_device(mix);
}

TEST_CASE("the mean dilation has the same bits in any order of lanes where sums are deterministic",
          "[device][dilation]") {
  Mix mix;
  mix.overrides = {averaged, deterministic_sums};
  const auto results = [&](const TeamShape& team) {
    DeviceScene scene(mix.text(), "double", team, mix.overrides);
    scene.run();
    return all_results(scene.simulation);
  };
  const std::vector<double> expected = results({});
  CHECK(different(expected, results({32, TeamShape::downwards})) == 0);
  CHECK(different(expected, results({32, TeamShape::shuffled(0)})) == 0);
}

TEST_CASE("a run with the mean dilation on the host-run device goes on from the reference backend's state",
          "[device][dilation]") {
  Mix mix;
  mix.overrides = {averaged}, mix.stress_update = "first", mix.transfer = transfer_named("flip");
  Scene reference(mix.text(), on_reference(mix));
  reference.run_steps(6);
  ArchiveWriter archive;
  reference.simulation.save(archive);
  DeviceScene device(mix.text(), "double", {}, mix.overrides);
  ArchiveReader reader(archive.bytes());
  device.simulation.restore(reader);
  device.run();
  while (!reference.simulation.finished()) reference.simulation.step();
  CHECK(scene_difference(reference, device) <= device_bound(mix) * epsilon_of("double"));
}
