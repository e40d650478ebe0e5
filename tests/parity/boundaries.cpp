// Conditions at the faces of the domain and in boxes of nodes, with bodies that press against them.

#include "parity/parity.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// Checks a scene whose bodies are driven into the walls: the domain is cut close to them.
void check_boundaries(const std::string& boundaries, const std::string& more) {
  for (const int dimension : {2, 3})
    for (const std::string& shape : variants(MPM_SHAPE))
      for (const std::string transfer : {"flip", "mls"})
        for (const std::string contact : {"", R"({"type": "coulomb", "friction": 0.2})"})
          for (const std::string order : {"last", "first", "modified_last", "averaged"}) {
            Mix mix;
            mix.dimension = dimension;
            mix.shape = shape, mix.contact = contact, mix.stress_update = order;
            mix.transfer = "{\"type\": \"" + transfer + "\"}";
            mix.boundaries = boundaries, mix.more = more;
            // Tents and FLIP turn a soft particle between a wall and the other body inside out.
            if (!contact.empty() && transfer == "flip" && shape.find("linear") != shape.npos)
              mix.material =
                  R"({"type": "neo_hookean", "youngs_modulus": 2000, "poisson_ratio": 0.3, "density": 1000})";
            const std::size_t open = boundaries.find("\"0.1*x\"]");
            if (dimension == 3 && open != boundaries.npos) mix.boundaries.replace(open, 8, "\"0.1*x\", 0]");
            if (dimension == 3 && order == "first") continue;  // 2-D has all orders
            mix.close = true;
            check_parity(mix);
          }
}

std::string box(int dimension, const std::string& condition) {
  const std::string corners = dimension == 2 ? R"("lower": [0.2, 0.1], "upper": [0.4, 0.3])"
                                             : R"("lower": [0.2, 0.1, 0.1], "upper": [0.4, 0.3, 0.3])";
  return R"(, "node_conditions": [{)" + corners + ", " + condition + "}]";
}

}  // namespace

TEST_CASE("parity of slip, stick, separate and free walls", "[parity]") {
  for (const std::string all : {"slip", "stick", "separate"}) check_boundaries(R"({"all": ")" + all + "\"}", "");
  check_boundaries(R"({"all": "slip", "x_min": "free", "y_max": "free"})", "");
}

TEST_CASE("parity of periodic and prescribed walls", "[parity]") {
  check_boundaries(R"({"all": "periodic"})", "");
  check_boundaries(R"({"all": "separate", "x_min": "periodic", "x_max": "periodic"})", "");
  check_boundaries(R"({"all": "slip", "y_min": {"type": "prescribed", "velocity": ["0.3+t", "0.1*x"]}})", "");
}

TEST_CASE("parity of boxes of nodes", "[parity]") {
  for (const int dimension : {2, 3})
    for (const std::string condition :
         {R"("type": "stick")", R"("type": "slip", "axis": "y")", R"("type": "separate", "axis": "x", "side": "+")",
          R"("type": "separate", "axis": "y", "side": "-")"})
      for (const std::string contact : {"", R"({"type": "coulomb", "friction": 0.2})"})
        for (const std::string order : {"last", "first", "modified_last", "averaged"}) {
          Mix mix;
          mix.dimension = dimension;
          mix.contact = contact, mix.stress_update = order;
          mix.more = box(dimension, condition);
          check_parity(mix);
        }
}

TEST_CASE("parity of prescribed boxes of nodes", "[parity]") {
  for (const int dimension : {2, 3})
    for (const std::string transfer : {"flip", "mls"}) {
      Mix mix;
      mix.dimension = dimension;
      mix.transfer = "{\"type\": \"" + transfer + "\"}";
      mix.more = box(dimension, std::string(R"("type": "prescribed", "velocity": ["0.2*y+t", null)") +
                                    (dimension == 3 ? ", 0.1]" : "]"));
      check_parity(mix);
    }
}

// Rounding may put a node, whose place is a multiple of h, beside the edge that is meant to hold it: a box reaches 1e-9 h
// beyond each.
TEST_CASE("a box holds the nodes on its edges, and those that rounding alone puts beside them", "[parity]") {
  const auto state = [](const std::string& backend, double inwards) {
    Mix mix;
    mix.more = R"(, "node_conditions": [{"type": "stick", "lower": [)" + digits(0.2 + inwards) + ", " +
               digits(0.3 + inwards) + R"(], "upper": [)" + digits(0.4 - inwards) + ", " + digits(0.5 - inwards) +
               "]}]";
    Scene scene(mix.text(), {set("/backend", backend), "/precision=double"});
    scene.run_steps(2);
    return scene.body(0).velocity;
  };
  for (const std::string backend : {"reference", "cpu"}) {
    INFO(backend);
    const std::vector<double> exact = state(backend, 0);
    CHECK(state(backend, 0.9e-10) == exact);
    CHECK(difference(state(backend, 1.1e-10), exact, 1.0) > 1e-3);
  }
}

// A separating condition decides by the velocity before all conditions, also where one before it holds the node already.
TEST_CASE("parity of separating boxes and walls on nodes that others hold", "[parity]") {
  for (const std::string side : {"+", "-"})
    for (const std::string walls :
         {R"({"all": "slip"})", R"({"all": "stick", "y_min": "separate", "x_max": "separate"})"}) {
      Mix mix;
      mix.close = true, mix.boundaries = walls;
      mix.more =
          R"(, "output": {"reactions": true}, "node_conditions": [{"type": "prescribed", "velocity": [null, -0.5],
          "lower": [0.1, 0.1], "upper": [0.5, 0.4]}, {"type": "separate", "axis": "y", "side": ")" +
          side + R"(", "lower": [0.2, 0.1], "upper": [0.6, 0.5]}])";
      check_parity(mix);
    }
}
