// Fields that somebody adds to the plan's list are held by the cpu backend without its knowing them: particles keep
// them while they move, in archives too; nodes are cleared and folded by the rules that the list gives.

#include <numeric>

#include "backends/cpu/grid/grid_step.hpp"
#include "parity/parity.hpp"
#include "support/results.hpp"

namespace mpm::cpu {
extern template class Grid<2, double>;
extern template class GridStep<2, double>;
}  // namespace mpm::cpu

using namespace mpm;
using namespace mpm::test;

namespace {

Field of_particles(int body, const std::string& id, int components, First first) {
  Field field;
  field.id = field.name = id, field.body = body, field.components = components, field.first = first;
  return field;
}

Field of_nodes(const std::string& id, AtWall at_wall, Folded folded, const std::string& beside = "") {
  Field field;
  field.id = field.name = id, field.owner = Owner::node, field.components = beside.empty() ? 2 : 1;
  field.lifetime = Lifetime::step, field.cleared = true;
  field.at_wall = at_wall, field.folded = folded, field.beside = beside;
  return field;
}

/// The temperature, in kelvin, that seeds give each particle.
double seeded_temperature(std::size_t particle) {
  return 250 + 0.25 * static_cast<double>(particle);
}

/// A run whose plan lists a temperature and a stretch of particles that no pass knows.
class RunWithMore {
 public:
  RunWithMore(const std::string& text, const std::vector<std::string>& overrides, int threads)
      : experiment(experiment_from(text, overrides)),
        simulation(experiment, [&](const Experiment& e, const Plan& planned, std::vector<SeededBody> bodies) {
          plan = planned;
          for (int body = 0; body < static_cast<int>(bodies.size()); ++body) {
            plan.fields.push_back(of_particles(body, "temperature", 1, First::seeded));
            plan.fields.push_back(of_particles(body, "stretch", e.dimension * e.dimension, First::identity));
            SeededBody& seeds = bodies[static_cast<std::size_t>(body)];
            seeds.make = [make = seeds.make](const auto& visit) {
              make([&](SeedBatch batch) {
                std::vector<double> temperature(batch.count);
                for (std::size_t i = 0; i < batch.count; ++i) temperature[i] = seeded_temperature(batch.first + i);
                batch.others.push_back({"temperature", temperature.data()});
                visit(batch);
              });
            };
          }
          return make_cpu_backend(e, plan, std::move(bodies), threads);
        }) {}

  void check_fields() const {
    for (int body = 0; body < static_cast<int>(experiment.bodies.size()); ++body) {
      const BodyState state = simulation.backend().body_state(body);
      const std::vector<double>&temperature = state.host_state.at("temperature"),
            &stretch = state.host_state.at("stretch");
      const std::size_t D = static_cast<std::size_t>(experiment.dimension), n = state.position.size() / D;
      REQUIRE(temperature.size() == n);
      REQUIRE(stretch.size() == n * D * D);
      std::size_t wrong = 0;
      for (std::size_t p = 0; p < n; ++p) {
        wrong += temperature[p] != seeded_temperature(p);  // the numbers are exact in float
        for (std::size_t k = 0; k < D * D; ++k) wrong += stretch[p * D * D + k] != (k % (D + 1) == 0 ? 1 : 0);
      }
      CHECK(wrong == 0);
    }
  }

  const Experiment experiment;
  Plan plan;
  Simulation simulation;
};

void check_more_fields(const Mix& mix, const std::vector<std::string>& overrides) {
  if (!is_chosen_check()) return;
  INFO(mix.name());
  CpuRun plain(mix.text(), overrides, 2);
  RunWithMore run(mix.text(), overrides, 2), resumed(mix.text(), overrides, 1);
  run.check_fields();
  plain.steps(24);
  for (int k = 0; k < 13; ++k) run.simulation.step();
  ArchiveWriter archive;
  run.simulation.save(archive);
  ArchiveReader reader(archive.bytes());
  resumed.simulation.restore(reader);
  resumed.check_fields();
  for (int k = 13; k < 24; ++k) run.simulation.step(), resumed.simulation.step();  // particles cross several cells
  for (const RunWithMore* each : {&run, &resumed}) {
    each->check_fields();
    CHECK(different(all_results(plain.simulation, false), all_results(each->simulation, false)) == 0);
  }
}

}  // namespace

TEST_CASE("particles keep what is added to the plan's list", "[parity]") {
  for (const std::string precision : {"double", "float"}) {
    const std::vector<std::string> overrides{set("/precision", precision), "/solver/end_time=0.9"};
    Mix mix;
    mix.transfer = R"({"type": "mls"})";  // mls sorts between scatter and gather, and leaves motion behind
    check_more_fields(mix, overrides);
    mix.dimension = 3;
    mix.transfer = R"({"type": "flip"})";
    check_more_fields(mix, overrides);
    mix.dimension = 2;
    mix.shape = R"({"type": "cpdi2"})", mix.stress_update = "modified_last";
    check_more_fields(mix, overrides);
  }
}

TEST_CASE("nodes clear and fold what is added to the plan's list", "[parity]") {
  Mix mix;
  mix.boundaries = R"({"x_min": "slip", "x_max": "stick", "y_min": "periodic", "y_max": "periodic"})";
  const Experiment experiment = experiment_from(mix.text());
  Plan plan = make_plan(experiment);
  plan.fields.push_back(of_nodes("heat", AtWall::even, Folded::with_mass));
  plan.fields.push_back(of_nodes("heat_capacity", AtWall::even, Folded::with_mass, "heat"));
  plan.fields.push_back(of_nodes("couple", AtWall::vector, Folded::with_force));
  plan.fields.push_back(of_nodes("normal", AtWall::slip, Folded::with_mass));
  plan.fields.push_back(of_nodes("guess", AtWall::none, Folded::never));
  plan.fields.back().in_place_of = "couple";
  const cpu::Scene<2, double> scene(experiment, plan, 1);
  cpu::Grid<2, double> grid(scene);
  const cpu::Channel heat = cpu::channel_of(plan, "heat"), couple = cpu::channel_of(plan, "couple"),
                     normal = cpu::channel_of(plan, "normal"), motion = cpu::channel_of(plan, "momentum");
  REQUIRE(grid.has(heat));
  CHECK(cpu::channel_of(plan, "heat_capacity") == heat);
  CHECK(cpu::channel_of(plan, "guess") == couple);
  CHECK_FALSE(grid.has(cpu::channel_of(plan, "no such field")));

  // The particles fill one block over the whole domain, so that there are blocks for all nodes.
  std::vector<cpu::Particles<2, double>> particles(1);
  for (int x = 0; x <= 1; ++x)
    for (int y = 0; y <= 1; ++y) {
      particles[0].blocks.emplace_back().at = {x, y, 0};
      particles[0].blocks.back().count = 1;
    }
  grid.rebuild(particles, {0});
  using Quad = cpu::Quad<double>;
  const auto fill = [&](cpu::Channel channel, Quad value) {
    for (std::uint32_t node = 0; node < grid.nodes(); ++node) grid.quad(channel, 0, node) = value;
  };
  for (cpu::Channel channel = 0; channel < grid.channels(); ++channel) fill(channel, Quad{1, 2, 3, 4});
  grid.clear();
  for (const cpu::Channel channel : {heat, couple, normal})
    for (std::uint32_t node = 0; node < grid.nodes(); ++node)
      for (int c = 0; c < 4; ++c) REQUIRE(grid.quad(channel, 0, node)[c] == 0);

  Ledger ledger;
  ContactRecord contact;
  FilterRecord filter;
  HeatLedger heat_ledger;
  ReactionImpulse reactions(experiment);
  cpu::GridStep<2, double> step(scene, grid, ledger, heat_ledger, contact, filter, reactions);
  fill(motion, Quad{0, 0, 0, 1});
  for (const cpu::Channel channel : {heat, couple, normal}) fill(channel, Quad{1, 2, 0, 3});
  step.momentum_to_velocity(false, StepInfo{0.001, 0, 0});
  step.apply_forces(StepInfo{0.001, 0, 0});
  const auto value = [&](cpu::Channel channel, int x, int y) {
    const Quad quad = grid.quad(channel, 0, static_cast<std::uint32_t>(grid.find({x, y, 0})));
    return std::array<double, 3>{quad[0], quad[1], quad[3]};
  };
  using Values = std::array<double, 3>;
  // At y = 5 there is no image along y; three nodes beyond each wall are folded. There are 13 x 10 cells.
  for (const int x : {1, 12}) {
    CHECK(value(heat, x, 5) == Values{2, 4, 6});
    CHECK(value(normal, x, 5) == Values{0, 4, 6});
  }
  CHECK(value(couple, 1, 5) == Values{0, 4, 6});   // slip mirrors across the wall alone
  CHECK(value(couple, 12, 5) == Values{0, 0, 6});  // stick mirrors every component
  CHECK(value(normal, 0, 5) == Values{0, 2, 3});   // the normal component vanishes on the wall
  CHECK(value(couple, 0, 5) == Values{1, 2, 3});
  CHECK(value(heat, 6, 5) == Values{1, 2, 3});
  CHECK(value(heat, -1, 5) == Values{0, 0, 0});  // the ghost's heat has been given away
  CHECK(value(couple, -1, 5) == Values{0, 0, 0});
  CHECK(value(heat, 6, 0) == Values{2, 4, 6});  // node 10 adds to it
  CHECK(value(couple, 6, 0) == Values{2, 4, 6});
  CHECK(value(normal, 6, 0) == Values{2, 4, 6});
  CHECK(value(heat, 1, 0) == Values{4, 8, 12});  // at a corner: images first, then the wall
}
