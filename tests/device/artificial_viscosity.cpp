// Artificial viscosity on the host-run device: against the reference backend, the same bits in any order of lanes where sums
// are deterministic, and a run that goes on from another backend's state.

#include <algorithm>

#include "backends/device/compose.hpp"
#include "device/device_support.hpp"
#include "parity/heat_scenes.hpp"
#include "support/results.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

const std::string viscous = R"(/materials/m/artificial_viscosity={"linear": 0.5, "quadratic": 3})";

/// Every order of a step, contact, a filter, an axis, three dimensions, temperature, the mean dilation, and a body without.
std::vector<Mix> mixes() {
  std::vector<Mix> all;
  const auto add = [&](Mix mix) {
    mix.overrides.insert(mix.overrides.begin(), viscous);
    REQUIRE(is_accepted(mix));
    all.push_back(mix);
  };
  const std::vector<std::string> transfers{"flip", "mls", "apic", "tpic"};
  for (std::size_t k = 0; k < orders.size(); ++k) {
    Mix mix;
    mix.transfer = transfer_named(transfers[k]), mix.stress_update = orders[k];
    if (k % 2 == 0) mix.contact = R"({"type": "coulomb", "friction": 0.2})";
    if (k % 2 == 1) mix.overrides = {"/materials/n=" + Mix{}.material, R"(/bodies/1/material="n")"};
    add(mix);
  }
  Mix filtered;
  filtered.transfer = transfer_named("pic"), filtered.filter = R"({"type": "fmpm", "order": 2, "every_steps": 2})";
  filtered.overrides = {"/solver/dilation=averaged", set("/solver/time_step", "\"auto\"")};
  add(filtered);
  Mix ring;
  ring.transfer = transfer_named("flip");
  ring.overrides = {set("/grid/symmetry", "axisymmetric"), set("/gravity", "[0, -1.3]")};
  add(ring);
  Mix heated;
  heated.close = true, heated.boundaries = boundaries(2, "slip"), heated.dimension = 2;
  heated = warm(heated);
  heated.overrides.push_back("/materials/m/thermal/dissipation_to_heat=0.9");
  add(heated);
  Mix deep;
  deep.dimension = 3;
  add(deep);
  return all;
}

}  // namespace

TEST_CASE("artificial viscosity on the host-run device is the reference backend's", "[device][viscosity]") {
  const std::vector<Mix> all = mixes();
  for (std::size_t k = 0; k < all.size(); ++k)
    if (k != 2 && k != 3) check_on_device(all[k], precisions_in_turn(false, k));  // the slow case has these orders too
  Mix plain;
  plain.overrides = {viscous}, plain.more = R"(, "output": {"ledger": false})";
  check_on_device(plain, {"float"});
}

TEST_CASE("artificial viscosity on the host-run device in both precisions", "[device][viscosity][slow]") {
  for (const Mix& mix : mixes()) check_on_device(mix);
}

TEST_CASE("a run with artificial viscosity on the host-run device goes on from the reference backend's state",
          "[device][viscosity]") {
  Mix mix;
  mix.overrides = {viscous}, mix.transfer = transfer_named("flip");
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

TEST_CASE("only a scene with artificial viscosity has its fields and kernels on a device", "[device][viscosity]") {
  Mix with;
  with.overrides = {viscous};
  const Experiment none = experiment_from(Mix{}.text()), some = experiment_from(with.text(), with.overrides);
  const auto choice = [](const Experiment& experiment) { return device::choice_of(experiment, make_plan(experiment)); };
  const auto asks = [&](const Experiment& experiment) {
    const device::Composition made = device::compose(choice(experiment));
    return std::find(made.entries.begin(), made.entries.end(), "mpm_artificial_work") != made.entries.end();
  };
  CHECK(!asks(none));
  CHECK(asks(some));
  for (const char* field : {"artificial_pressure", "artificial_work"}) {
    CHECK(device::number_of(choice(none).particle_fields, field) < 0);
    CHECK(device::number_of(choice(some).particle_fields, field) >= 0);
  }
}
