// Without a ledger momenta take what the forces and gravity add to them in the step, in one scatter, where nothing needs them
// apart: when that is so, and that particles go where they go otherwise.

#include "device/covering.hpp"
#include "support/results.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

const std::string no_ledger = R"(/output={"ledger": false})", falls = "/gravity=[0.7, -1.3]";

/// The names of those fields that a device keeps, of the ones that some scenes do without.
std::set<std::string> kept(Mix mix, const std::vector<std::string>& overrides) {
  for (const std::string& override : overrides) mix.overrides.push_back(override);
  const auto fields = device_choice_of(device_experiment(mix.text(), "double", mix.overrides)).node_fields;
  std::set<std::string> found;
  for (const std::string name : {"force", "weight", "velocity_before", "body_force"})
    if (device::number_of(fields, name) >= 0) found.insert(name);
  return found;
}

using Names = std::set<std::string>;

Mix merged_mix(int dimension, const std::string& gravity = falls) {
  Mix mix;
  mix.dimension = dimension, mix.close = true;
  mix.overrides = {no_ledger, dimension == 2 ? gravity : "/gravity=[0.7, -1.3, 0.4]"};
  return mix;
}

void check_merged(const Mix& mix, const std::vector<std::string>& precisions = {"double", "float"}) {
  INFO(mix.name());
  CHECK(kept(mix, {}).empty());
  check_on_device(mix, precisions);
}

}  // namespace

TEST_CASE("a device keeps forces, weights and the velocity before them where something needs them",
          "[device][merged]") {
  Mix mix;
  mix.overrides = {"/gravity=[0, 0]"};
  CHECK(kept(mix, {no_ledger}) == Names{});
  CHECK(kept(mix, {no_ledger, falls}) == Names{});
  CHECK(kept(mix, {}) == Names{"force", "velocity_before"});
  CHECK(kept(mix, {falls}) == Names{"force", "velocity_before", "weight"});
  Mix touching = mix;
  touching.contact = R"({"type": "coulomb", "friction": 0.2})";
  CHECK(kept(touching, {no_ledger, falls}) == Names{"force"});
  Mix walls = mix;
  walls.boundaries = R"({"all": "separate"})";
  CHECK(kept(walls, {no_ledger, falls}) == Names{"force"});
  Mix first = mix;
  first.stress_update = "first";
  CHECK(kept(first, {no_ledger, falls}) == Names{"force"});
  Mix filtered = mix;
  filtered.filter = R"({"type": "fmpm", "order": 2})";
  CHECK(kept(filtered, {no_ledger, falls}) == Names{"force"});
  Mix flip = mix;
  flip.transfer = R"({"type": "flip"})";
  CHECK(kept(flip, {no_ledger, falls}) == Names{"force", "velocity_before"});
  CHECK(kept(mix, {no_ledger, falls, R"(/body_force=["x", 1])"}) == Names{"force", "body_force"});
  CHECK(kept(mix, {no_ledger, R"(/damping={"viscous": 1})"}) == Names{"force", "velocity_before"});
}

TEST_CASE("forces that join the momenta move bodies as forces apart do, at every wall", "[device][merged]") {
  for (const int dimension : {2, 3})
    for (const std::string& boundaries :
         {std::string(R"({"all": "slip"})"), std::string(R"({"all": "stick", "y_max": "free"})"),
          std::string(R"({"all": "slip", "x_min": "periodic", "x_max": "periodic"})"),
          R"({"all": "slip", "y_min": {"type": "prescribed", "velocity": ["0.3+t", "0.1*x")" +
              std::string(dimension == 3 ? ", \"0.2*x\"]}}" : "]}}")}) {
      Mix mix = merged_mix(dimension);
      mix.boundaries = boundaries;
      if (dimension == 3) mix.transfer = R"({"type": "mls"})";
      check_merged(mix);
    }
}

TEST_CASE("forces that join the momenta do so in every order that lets them, on lists and around an axis",
          "[device][merged]") {
  Mix again = merged_mix(2);
  again.stress_update = "modified_last", again.shape = R"({"type": "bspline_cubic"})";
  check_merged(again);
  Mix lists = merged_mix(3);
  lists.shape = R"({"type": "cpdi"})";
  check_merged(lists, {"double"});
  Mix rings = merged_mix(2, set("/gravity", R"J([0, "-1.3*cos(9*t)"])J"));
  rings.overrides.push_back(set("/grid/symmetry", "axisymmetric"));
  check_merged(rings);
  Mix exact = merged_mix(2);
  exact.transfer = R"({"type": "polypic", "basis": "full"})", exact.overrides.push_back(deterministic_sums);
  check_merged(exact);
}

TEST_CASE("walls, boxes and grips give the same where forces join the momenta", "[device][merged]") {
  Mix held = merged_mix(2);
  held.boundaries = R"({"all": "slip", "y_min": "stick"})";
  held.overrides[0] = R"(/output={"ledger": false, "reactions": true})";
  held.more = R"(, "node_conditions": [{"lower": [0.2, 0.1], "upper": [0.4, 0.3], "type": "slip", "axis": "y"}])";
  check_merged(held);
  Mix gripped = held;
  gripped.overrides.push_back(
      R"(/grips=[{"body": "a", "where": {"type": "half_space", "point": [0.22, 0], "normal": [1, 0]}, "velocity": [1, 0.3]}])");
  check_merged(gripped);

  for (const Mix& mix : {held, gripped}) {
    std::vector<std::string> overrides = mix.overrides;
    for (const char* choice : {"/backend=reference", "/precision=double"}) overrides.emplace_back(choice);
    Scene reference(mix.text(), overrides);
    DeviceScene device(mix.text(), "double", {}, mix.overrides);
    while (!reference.simulation.finished()) reference.simulation.step();
    device.run();
    const std::vector<Reaction>&expected = reference.simulation.backend().reactions(),
          &found = device.simulation.backend().reactions();
    REQUIRE(found.size() == expected.size());
    double largest = 0;
    for (std::size_t k = 0; k < expected.size(); ++k)
      for (int c = 0; c < 2; ++c) largest = larger(largest, std::abs(expected[k].impulse[c]));
    CHECK(largest > 0);
    for (std::size_t k = 0; k < expected.size(); ++k) {
      INFO("support " << k);
      for (int c = 0; c < 3; ++c) {
        CHECK(std::abs(found[k].impulse[c] - expected[k].impulse[c]) <= 1e-11 * largest);
        CHECK(std::abs(found[k].moment[c] - expected[k].moment[c]) <= 1e-9 * largest);
      }
    }
  }
}
