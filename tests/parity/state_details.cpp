// What the cpu backend keeps of its particles: checkpoints that were damaged, velocities that a step has left behind, memory
// that it says it holds, and the clock of its phases.

#include <chrono>

#include "backends/cpu/particles/particles.hpp"
#include "backends/cpu/phase_clock.hpp"
#include "parity/parity.hpp"
#include "support/results.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// A row of bodies, which are boxes of cells of 1 m given as their lower and upper corners, with a particle a cell.
std::string boxes(const std::vector<std::pair<std::string, std::string>>& corners, const std::string& more = "") {
  std::string bodies;
  for (const auto& [lower, upper] : corners)
    bodies += std::string(bodies.empty() ? "" : ", ") + R"({"name": "b)" + std::to_string(bodies.size()) +
              R"(", "material": "m", "particles_per_cell_axis": 1, "geometry": {"type": "box", "lower": )" + lower +
              R"(, "upper": )" + upper + "}}";
  return R"({"title": "boxes", "dimension": 2, "grid": {"cell_size": 1, "domain": [[0, 0], [60, 60]]},
    "shape": {"type": "linear"}, "transfer": {"type": "apic"}, "materials": {"m": {"type": "neo_hookean",
    "youngs_modulus": 1, "poisson_ratio": 0, "density": 1}}, "bodies": [)" +
         bodies + R"(], "solver": {"time_step": 0.1, "end_time": 1})" + more + "}";
}

/// A checkpoint of one body, whose numbers may be changed where they stand.
class Checkpoint {
 public:
  explicit Checkpoint(const std::string& text) : text_(text) {
    CpuRun run(text, {"/precision=double"}, 1);
    ArchiveWriter archive;
    run.simulation.save(archive);
    bytes_ = archive.bytes();
  }
  /// Sets the number at a place among those under a tag.
  template <class Number>
  Checkpoint& set(const std::string& tag, std::size_t place, Number number) {
    std::uint64_t head[3];  // lengths of the tag and of a number, and how many numbers there are
    for (auto from = bytes_.begin();; ++from) {
      from = std::search(from, bytes_.end(), tag.begin(), tag.end());
      REQUIRE(from != bytes_.end());
      std::memcpy(head, &*from - sizeof head, sizeof head);
      if (head[0] != tag.size() || head[1] != sizeof number || head[2] <= place) continue;
      std::memcpy(&*from + tag.size() + place * sizeof number, &number, sizeof number);
      return *this;
    }
  }
  std::string what_restoring_says() const {
    CpuRun run(text_, {"/precision=double"}, 1);
    ArchiveReader reader(bytes_);
    try {
      run.simulation.restore(reader);
    } catch (const ArchiveError& error) {
      return error.what();
    }
    return "";
  }

 private:
  std::string text_;
  std::vector<char> bytes_;
};

// Of a block a checkpoint holds three triples, its first chunk, and its number of particles.
constexpr std::size_t first_chunk = 9, count = 10;

}  // namespace

// The lanes of a chunk after its last particle hold copies of it, so that a count that is too large misses nobody.
TEST_CASE("a checkpoint whose blocks are not those of its particles is refused by name", "[parity]") {
  const std::string one = boxes({{"[1, 1]", "[2, 2]"}});
  const std::string blocks = "value \"blocks\" is not of these particles",
                    units = "value \"units\" is not of these particles",
                    number = "it holds another number of particles";
  CHECK(Checkpoint(one).what_restoring_says().empty());
  CHECK(Checkpoint(one).set("blocks", first_chunk, std::int32_t{1}).what_restoring_says() == blocks);
  CHECK(Checkpoint(one).set("blocks", count, std::int32_t{0}).what_restoring_says() == blocks);
  CHECK(Checkpoint(one).set("blocks", count, std::int32_t{2}).what_restoring_says() == number);
  CHECK(Checkpoint(one).set("chunks", 0, std::uint32_t{2}).what_restoring_says() == number);
  CHECK(Checkpoint(one).set("units", 0, cpu::Unit{0, 2}).what_restoring_says() == units);
  CHECK(Checkpoint(one).set("units", 0, cpu::Unit{1, 0}).what_restoring_says() == units);
  CHECK(Checkpoint(one).set("identities", 0, std::int32_t{1} << 30).what_restoring_says() ==
        "value \"identities\" is not of these particles");
}

TEST_CASE("a state is restored into a run whose last step has left velocities behind", "[parity]") {
  Mix mix;
  mix.transfer = R"({"type": "mls"})";
  CpuRun saved(mix.text(), {"/precision=double"}, 1), restored(mix.text(), {"/precision=double"}, 1);
  saved.steps(1);
  ArchiveWriter archive;
  saved.simulation.save(archive);
  restored.simulation.observe_when([](double, long) { return false; });
  restored.steps(2);
  REQUIRE(restored.simulation.backend().body_state(0).velocity.empty());
  ArchiveReader reader(archive.bytes());
  restored.simulation.restore(reader);
  CHECK_FALSE(restored.simulation.backend().body_state(0).velocity.empty());
  CHECK(different(all_results(saved.simulation), all_results(restored.simulation)) == 0);
}

// The arrays are made here as the backend makes them, from the same seeds, and their sizes are summed one by one.
TEST_CASE("the bytes of particles are those of chunks, their places, blocks, the sort and what was seeded",
          "[parity]") {
  const std::string text = boxes({{"[1, 1]", "[59, 3]"}, {"[1, 9]", "[3, 59]"}}, R"(, "body_force": ["0.1*X", 0])");
  const Experiment experiment = experiment_from(text, {"/backend=cpu", "/precision=double"});
  std::uint64_t expected = 0;
  std::size_t blocks = 0, seeded = 0;
  const Simulation simulation(experiment, [&](const Experiment& e, const Plan& plan, std::vector<SeededBody> seeds) {
    const cpu::Scene<2, double> scene(e, plan, 1);
    cpu::SortSpace space;
    for (int body = 0; body < 2; ++body) {
      cpu::Particles<2, double> particles;
      particles.lay_out(plan, body);
      particles.half_size.require(2 * cpu::chunk_size<double>);
      std::fill_n(particles.half_size.data(), 2 * cpu::chunk_size<double>, 0.5);
      cpu::seed_particles(particles, seeds[static_cast<std::size_t>(body)], scene.domain);
      cpu::sort_particles(particles, space, scene, true);
      expected += particles.pool.bytes() + particles.places.capacity() * sizeof(std::byte*) +
                  particles.blocks.capacity() * sizeof(cpu::Block<2>);
      blocks += particles.blocks.size();
      for (const Field& field : plan.fields)
        if (field.of_particles_of(body) && field.lifetime == Lifetime::seeded)
          seeded += seeds[static_cast<std::size_t>(body)].values(field).size();
    }
    expected += space.bytes() + seeded * sizeof(double);
    return make_cpu_backend(e, plan, std::move(seeds), 1);
  });
  CHECK(blocks > 14);
  CHECK(seeded > 0);
  CHECK(simulation.backend().particle_bytes() == expected);
}

// Of a few tries one at least is not broken off between the start and the end of its lap.
TEST_CASE("a lap of the clock of phases begins at its start", "[parity]") {
  cpu::PhaseClock clock;
  bool began = false;
  for (int attempt = 0; attempt < 5; ++attempt) {
    clock.measure(true);
    const cpu::PhaseClock::Ticks before = cpu::PhaseClock::now();
    for (const auto begin = std::chrono::steady_clock::now();
         std::chrono::steady_clock::now() - begin < std::chrono::microseconds(200);) {
    }
    const cpu::PhaseClock::Ticks waited = cpu::PhaseClock::now() - before;
    clock.start(), clock.lap(cpu::Phase::gather);
    began = began || 4 * clock.ticks[static_cast<std::size_t>(cpu::Phase::gather)] < waited;
  }
  CHECK(began);
}
