// Formulas that kernels evaluate at particles: every operation, the text that they are written as, and what it depends on.

#include "backends/device/particle_formulas.hpp"
#include "device/formula_scenes.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

Experiment pulled(const std::string& force, const std::vector<std::string>& more = {}) {
  std::vector<std::string> overrides{set("/body_force", force)};
  overrides.insert(overrides.end(), more.begin(), more.end());
  return device_experiment(Mix{}.text(), "double", overrides);
}

device::Composition composition_of(const Experiment& experiment) {
  return device::compose(device_choice_of(experiment));
}

}  // namespace

TEST_CASE("every operation of a formula gives particles on the host-run device what it gives on the reference backend",
          "[device][formulas]") {
  for (const int dimension : {2, 3}) {
    const std::vector<std::string> formulas = every_operation(dimension);
    CHECK(operations_without(formulas).empty());
    const Mix mix = mix_with_every_operation(dimension);
    // What a formula gives must show: each one alone accelerates some particle by more than any bound lets pass.
    const Experiment experiment = device_experiment(mix.text(), "double");
    DeviceScene start(mix.text(), "double");
    const BodyState body = start.body(1);
    const auto D = static_cast<std::size_t>(dimension);
    for (const std::string& formula : formulas) {
      const VectorExpression::Term term = formula;
      const VectorExpression expression({&term, 1}, {});
      double largest = 0, smallest = 1;
      for (std::size_t p = 0; p < body.position.size() / D; ++p) {
        Vector3 x{};
        std::copy_n(body.position.begin() + static_cast<std::ptrdiff_t>(p * D), D, x.begin());
        const double value = std::abs(expression(x, x, 0.05)[0]);
        largest = larger(largest, value), smallest = smaller(smallest, value);
      }
      INFO(formula);
      CHECK(largest > 0.05);
      if (formula.find("= 4") != formula.npos) CHECK(smallest == 0);  // both outcomes of a comparison occur
    }
    check_on_device(mix);
  }
}

TEST_CASE("a scene's program depends on the form of its formulas and not on the numbers in them",
          "[device][formulas]") {
  const auto hash = [](const std::string& force) { return composition_of(pulled(force)).hash; };
  const std::string first = hash(R"J(["2*sin(3*X)+t", "x-Y*y"])J");
  CHECK(first == hash(R"J(["0.5*sin(7*X)+t^2*exp(-t)", "x-Y*y"])J"));  // what the time makes is a number
  CHECK(first != hash(R"J(["2*cos(3*X)+t", "x-Y*y"])J"));
  CHECK(first != hash(R"J(["2*sin(3*x)+t", "x-Y*y"])J"));
  CHECK(hash("[1, 2]") == hash(R"(["5*t", -3])"));
  const device::Composition none = composition_of(device_experiment(Mix{}.text(), "double"));
  for (const std::string word : {" formula_0(", " acceleration([[", "\nMPM_DEVICE_BODY_FORCE_ENTRIES\n"}) {
    INFO(word);
    CHECK((none.text.find(word) == none.text.npos));
    CHECK((composition_of(pulled("[1, 2]")).text.find(word) != none.text.npos));
  }
}

TEST_CASE("formulas that differ in numbers alone share a function, and each has numbers of its own",
          "[device][formulas]") {
  const Experiment experiment = pulled(R"(["2*x", "3+t"])", {R"(/loads=[
      {"type": "body_force", "body": "a", "acceleration": ["5*x", "8-t"]},
      {"type": "body_force", "body": "b", "acceleration": [7, "y"]}])",
                                                             R"(/grips=[{"body": "a", "velocity": ["9*x", "t"],
      "where": {"type": "half_space", "point": [0.22, 0], "normal": [1, 0]}}])"});
  const device::ParticleFormulas formulas(experiment);
  CHECK(formulas.use_time());
  CHECK_FALSE(formulas.use_initial_position());
  CHECK(formulas.numbers(0.5, 0.75) ==
        std::vector<double>{2, 3.5, 5, 7.5, 7, 9, 0.75});  // a grip goes by the end of the step
  CHECK(formulas.count() == 7);
  const std::string text = formulas.text();
  CHECK(text.find("    formulas::add(sum, formula_0(x, X, numbers + 0));\n"
                  "    if (body == 0) formulas::add(sum, formula_0(x, X, numbers + 2));\n"
                  "    if (body == 1) formulas::add(sum, formula_1(x, X, numbers + 4));\n") != text.npos);
  CHECK(text.find("    if (grip == 0) return formula_0(x, X, numbers + 5);\n") != text.npos);
  CHECK(text.find("formula_2") == text.npos);
}

TEST_CASE("particles keep their first places on a device only where a formula asks for them", "[device][formulas]") {
  const auto keeps = [](const Experiment& experiment) {
    return device::number_of(device_choice_of(experiment).particle_fields, "initial_position") >= 0;
  };
  CHECK_FALSE(keeps(device_experiment(Mix{}.text(), "double")));
  CHECK_FALSE(keeps(pulled(R"(["x", "t"])")));
  CHECK(keeps(pulled(R"(["X", 0])")));
  // A formula of the second body alone: the first one has the field too, so that its numbers are those of all.
  Mix mix;
  mix.more = R"J(, "loads": [{"type": "body_force", "body": "b", "acceleration": ["9*(x-X)", "4*Y"]}])J";
  const Experiment experiment = device_experiment(mix.text(), "double");
  CHECK(keeps(experiment));
  check_on_device(mix);
}

TEST_CASE("forces by mass on rings, and with exact sums, on the host-run device", "[device][formulas]") {
  Mix rings;
  rings.overrides = {set("/grid/symmetry", "axisymmetric"), set("/gravity", "[0, -1.3]")};
  rings.more = R"J(, "body_force": ["2*sin(3*X)+t", "x-Y*y"])J";
  check_on_device(rings);
  rings.overrides.push_back(deterministic_sums);
  check_on_device(rings);
}
