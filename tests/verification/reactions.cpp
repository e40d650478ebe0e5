// The recorded reactions of walls and boxes of nodes: the momentum of the particles changes by what supports and gravity
// give them (Newton), which no transfer, filter or order of the updates may change; and statics: weight, arm times weight.

#include <algorithm>
#include <cmath>
#include <numeric>

#include "parity/parity.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

const std::string asked = R"(, "output": {"reactions": true})";

/// Two bodies that press on each other and on walls of every kind, one of which moves, and on boxes of nodes; the far end
/// of the second one may be in a grip, which leaves one component free.
Mix pressed(int dimension, const std::string& walls, bool gripped = false) {
  Mix mix;
  mix.dimension = dimension;
  mix.close = true;
  mix.boundaries = walls;
  const bool flat = dimension == 2;
  mix.more = asked + R"(, "node_conditions": [{"type": "slip", "axis": "y", "name": "rail", "lower": )" +
             (flat ? "[0.2, 0.3], \"upper\": [0.3, 0.4]}" : "[0.2, 0.1, 0.1], \"upper\": [0.3, 0.2, 0.4]}") +
             R"(, {"type": "prescribed", "velocity": ["0.2+t", null)" + (flat ? "]" : ", 0.1]") + R"(, "lower": )" +
             (flat ? "[0.6, 0.4], \"upper\": [0.7, 0.5]}]" : "[0.4, 0.1, 0.2], \"upper\": [0.5, 0.2, 0.3]}]");
  if (gripped)
    mix.more +=
        R"(, "grips": [{"body": "b", "where": {"type": "half_space", "point": )" +
        std::string(flat ? "[0.73, 0.5], \"normal\": [-1, 0.3]}" : "[0.55, 0.3, 0.3], \"normal\": [-1, 0.3, 0.2]}") +
        R"(, "velocity": )" + (flat ? R"(["1.1-4*t", null]}])" : R"(["1.1-4*t", null, "0.1+3*t"]}])");
  return mix;
}
std::string all_walls(int dimension) {
  return std::string(R"({"all": "slip", "x_min": "stick", "y_max": "separate", "y_min": {"type": "prescribed",)"
                     R"("velocity": ["0.3+t", "0.1*x")") +
         (dimension == 3 ? ", 0]}}" : "]}}");
}

struct Balance {
  double missing = 0, size = 0;  ///< kg m/s
  double scale = 0;              ///< kg m/s, sum of m |v|
};

/// Sums what the momentum of the particles has not from supports and gravity, over all steps.
Balance balance(const std::string& text, const std::vector<std::string>& overrides) {
  Scene scene(text, overrides);
  Vector3 before = scene.metrics.initial().momentum;
  Balance result;
  while (!scene.simulation.finished()) {
    scene.simulation.step();
    const Totals now = scene.metrics.measure();
    for (std::size_t c = 0; c < 3; ++c) {
      double given = scene.experiment.gravity[c] * now.mass;
      for (const Reaction& reaction : scene.simulation.backend().reactions()) {
        given += reaction.force[c];
        result.size = larger(result.size, std::abs(reaction.force[c]) * now.time_step);
      }
      result.missing = larger(result.missing, std::abs(now.momentum[c] - before[c] - given * now.time_step));
    }
    before = now.momentum;
    result.scale = larger(result.scale, now.momentum_scale);
  }
  return result;
}

const std::vector<std::string> filters{"",
                                       R"({"type": "fmpm", "order": 2})",
                                       R"({"type": "fmpm", "order": 4})",
                                       R"({"type": "fmpm", "order": 4, "constraints": "kept_impulses"})",
                                       R"({"type": "fmpm", "order": 4, "constraints": "at_end"})",
                                       R"({"type": "fmpm", "order": 3, "every_steps": 3})",
                                       R"({"type": "xpic", "order": 3})"};

/// The angular momentum of the particles about the origin, kg m^2/s, with the affine part C of a shape of constant D.
Vector3 spin(const Scene& scene) {
  const auto D = static_cast<std::size_t>(scene.experiment.dimension);
  const double h = scene.experiment.grid.cell_size;
  Vector3 sum{};
  const auto add = [&](double m, const Vector3& x, const Vector3& v) {
    sum[0] += m * (x[1] * v[2] - x[2] * v[1]);
    sum[1] += m * (x[2] * v[0] - x[0] * v[2]);
    sum[2] += m * (x[0] * v[1] - x[1] * v[0]);
  };
  for (int body = 0; body < static_cast<int>(scene.experiment.bodies.size()); ++body) {
    const BodyState state = scene.body(body);
    const std::vector<double>& C = state.transfer_state.begin()->second;
    for (std::size_t p = 0; p < state.position.size() / D; ++p) {
      Vector3 x{}, v{};
      std::copy_n(&state.position[p * D], D, x.begin());
      std::copy_n(&state.velocity[p * D], D, v.begin());
      add(state.mass, x, v);
      for (std::size_t a = 0; a < D; ++a) {
        Vector3 d{}, of_d{};
        d[a] = 1;
        for (std::size_t c = 0; c < D; ++c) of_d[c] = C[(p * D + c) * D + a];
        add(state.mass * h * h / 4, d, of_d);
      }
    }
  }
  return sum;
}

}  // namespace

TEST_CASE("momentum changes by what supports and gravity give", "[reactions]") {
  int tried = 0, refused = 0;
  double worst = 0;
  for (const std::string backend : {"reference", "cpu"})
    for (const Plugin* transfer : plugins().of_kind(MPM_TRANSFER))
      for (const std::string update : {"last", "first", "averaged", "modified_last"})
        for (const std::string& filter : filters)
          for (const bool touch : {false, true}) {
            Mix mix = pressed(2, all_walls(2));
            mix.transfer = R"({"type": ")" + std::string(transfer->id()) + "\"}";
            mix.stress_update = update, mix.filter = filter;
            if (touch) mix.contact = R"({"type": "coulomb", "friction": 0.3})";
            if (is_refused(mix)) {
              ++refused;
              continue;
            }
            INFO(backend << " " << mix.name());
            const Balance found = balance(mix.text(), {set("/backend", backend), set("/solver/end_time", "0.054")});
            CHECK(found.size > 0.1);
            CHECK(found.missing < 2e-14 * found.scale);
            worst = larger(worst, found.missing / found.scale);
            ++tried;
          }
  INFO("largest " << worst << " of the momentum, in " << tried << " runs");
  CHECK(worst > 0);
  CHECK(tried > 400);
  CHECK(refused < 250);
}

// Where a support may let go, conditions answer to the velocity anew after a filter; these hold for good.
TEST_CASE("so it does with a filter where no support lets go", "[reactions]") {
  for (const std::string backend : {"reference", "cpu"})
    for (const std::string transfer : {"pic", "flip"})
      for (const std::string update : {"last", "first", "averaged", "modified_last"})
        for (const std::string& filter : filters) {
          Mix mix = pressed(2, R"({"all": "slip", "x_min": "stick", "y_min": {"type": "prescribed",)"
                               R"("velocity": ["0.3+t", "0.1*x"]}})");
          mix.transfer = R"({"type": ")" + transfer + "\"}", mix.stress_update = update, mix.filter = filter;
          if (is_refused(mix)) continue;
          INFO(backend << " " << mix.name());
          const Balance found = balance(mix.text(), {set("/backend", backend), set("/solver/end_time", "0.054")});
          CHECK(found.size > 0.1);
          CHECK(found.missing < 2e-14 * found.scale);
        }
}

TEST_CASE("so it does in 3-D, in small domains, with lists of nodes and in float", "[reactions]") {
  const std::string periodic = R"({"all": "slip", "x_min": "periodic", "x_max": "periodic"})";
  for (const std::string backend : {"reference", "cpu"})
    for (const std::string transfer : {"apic", "flip"})
      for (const std::string shape : {"bspline_quadratic", "linear", "bspline_cubic", "gimp", "cpdi"}) {
        for (const bool wraps : {false, true}) {
          Mix mix = pressed(3, wraps ? periodic : all_walls(3));
          mix.transfer = R"({"type": ")" + transfer + "\"}", mix.shape = R"({"type": ")" + shape + "\"}";
          INFO(backend << " " << mix.name());
          const Balance found = balance(mix.text(), {set("/backend", backend), set("/solver/end_time", "0.036")});
          CHECK(found.size > 0.01);
          CHECK(found.missing < 2e-14 * found.scale);
        }
        Mix small = pressed(2, all_walls(2));  // two cells high: mirrors of one wall's ghosts are the other's ghosts
        small.transfer = R"({"type": ")" + transfer + "\"}", small.shape = R"({"type": ")" + shape + "\"}";
        const std::vector<std::string> low{
            set("/backend", backend), set("/solver/end_time", "0.036"), R"(/grid/domain=[[0.1, 0.3], [0.9, 0.5]])",
            R"J(/bodies/0/geometry={"type": "box", "lower": [0.1, 0.3], "upper": [0.5, 0.5]})J",
            R"J(/bodies/1/geometry={"type": "box", "lower": [0.52, 0.3], "upper": [0.9, 0.5]})J"};
        INFO(backend << " two cells high " << small.name());
        const Balance found = balance(small.text(), low);
        CHECK(found.size > 0.01);
        CHECK(found.missing < 2e-14 * found.scale);
      }
  for (const std::string filter : {"", R"({"type": "fmpm", "order": 3})"}) {
    Mix mix = pressed(2, all_walls(2));
    mix.filter = filter;
    const Balance found = balance(mix.text(), {set("/precision", "float")});
    CHECK(found.size > 0.1);
    CHECK(found.missing < 1e-6 * found.scale);
  }
}

TEST_CASE("angular momentum changes by the moments of supports and gravity", "[reactions]") {
  for (const std::string backend : {"reference", "cpu"})
    for (const int dimension : {2, 3})
      for (const std::string transfer : {"apic", "mls"})
        for (const auto& [filter, gripped] :
             {std::pair{"", false}, {R"({"type": "fmpm", "order": 3})", false}, {"", true}}) {
          Mix mix = pressed(dimension, all_walls(dimension), gripped);
          mix.transfer = R"({"type": ")" + transfer + "\"}", mix.filter = filter;
          INFO(backend << " " << mix.name());
          Scene scene(mix.text(), {set("/backend", backend), set("/solver/end_time", "0.054")});
          Vector3 before = spin(scene);
          double missing = 0, size = 0;
          while (!scene.simulation.finished()) {
            const Vector3 place = scene.metrics.measure().centre_of_mass, &g = scene.experiment.gravity;
            scene.simulation.step();
            const double m = scene.metrics.initial().mass, dt = scene.simulation.last_time_step();
            Vector3 given{m * (place[1] * g[2] - place[2] * g[1]), m * (place[2] * g[0] - place[0] * g[2]),
                          m * (place[0] * g[1] - place[1] * g[0])};
            const Vector3 now = spin(scene);
            for (std::size_t c = 0; c < 3; ++c) {
              for (const Reaction& reaction : scene.simulation.backend().reactions()) given[c] += reaction.moment[c];
              missing = larger(missing, std::abs(now[c] - before[c] - given[c] * dt));
              size = larger(size, std::abs(given[c] * dt));
            }
            before = now;
          }
          CHECK(size > 0.01);
          CHECK(missing < 1e-11 * size);
        }
}

// In axisymmetric scenes forces are those of whole rings, along the axis alone.
TEST_CASE("axial momentum of rings changes by the axial reactions", "[reactions]") {
  const std::string text = R"J({"dimension": 2,
    "grid": {"cell_size": 0.1, "symmetry": "axisymmetric", "domain": [[0, 0], [0.5, 0.6]],
             "boundaries": {"all": "slip", "x_max": "stick"}},
    "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "flip"},
    "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1000, "poisson_ratio": 0.3, "density": 1000}},
    "bodies": [{"name": "cylinder", "material": "m", "geometry": {"type": "box", "lower": [0, 0], "upper": [0.5, 0.4]},
                "velocity": ["0.3*x", "-1+x"]}], "gravity": [0, -3],
    "output": {"reactions": true}, "solver": {"time_step": 0.004, "end_time": 0.08}})J";
  for (const std::string backend : {"reference", "cpu"})
    for (const std::string transfer : {"flip", "apic"}) {
      Scene scene(text, {set("/backend", backend), set("/transfer/type", transfer)});
      const Totals start = scene.metrics.initial(), end = scene.run();
      double given = start.mass * -3 * end.time, size = 0;
      for (const Reaction& reaction : scene.simulation.backend().reactions())
        given += reaction.impulse[1], size += std::abs(reaction.impulse[1]);
      CHECK(size > 1);
      CHECK(std::abs(end.momentum[1] - start.momentum[1] - given) < 1e-12 * size);
    }
}

namespace {

/// A block of 0.4 by 0.2 m on a floor, damped until it rests.
std::string resting(const std::string& walls, const std::string& more = "") {
  return R"J({"dimension": 2, "grid": {"cell_size": 0.05, "domain": [[0, 0], [0.8, 0.4]], "boundaries": )J" + walls +
         R"J(},
    "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "flip"}, "gravity": [0, -10],
    "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e6, "poisson_ratio": 0.3, "density": 1000}},
    "bodies": [{"name": "block", "material": "m", "geometry": {"type": "box", "lower": [0.2, 0], "upper": [0.6, 0.2]}}],
    "damping": {"viscous": 200})J" +
         more + R"J(, "output": {"reactions": ["y_min"]},
    "solver": {"time_step": 4e-4, "end_time": 0.3}})J";
}

}  // namespace

TEST_CASE("a block that rests has its weight on its floor", "[reactions]") {
  const double weight = 1000 * 0.08 * 10;
  const std::string floors[] = {R"({"all": "slip"})", R"({"all": "stick"})", R"({"all": "separate"})",
                                R"({"all": "slip", "x_min": "periodic", "x_max": "periodic"})"};
  for (const std::string backend : {"reference", "cpu"})
    for (const std::string& floor : floors)
      for (const std::string transfer : {"flip", "apic"}) {
        INFO(backend << " " << floor << " " << transfer);
        Scene scene(resting(floor), {set("/backend", backend), set("/transfer/type", transfer)});
        scene.run();
        const Reaction& found = scene.simulation.backend().reactions()[support_of_wall(1, 0)];
        CHECK(found.force[1] == Approx(weight).epsilon(1e-4));
        CHECK(std::abs(found.force[0]) < 1e-6 * weight);
        CHECK(found.moment[2] == Approx(weight * 0.4).epsilon(1e-4));  // the arm of the centre of mass
      }
}

TEST_CASE("the moment of a cantilever's clamp is its weight times its arm", "[reactions]") {
  // The beam begins in the clamp; at rest the moments about the origin of the clamp and of the weight balance.
  const std::string beam = R"J({"dimension": 2, "grid": {"cell_size": 0.05, "domain": [[0, 0], [0.8, 0.4]],
    "boundaries": {"all": "free"}}, "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "flip"},
    "gravity": [0, -1], "node_conditions": [{"type": "stick", "name": "clamp", "lower": [0, 0.1], "upper": [0.15, 0.4]}],
    "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e6, "poisson_ratio": 0.3, "density": 1000}},
    "bodies": [{"name": "beam", "material": "m", "geometry": {"type": "box", "lower": [0.1, 0.2], "upper": [0.6, 0.3]}}],
    "damping": {"viscous": 30}, "output": {"reactions": ["clamp"]}, "solver": {"time_step": 5e-4, "end_time": 1.4}})J";
  for (const std::string backend : {"reference", "cpu"}) {
    Scene scene(beam, {set("/backend", backend)});
    const Totals end = scene.run();
    const Reaction& clamp = scene.simulation.backend().reactions()[support_of_box(0)];
    const double weight = end.mass * 1;
    CHECK(end.kinetic < 1e-6 * weight * 0.1);  // FLIP keeps what no node sees
    CHECK(clamp.force[1] == Approx(weight).epsilon(1e-4));
    CHECK(clamp.moment[2] == Approx(weight * end.centre_of_mass[0]).epsilon(1e-4));
  }
}

TEST_CASE("of supports that hold a node the last one gives all, whether or not a ledger is kept", "[reactions]") {
  // A body is told to fly ever faster through nodes that two boxes hold too: the grip, which comes last, gives it all that it
  // gains.
  const std::string flight = R"J({"dimension": 2, "grid": {"cell_size": 0.1, "domain": [[0, 0], [1, 1]],
    "boundaries": {"all": "free"}}, "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "flip"},
    "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e3, "poisson_ratio": 0.3, "density": 1000}},
    "bodies": [{"name": "a", "material": "m",
      "geometry": {"type": "box", "lower": [0.3, 0.3], "upper": [0.6, 0.6]}}],
    "grips": [{"body": "a", "velocity": ["1+4*t", "0.5-2*t"],
      "where": {"type": "half_space", "point": [9, 0], "normal": [1, 0]}}],
    "node_conditions": [{"type": "stick", "lower": [0, 0], "upper": [0.4, 1]},
      {"type": "prescribed", "velocity": ["3*t", 0.2], "lower": [0.2, 0], "upper": [0.5, 1]}],
    "solver": {"time_step": 0.005, "end_time": 0.1}})J";
  for (const std::string backend : {"reference", "cpu"})
    for (const std::string transfer : {"flip", "apic"})
      for (const std::string ledger : {"true", "false"}) {
        INFO(backend << " " << transfer << ", ledger " << ledger);
        Scene scene(flight, {set("/backend", backend), "/precision=double", set("/transfer/type", transfer),
                             R"(/output={"reactions": true, "ledger": )" + ledger + "}"});
        const double mass = scene.run().mass;
        const std::vector<Reaction>& reactions = scene.simulation.backend().reactions();
        const auto grip = static_cast<std::size_t>(scene.experiment.support_of_grip(0));
        for (std::size_t k = 0; k < reactions.size(); ++k) {
          INFO("support " << k);
          CHECK(std::abs(reactions[k].impulse[0] - (k == grip ? 0.4 * mass : 0)) < 1e-12 * mass);
          CHECK(std::abs(reactions[k].impulse[1] - (k == grip ? -0.2 * mass : 0)) < 1e-12 * mass);
        }
      }
}

TEST_CASE("asking for reactions changes no result", "[reactions]") {
  for (const std::string backend : {"reference", "cpu"}) {
    Mix mix = pressed(2, all_walls(2));
    mix.filter = R"({"type": "fmpm", "order": 3})";
    Scene with(mix.text(), {set("/backend", backend)}),
        without(mix.text(), {set("/backend", backend), set("/output/reactions", "false")});
    with.run(), without.run();
    CHECK(without.simulation.backend().reactions().empty());
    CHECK(with.body(0).velocity == without.body(0).velocity);
    CHECK(with.body(1).position == without.body(1).position);
  }
}

TEST_CASE("reactions go through a checkpoint", "[reactions]") {
  for (const std::string backend : {"reference", "cpu"}) {
    const Mix mix = pressed(2, all_walls(2));
    Scene whole(mix.text(), {set("/backend", backend)}), first(mix.text(), {set("/backend", backend)}),
        second(mix.text(), {set("/backend", backend)});
    first.run_steps(7);
    ArchiveWriter saved;
    first.simulation.save(saved);
    ArchiveReader reader(saved.bytes());
    second.simulation.restore(reader);
    whole.run(), second.run();
    for (std::size_t k = 0; k < 8; ++k) {
      CHECK(whole.simulation.backend().reactions()[k].impulse == second.simulation.backend().reactions()[k].impulse);
      CHECK(whole.simulation.backend().reactions()[k].force == second.simulation.backend().reactions()[k].force);
    }
  }
}
