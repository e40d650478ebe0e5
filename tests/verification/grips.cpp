// Grips: particles that move as they are told, exactly, and what they do to the body beside them.

#include <cmath>

#include "support/catch.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// A bar of 1 by 0.2 m between two grips of 0.1 m that part at 2 * 0.05 m/s.
std::string pulled(int cells_high) {
  return R"J({"dimension": 2, "constants": {"v": 0.05}, "grid": {"cell_size": )J" + digits(0.2 / cells_high) +
         R"J(, "domain": [[0, 0], [2, 0.8]], "boundaries": {"all": "free"}},
    "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "apic"},
    "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1000, "poisson_ratio": 0, "density": 1}},
    "bodies": [{"name": "bar", "material": "m", "velocity": ["0.05*(x-1)/0.4", 0],
                "geometry": {"type": "box", "lower": [0.5, 0.3], "upper": [1.5, 0.5]}}],
    "grips": [{"name": "left", "body": "bar", "where": {"type": "box", "lower": [0.5, 0.3], "upper": [0.6, 0.5]},
               "velocity": ["-v", 0]},
              {"name": "right", "body": "bar", "where": {"type": "box", "lower": [1.4, 0.3], "upper": [1.5, 0.5]},
               "velocity": ["v", 0]}],
    "output": {"reactions": ["left", "right"]}, "solver": {"time_step": 2e-4, "end_time": 0.4}})J";
}

std::string block(const std::string& velocity, const std::string& more = "") {
  return R"J({"dimension": 2, "grid": {"cell_size": 0.1, "domain": [[0, 0], [2, 2]], "boundaries": {"all": "free"}},
    "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "apic"},
    "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1000, "poisson_ratio": 0.3, "density": 1000}},
    "bodies": [{"name": "block", "material": "m", "velocity": [0.3, 0],
                "geometry": {"type": "box", "lower": [0.8, 0.8], "upper": [1.2, 1.2]}}],
    "grips": [{"name": "hand", "body": "block", "where": {"type": "half_space", "point": [2, 2], "normal": [1, 1]},
               "velocity": )J" +
         velocity + "}]" + more +
         R"J(, "output": {"reactions": true}, "solver": {"time_step": 0.01, "end_time": 0.5}})J";
}

}  // namespace

TEST_CASE("a body in one grip moves exactly as it is told", "[grips]") {
  for (const std::string backend : {"reference", "cpu"})
    for (const std::string transfer : {"pic", "flip", "apic", "mls"})
      for (const std::string order : {"last", "first", "modified_last", "averaged"})
        for (const std::string filter : {"", R"({"type": "fmpm", "order": 2, "every_steps": 2})"}) {
          INFO(backend << " " << transfer << " " << order << " " << filter);
          std::vector<std::string> overrides{set("/backend", backend), set("/transfer/type", transfer),
                                             set("/solver/stress_update", order)};
          if (!filter.empty()) overrides.push_back("/filter=" + filter);
          Scene scene(block(R"(["0.3+t", "-0.4*t"])"), overrides);
          const BodyState start = scene.body();
          const Totals end = scene.run();
          const BodyState state = scene.body();
          double x = 0, y = 0, worst = 0;
          for (int k = 1; k <= 50; ++k) x += 0.01 * (0.3 + 0.01 * k), y -= 0.01 * 0.4 * 0.01 * k;
          for (std::size_t p = 0; p < state.position.size(); p += 2) {
            worst = larger(worst, std::abs(state.position[p] - start.position[p] - x));
            worst = larger(worst, std::abs(state.position[p + 1] - start.position[p + 1] - y));
            worst = larger(worst, std::abs(state.velocity[p] - 0.8));
          }
          CHECK(worst < 1e-13);
          CHECK(std::abs(end.largest_volume_ratio - 1) < 1e-11);
          const Reaction& hand = scene.simulation.backend().reactions().back();
          CHECK(hand.force[0] == Approx(end.mass * 1).epsilon(1e-9));  // mass times acceleration
          CHECK(hand.force[1] == Approx(end.mass * -0.4).epsilon(1e-9));
          CHECK(hand.impulse[0] == Approx(end.mass * 0.5).epsilon(1e-9));
          CHECK(std::abs(scene.metrics.ledger_residual(end)) < 1e-10 * end.kinetic);
        }
}

TEST_CASE("a body in one grip turns exactly as it is told", "[grips]") {
  // Each step moves a particle by dt w x r of where it was: r grows by sqrt(1 + (w dt)^2) and turns by atan(w dt).
  const double w = 2, dt = 0.01, growth = std::pow(1 + w * w * dt * dt, 25), angle = 50 * std::atan(w * dt);
  for (const std::string backend : {"reference", "cpu"})
    for (const std::string transfer : {"flip", "apic"}) {
      INFO(backend << " " << transfer);
      Scene scene(block(R"J(["-2*(y-1)", "2*(x-1)"])J"), {set("/backend", backend), set("/transfer/type", transfer),
                                                          R"J(/bodies/0/velocity=["-2*(y-1)", "2*(x-1)"])J"});
      const BodyState start = scene.body();
      scene.run();
      const BodyState state = scene.body();
      double worst = 0;
      for (std::size_t p = 0; p < state.position.size(); p += 2) {
        const double X = start.position[p] - 1, Y = start.position[p + 1] - 1, c = std::cos(angle), s = std::sin(angle);
        worst = larger(worst, std::abs(state.position[p] - 1 - growth * (c * X - s * Y)));
        worst = larger(worst, std::abs(state.position[p + 1] - 1 - growth * (s * X + c * Y)));
      }
      CHECK(worst < 1e-12);
    }
}

TEST_CASE("a bar pulled by grips bears E A strain, the more exactly the finer it is", "[grips]") {
  for (const std::string backend : {"reference", "cpu"}) {
    std::vector<double> errors;
    for (const int cells : {4, 8, 16}) {
      if (cells == 16 && backend == "reference") continue;  // slow, and the same to 1e-6 on the grids before
      Scene scene(pulled(cells), {set("/backend", backend), set("/solver/time_step", digits(8e-4 / cells))});
      while (!scene.simulation.finished()) scene.simulation.step();
      const Reaction &left = scene.simulation.backend().reactions()[6],
                     &right = scene.simulation.backend().reactions()[7];
      const double stretch = 1 + 2 * 0.05 * 0.4 / 0.8, force = 0.2 * 500 * (stretch - 1 / stretch);
      INFO(backend << " " << cells << " cells: " << left.force[0] << " " << right.force[0] << " of " << force);
      // Which nodes a grip holds is decided anew as particles move, so that rounding grows.
      CHECK(right.force[0] == Approx(-left.force[0]).epsilon(1e-5));
      errors.push_back(std::abs(right.force[0] / force - 1));
      // A grip is cut off at nodes: of first order in the cell.
      if (errors.size() > 1) CHECK(errors.back() < 0.5 * errors[errors.size() - 2]);
    }
    CHECK(errors.back() < (backend == "cpu" ? 0.025 : 0.05));
  }
}

TEST_CASE("momentum changes by what grips give, and runs go on from a checkpoint", "[grips]") {
  for (const std::string backend : {"reference", "cpu"})
    for (const std::string transfer : {"flip", "apic", "polypic"})
      for (const std::string order : {"last", "first", "modified_last", "averaged"}) {
        INFO(backend << " " << transfer << " " << order);
        const std::vector<std::string> overrides{
            set("/backend", backend),
            set("/transfer/type", transfer),
            set("/solver/stress_update", order),
            "/gravity=[0.2, -1]",
            R"J(/grips/0/velocity=["0.3+0.2*sin(9*t)", null])J",
            "/solver/end_time=0.2",
            R"J(/grips/0/where={"type": "box", "lower": [0.8, 0.8], "upper": [0.93, 1.2]})J"};
        Scene scene(block("[0, 0]"), overrides), first(block("[0, 0]"), overrides), second(block("[0, 0]"), overrides);
        const Totals start = scene.metrics.initial();
        Totals end = scene.run();
        const Reaction& hand = scene.simulation.backend().reactions().back();
        for (int c = 0; c < 2; ++c) {
          const double weight = end.mass * scene.experiment.gravity[c] * end.time;
          CHECK(std::abs(end.momentum[c] - start.momentum[c] - weight - hand.impulse[c]) < 1e-11 * end.mass);
        }
        CHECK(hand.impulse[1] == 0);
        first.run_steps(9);
        ArchiveWriter saved;
        first.simulation.save(saved);
        ArchiveReader reader(saved.bytes());
        second.simulation.restore(reader);
        second.run();
        CHECK(second.body().position == scene.body().position);
        CHECK(second.simulation.backend().reactions().back().impulse == hand.impulse);
      }
}

TEST_CASE("a grip's velocity that is not finite has its place", "[grips]") {
  for (const std::string backend : {"reference", "cpu"}) {
    try {
      Scene scene(block(R"J(["sqrt(0.9-x)", 0])J"), {set("/backend", backend)});
      FAIL("it was accepted");
    } catch (const InputError& refused) {
      CHECK(std::string(refused.what()).find(": /grips/0/velocity/0: is not a finite number at t = 0 s, (") !=
            std::string::npos);
    }
    Scene scene(block(R"J(["sqrt(0.105-t)", 0])J"), {set("/backend", backend)});
    try {
      scene.run();
      FAIL("the run went on");
    } catch (const std::runtime_error& stopped) {
      CHECK(std::string(stopped.what()).find(": /grips/0/velocity/0: is not a finite number at t = 0.11 s, (") !=
            std::string::npos);
    }
  }
}
