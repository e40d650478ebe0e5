// Damping and gravity that changes in time: reference and cpu, double and float, every order and with a filter.

#include "parity/parity.hpp"

using namespace mpm;
using namespace mpm::test;

TEST_CASE("parity of damping and of gravity that changes", "[parity]") {
  for (const int dimension : {2, 3})
    for (const std::string transfer : {"flip", "apic", "mls"})
      for (const std::string order : {"last", "first", "modified_last", "averaged"})
        for (const std::string filter : {"", R"({"type": "fmpm", "order": 2})", R"({"type": "xpic", "order": 2})"})
          for (const bool touch : {false, true}) {
            if (dimension == 3 && (order != "last" || !filter.empty())) continue;  // 2-D has them
            Mix mix;
            mix.dimension = dimension, mix.close = true;
            mix.stress_update = order, mix.filter = filter;
            mix.transfer = "{\"type\": \"" + transfer + "\"}";
            if (touch) mix.contact = R"({"type": "coulomb", "friction": 0.2})";
            mix.boundaries = R"({"all": "slip", "x_min": "separate"})";
            mix.more = R"(, "damping": {"viscous": 3, "local": 0.4})";
            mix.overrides = {std::string(R"J(/gravity=["min(t/0.05,1)", -1.3)J") + (dimension == 3 ? ", 0.4]" : "]")};
            if (!is_refused(mix)) check_parity(mix);
          }
}

TEST_CASE("parity of grips", "[parity]") {
  for (const int dimension : {2, 3})
    for (const std::string shape : {"bspline_quadratic", "cpdi"})
      for (const std::string transfer : {"flip", "apic"})
        for (const std::string order : {"last", "first", "modified_last", "averaged"})
          for (const std::string filter : {"", R"({"type": "fmpm", "order": 2})", R"({"type": "xpic", "order": 2})"})
            for (const bool touch : {false, true}) {
              if ((dimension == 3 || shape == "cpdi") && (order != "last" || !filter.empty())) continue;
              Mix mix;
              mix.dimension = dimension, mix.stress_update = order, mix.filter = filter;
              mix.shape = "{\"type\": \"" + shape + "\"}", mix.transfer = "{\"type\": \"" + transfer + "\"}";
              if (touch) mix.contact = R"({"type": "coulomb", "friction": 0.2})";
              const bool flat = dimension == 2;
              mix.more = std::string(R"(, "grips": [{"body": "a", "where": {"type": "half_space", "point": )") +
                         (flat ? "[0.22, 0], \"normal\": [1, 0]}" : "[0.22, 0, 0], \"normal\": [1, 0, 0]}") +
                         R"J(, "velocity": ["1.2+t-0.9*(y-0.4)", null)J" + (flat ? "]" : ", \"X\"]") +
                         R"(}, {"body": "b", "where": {"type": "half_space", "point": )" +
                         (flat ? "[0.7, 0], \"normal\": [-1, 0]}" : "[0.53, 0, 0], \"normal\": [-1, 0, 0]}") +
                         R"(, "velocity": [1.1, "-0.1+X"])" + "";
              if (!flat) mix.more.insert(mix.more.size() - 1, ", 0.1");
              mix.more += "}]";
              if (!is_refused(mix)) check_parity(mix);
            }
}

TEST_CASE("parity of contact laws and normals beside gripped bodies", "[parity]") {
  for (const int dimension : {2, 3})
    for (const std::string contact :
         {R"({"type": "stick"})", R"({"type": "coulomb", "friction": 0.2, "normal": "own_gradient"})",
          R"({"type": "coulomb", "friction": 0.2, "normal": "widest_gap"})",
          R"({"type": "adhesion", "normal_strength": 100, "shear_strength": 200})",
          R"({"type": "linear_interface", "normal_stiffness": 4000, "shear_stiffness": 2000})"})
      for (const std::string held : {"0.3", "null"}) {
        Mix mix;
        const bool flat = dimension == 2;
        mix.dimension = dimension, mix.contact = contact, mix.filter = flat ? R"({"type": "fmpm", "order": 2})" : "";
        mix.more = std::string(R"(, "grips": [{"body": "a", "where": {"type": "half_space", "point": )") +
                   (flat ? R"([9, 0], "normal": [1, 0]})" : R"([9, 0, 0], "normal": [1, 0, 0]})") +
                   R"J(, "velocity": ["1.2+t-0.9*(y-0.4)", )J" + held + (flat ? "]}]" : ", \"X\"]}]");
        if (!is_refused(mix)) check_parity(mix);
      }
}
