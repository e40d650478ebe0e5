// Particles strained by the mean dilation around them: the backends against one another on every shape and transfer and in
// every order of a step, and a restored run.

#include <set>

#include "parity/heat_scenes.hpp"
#include "support/results.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

const std::string averaged = "/solver/dilation=averaged";

Mix averaged_mix(int dimension = 2) {
  Mix mix;
  mix.dimension = dimension, mix.overrides = {averaged};
  return mix;
}

Mix on_an_axis() {
  Mix mix = averaged_mix();
  mix.overrides.insert(mix.overrides.end(),
                       {set("/grid/symmetry", "axisymmetric"), set("/gravity", "[0, -1.3]"),
                        R"(/bodies/1/geometry={"type": "box", "lower": [0, -0.1], "upper": [0.21, 0.18]})",
                        R"(/bodies/1/velocity=["1.1*x", 0.7])"});
  return mix;
}

/// The largest difference of the volume ratios of two runs of a mix, one with each particle's own dilation.
double effect(const Mix& mix) {
  Mix own = mix;
  std::erase(own.overrides, averaged);
  Scene with(mix.text(), on_reference(mix)), without(own.text(), on_reference(own));
  with.run(), without.run();
  return difference(with.body().material_state.begin()->second, without.body().material_state.begin()->second, 1.0);
}

}  // namespace

TEST_CASE("parity of the mean dilation on every shape and transfer", "[parity][dilation]") {
  for (const int dimension : {2, 3}) {
    std::set<std::string> seen;  // each shape and each transfer once
    const std::vector<std::string> shapes = variants(MPM_SHAPE), transfers = variants(MPM_TRANSFER);
    for (std::size_t k = 0; k < std::max(shapes.size(), transfers.size()); ++k) {
      Mix mix = averaged_mix(dimension);
      mix.shape = shapes[k % shapes.size()], mix.transfer = transfers[k % transfers.size()];
      mix.stress_update = orders[k % orders.size()];
      for (std::size_t other = 1; is_refused(mix) && other < shapes.size(); ++other)
        mix.shape = shapes[(k + other) % shapes.size()];
      if (is_refused(mix)) mix.stress_update = "last";
      REQUIRE(!is_refused(mix));
      seen.insert(mix.shape), seen.insert(mix.transfer);
      check_parity(mix);
    }
    CHECK(seen.size() >= transfers.size() + 5);
  }
}

TEST_CASE("parity of the mean dilation in every order, with filters and contact", "[parity][dilation]") {
  for (const std::string& order : orders)
    for (const std::string filter :
         {"", R"({"type": "fmpm", "order": 2, "every_steps": 2})", R"({"type": "xpic", "order": 2})"})
      for (const std::string contact : {"", R"({"type": "coulomb", "friction": 0.2})"}) {
        Mix mix = averaged_mix();
        mix.stress_update = order, mix.filter = filter, mix.contact = contact;
        mix.transfer = transfer_named(filter.empty() ? "flip" : "pic");
        if (!is_refused(mix)) check_parity(mix);
      }
}

TEST_CASE("parity of the mean dilation at walls, around an axis and of temperature", "[parity][dilation]") {
  for (const std::string walls : {R"({"all": "stick"})", R"({"all": "separate"})",
                                  R"({"all": "slip", "x_min": "periodic", "x_max": "periodic",
            "y_min": {"type": "prescribed", "velocity": ["0.3+t", "0.1*x"]}})"})
    for (const std::string shape : {"bspline_cubic", "cpdi"}) {
      Mix mix = averaged_mix();
      mix.close = true, mix.boundaries = walls, mix.shape = transfer_named(shape);
      check_parity(mix);
    }
  for (const std::string& order : orders)
    for (const std::string transfer : {"flip", "mls"}) {
      Mix ring = on_an_axis();
      ring.stress_update = order, ring.transfer = transfer_named(transfer);
      check_parity(ring);
    }
  Mix heated = averaged_mix();
  heated.close = true, heated.boundaries = boundaries(2, "slip");
  check_parity(warm(heated));
  Mix plain = averaged_mix();
  plain.more = R"(, "output": {"ledger": false})";
  check_parity(plain);
}

TEST_CASE("parity of the mean dilation with loads, grips, damping and boxes of particles", "[parity][dilation]") {
  for (const std::string& order : orders)
    for (const std::string shape : {"bspline_quadratic", "gimp_contiguous"}) {
      Mix mix = averaged_mix();
      mix.stress_update = order, mix.shape = transfer_named(shape);
      mix.more = R"J(, "damping": {"viscous": 3, "local": 0.2}, "body_force": ["2*sin(3*X)+t", "x-Y*y"], "loads": [
        {"type": "pressure", "body": "a", "where": {"type": "half_space", "point": [0.31, 0], "normal": [1, 0.3]},
         "pressure": "400+100*sin(9*t)"},
        {"type": "spring", "body": "b", "where": {"type": "half_space", "point": [0.52, 0], "normal": [1, 0]},
         "stiffness": [2e3, 1e3], "damping": [50, 100]}],
        "grips": [{"body": "a", "where": {"type": "half_space", "point": [0.22, 0], "normal": [1, 0]},
                   "velocity": ["1.2+t", null]}])J";
      check_parity(mix);
    }
}

TEST_CASE("the mean dilation is another one in the scenes of parity", "[parity][dilation]") {
  CHECK(effect(averaged_mix()) > 1e-4);
  CHECK(effect(averaged_mix(3)) > 1e-4);
  CHECK(effect(on_an_axis()) > 1e-4);
}

TEST_CASE("a restored run with the mean dilation goes on bit for bit", "[parity][dilation]") {
  for (const std::string& order : orders)
    for (const std::string precision : {"double", "float"}) {
      Mix mix = averaged_mix();
      mix.stress_update = order, mix.contact = R"({"type": "coulomb", "friction": 0.2})";
      mix.overrides.insert(mix.overrides.end(), {set("/precision", precision), "/solver/end_time=0.9"});
      const std::string text = mix.text();
      CpuRun whole(text, mix.overrides, 1), resumed(text, mix.overrides, 2);
      whole.steps(7);
      ArchiveWriter archive;
      whole.simulation.save(archive);
      resumed.steps(3);
      ArchiveReader reader(archive.bytes());
      resumed.simulation.restore(reader);
      for (CpuRun* run : {&whole, &resumed}) run->steps(9);
      CHECK(different(all_results(whole.simulation), all_results(resumed.simulation)) == 0);
    }
}
