// Bodies that hold temperatures: heat through walls, from boxes of nodes and from dissipation, and what melts.

#include "parity/heat_scenes.hpp"

using namespace mpm;
using namespace mpm::test;

TEST_CASE("parity of temperature on every transfer and in every order", "[parity][temperature]") {
  const std::vector<std::string> shapes{"bspline_quadratic", "gimp", "bspline_cubic", "cpdi"};
  int accepted = 0;
  for (const std::string& transfer : variants(MPM_TRANSFER)) {
    Mix mix;
    mix.close = true, mix.transfer = transfer, mix.boundaries = boundaries(2, "slip");
    mix.shape = transfer_named(shapes[accepted % shapes.size()]), mix.stress_update = orders[accepted % orders.size()];
    mix = warm(mix);
    if (!is_accepted(mix)) continue;
    check_parity(mix);
    ++accepted;
  }
  CHECK(accepted > 6);
}

TEST_CASE("parity of temperature in 3-D and around an axis", "[parity][temperature]") {
  Mix deep = warm_and_close(3);
  deep.boundaries = boundaries(3, "slip");
  check_parity(deep);
  for (const std::string shape : {"bspline_quadratic", "linear"}) {
    Mix ring = warm_and_close(2);
    ring.shape = transfer_named(shape), ring.boundaries = boundaries(2, "slip");
    ring.transfer = transfer_named(shape == "linear" ? "flip" : "apic");
    ring.overrides.push_back(set("/grid/symmetry", "axisymmetric"));
    ring.overrides.push_back(set("/gravity", "[0, -1.3]"));
    check_parity(ring);
  }
}

TEST_CASE("parity of temperature at walls and in boxes of nodes", "[parity][temperature]") {
  Mix mix = warm_and_close(2);
  mix.transfer = transfer_named("flip"), mix.boundaries = boundaries(2, "stick");
  check_parity(mix);
  mix = warm_and_close(2);
  mix.boundaries = R"({"all": "slip", "x_min": "periodic", "x_max": "periodic", "y_max": "separate",
    "y_min": {"type": "prescribed", "velocity": ["0.3+t", "0.1*x"], "temperature": "40+5*x-t"}})";
  check_parity(mix);
  // Corners belong to two walls that are held at different temperatures.
  mix.boundaries = R"({"all": {"type": "stick", "temperature": 15}, "y_min": {"type": "slip", "temperature": 35}})";
  check_parity(mix);
  // Where two boxes and a wall hold the same node, the last one counts; a warmed one is shared by all fields.
  mix.boundaries = boundaries(2, "slip"), mix.contact = R"({"type": "coulomb", "friction": 0.2})";
  mix.more = R"(, "node_conditions": [
    {"type": "thermal", "temperature": "50+9*x-99*t", "lower": [0.2, 0.2], "upper": [0.4, 0.4]},
    {"type": "thermal", "heating": "900+9000*t-99*x", "lower": [0.3, 0.2], "upper": [0.8, 0.6]},
    {"type": "slip", "axis": "y", "heating": "2000", "lower": [0.5, 0.2], "upper": [0.6, 0.4]},
    {"type": "thermal", "temperature": 5, "lower": [0.1, 0.3], "upper": [0.3, 0.6]}])";
  check_parity(mix);
}

TEST_CASE("parity of melting, freezing and warming by dissipation", "[parity][temperature]") {
  for (const std::string order : {"last", "modified_last"}) {
    Mix mix;
    mix.close = true, mix.stress_update = order, mix.transfer = transfer_named(order == "last" ? "flip" : "apic");
    mix.material = material(plastic, R"(, "dissipation_to_heat": 0.9)" + melts + R"(, "yield_stress": 20}})");
    mix.boundaries = R"({"all": "slip", "x_min": {"type": "slip", "temperature": 60},
                         "x_max": {"type": "slip", "temperature": 0}})";
    check_parity(warm(mix));
  }
}

TEST_CASE("parity of a body that melts beside one that only conducts", "[parity][temperature]") {
  Mix mix = warm_and_close(2);
  mix.material = material(elastic, melts + "}}");
  mix.overrides.push_back(set("/materials/other", material(elastic)));
  mix.overrides.push_back(set("/bodies/1/material", "other"));
  mix.boundaries = R"({"all": "slip", "x_min": {"type": "slip", "temperature": 60}})";
  check_parity(mix);
}
