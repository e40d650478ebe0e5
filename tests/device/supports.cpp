// Reactions, damping and gravity that changes, on the host-run device beside the reference backend.

#include "device/device_support.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// The largest difference of two records over the size of their forces.
double difference_of_reactions(const std::vector<Reaction>& expected, const std::vector<Reaction>& found) {
  REQUIRE(expected.size() == found.size());
  double size = 0, worst = 0;
  for (std::size_t k = 0; k < expected.size(); ++k)
    for (std::size_t c = 0; c < 3; ++c) {
      size = larger(size, std::abs(expected[k].force[c]));
      worst = larger(worst, std::abs(expected[k].force[c] - found[k].force[c]));
      worst = larger(worst, std::abs(expected[k].moment[c] - found[k].moment[c]));
    }
  REQUIRE(size > 0);
  return worst / size;
}

Mix pressed(int dimension) {
  Mix mix;
  mix.dimension = dimension;
  mix.close = true;
  mix.boundaries = std::string(R"({"all": "slip", "x_min": "stick", "y_max": "separate", "y_min": {"type":)"
                               R"("prescribed", "velocity": ["0.3+t", "0.1*x")") +
                   (dimension == 3 ? ", 0]}}" : "]}}");
  mix.more =
      std::string(R"(, "output": {"reactions": true}, "node_conditions": [{"type": "slip", "axis": "y", "lower": )") +
      (dimension == 2 ? "[0.2, 0.3], \"upper\": [0.3, 0.4]}]" : "[0.2, 0.1, 0.1], \"upper\": [0.3, 0.2, 0.4]}]");
  return mix;
}

void check(const Mix& mix) {
  if (!is_chosen_check()) return;
  INFO(mix.name());
  Scene reference(mix.text(), {"/backend=reference"});
  reference.run();
  for (const std::string precision : {"double", "float"}) {
    DeviceScene device(mix.text(), precision);
    device.run();
    CHECK(scene_difference(reference, device) <= device_bound(mix) * epsilon_of(precision));
    CHECK(difference_of_reactions(reference.simulation.backend().reactions(),
                                  device.simulation.backend().reactions()) <= 1e4 * epsilon_of(precision));
    CHECK(device.simulation.backend().contact_record().largest_penetration ==
          Approx(reference.simulation.backend().contact_record().largest_penetration)
              .epsilon(1e6 * epsilon_of(precision)));
  }
}

}  // namespace

TEST_CASE("reactions on the host-run device", "[device]") {
  check(pressed(2));
  check(pressed(3));
  for (const std::string order : {"first", "modified_last"}) {
    Mix mix = pressed(2);
    mix.transfer = R"({"type": "flip"})", mix.stress_update = order;
    mix.contact = R"({"type": "coulomb", "friction": 0.2})";
    check(mix);
  }
  for (const std::string filter : {R"({"type": "fmpm", "order": 3})", R"({"type": "xpic", "order": 3})"}) {
    Mix mix = pressed(2);
    mix.filter = filter;
    check(mix);
  }
}

TEST_CASE("damping and gravity that changes on the host-run device", "[device]") {
  for (const int dimension : {2, 3})
    for (const std::string transfer : {"apic", "flip"}) {
      Mix mix = pressed(dimension);
      mix.transfer = R"({"type": ")" + transfer + "\"}";
      mix.more += R"(, "damping": {"viscous": 3, "local": 0.4})";
      mix.overrides = {std::string(R"J(/gravity=["min(t/0.05,1)", -1.3)J") + (dimension == 3 ? ", 0.4]" : "]")};
      check_on_device(mix);
    }
}

TEST_CASE("grips on the host-run device", "[device]") {
  for (const int dimension : {2, 3})
    for (const std::string order : {"last", "modified_last"}) {
      Mix mix = pressed(dimension);
      mix.stress_update = order;
      const bool flat = dimension == 2;
      mix.more += std::string(R"(, "grips": [{"body": "a", "where": {"type": "half_space", "point": )") +
                  (flat ? "[0.22, 0], \"normal\": [1, 0]}" : "[0.22, 0, 0], \"normal\": [1, 0, 0]}") +
                  R"J(, "velocity": ["1.2+t-0.9*(y-0.4)", null)J" + (flat ? "]}]" : ", \"X\"]}]");
      check(mix);
      if (!flat) continue;
      mix.filter = R"({"type": "fmpm", "order": 3})";
      check(mix);
    }
}
