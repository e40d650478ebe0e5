// What the cpu backend says of its own memory and time.

#include <chrono>
#include <numeric>

#include "backends/cpu/particles/particles.hpp"
#include "backends/cpu/phase_clock.hpp"
#include "support/catch.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::test;

TEST_CASE("the bytes of a sort are those of its arrays") {
  cpu::SortSpace space;
  CHECK(space.bytes() == 0);
  space.key.resize(1000), space.leaving.resize(500), space.far_rows.resize(300);
  for (auto& rows : space.rows) rows.require(cpu::page);
  CHECK(space.bytes() == 1000 * 2 + 500 * 8 + 300 + 3 * cpu::page);
}

// A full block of 8 x 8 particles takes the state of each, and a sort a few bytes more.
TEST_CASE("the bytes that particles hold are those of their fields, of all bodies") {
  const std::string text = R"({"title": "blocks", "dimension": 2,
    "grid": {"cell_size": 0.1, "domain": [[0, 0], [8, 8]]}, "shape": {"type": "linear"}, "transfer": {"type": "apic"},
    "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1, "poisson_ratio": 0.3, "density": 1000}},
    "bodies": [{"name": "a", "material": "m", "geometry": {"type": "box", "lower": [0, 0], "upper": [4, 8]}},
               {"name": "b", "material": "m", "geometry": {"type": "box", "lower": [4, 0], "upper": [8, 8]}}],
    "solver": {"time_step": 0.01, "end_time": 1}})";
  const Scene scene(text, {"/backend=cpu"});
  const std::uint64_t count = scene.simulation.particle_count(), held = scene.simulation.backend().particle_bytes(),
                      state = count * scene.simulation.plan().bytes_per_particle(0);
  REQUIRE(count == 80u * 80 * 4);
  CHECK(held >= state);
  CHECK(4 * held <= 5 * state);
}

TEST_CASE("a clock of phases counts while it measures, and then only") {
  using cpu::Phase;
  cpu::PhaseClock clock;
  const auto of = [&](Phase phase) { return clock.ticks[static_cast<std::size_t>(phase)]; };
  const auto pass_time = [] {
    for (const auto begin = std::chrono::steady_clock::now();
         std::chrono::steady_clock::now() - begin < std::chrono::microseconds(20);) {
    }
  };
  clock.start(), pass_time(), clock.lap(Phase::gather);
  CHECK(of(Phase::gather) == 0);
  clock.measure(true);
  clock.start(), pass_time(), clock.lap(Phase::gather);
  const auto gathered = of(Phase::gather);
  CHECK(gathered > 0);
  CHECK(std::accumulate(clock.ticks.begin(), clock.ticks.end(), cpu::PhaseClock::Ticks{0}) == gathered);
  clock.measure(false);
  clock.start(), pass_time(), clock.lap(Phase::gather);
  CHECK(of(Phase::gather) == gathered);
  clock.measure(true);
  CHECK(of(Phase::gather) == 0);
}
