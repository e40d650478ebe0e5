// What the backends record of contact, and the works and impulses of walls and boxes whose motion changes in time.

#include <tuple>

#include "parity/parity.hpp"

using namespace mpm;
using namespace mpm::test;

// A force presses the bodies together, so that in the first step in which they touch no pair's approach is zero to rounding.
TEST_CASE("nodes in contact, how they stick and how deep they overlap are counted alike", "[parity][contact]") {
  const std::string given, own = R"(, "normal": "own_gradient")";
  for (const auto& [dimension, friction, normal] :
       {std::tuple{2, "0.05", given}, std::tuple{2, "5", given}, std::tuple{3, "0.05", given},
        std::tuple{3, "5", given}, std::tuple{2, "0.05", own}, std::tuple{3, "5", own}}) {
    Mix mix;
    mix.dimension = dimension;
    mix.contact = R"({"type": "coulomb", "friction": )" + std::string(friction) + normal + "}";
    mix.more =
        dimension == 2 ? R"J(, "body_force": ["-200*(x-0.5)", 0])J" : R"J(, "body_force": ["-200*(x-0.4)", 0, 0])J";
    INFO(mix.name());
    Scene reference(mix.text(), {"/backend=reference", "/precision=double"});
    Scene cpu(mix.text(), {"/backend=cpu", "/precision=double"});
    const ContactRecord &expected = reference.simulation.backend().contact_record(),
                        &found = cpu.simulation.backend().contact_record();
    while (!reference.simulation.finished() && expected.nodes == 0) {
      reference.run_steps(1), cpu.run_steps(1);
      CHECK(found.nodes == expected.nodes);
      CHECK(found.sticking == expected.sticking);
      CHECK(found.slipping == expected.slipping);
      CHECK(found.largest_penetration == Approx(expected.largest_penetration).epsilon(1e-9));
    }
    CHECK(expected.nodes > 0);
    CHECK(expected.nodes == expected.sticking + expected.slipping);
    CHECK(expected.largest_penetration > 0);
    const double momentum = reference.metrics.initial().mass * 1.5;
    if (normal != own)  // which breaks momentum
      CHECK(expected.momentum_residual <= 100 * std::numeric_limits<double>::epsilon() * momentum);
  }
}

TEST_CASE("parity of walls whose motion changes in time, with damping, filters and in every order", "[parity]") {
  for (const std::string order : {"last", "first", "modified_last", "averaged"})
    for (const std::string filter : {"", R"({"type": "fmpm", "order": 2})"}) {
      Mix mix;
      mix.stress_update = order, mix.filter = filter, mix.close = true;
      mix.boundaries = R"({"all": "slip", "y_min": {"type": "prescribed", "velocity": ["0.3+9*t", "0.1*x+5*t"]},
        "x_max": {"type": "prescribed", "velocity": ["4*t", "2*t-y"]}})";
      mix.more = R"(, "damping": {"viscous": 3, "local": 0.2})";
      if (!is_refused(mix)) check_parity(mix);
    }
}
