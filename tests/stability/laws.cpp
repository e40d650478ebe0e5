// Every material at its extremes, by the driver that `mpm drive --extremes` has; and laws with planted mistakes, which it
// must name.

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

#include "cli/program.hpp"
#include "drive/extremes.hpp"
#include "materials/ideal_gas/ideal_gas.hpp"
#include "materials/neo_hookean/neo_hookean.hpp"
#include "mpm/bench_suite.hpp"
#include "plugin/sdk.hpp"
#include "support/page.hpp"

using namespace mpm::test;

namespace mpm {  // so that functors find mpm::log and its like, as those of the modules do
namespace {

constexpr sdk::Manual manual{"wrong", "1.0.0", "a wrong one", "none", "for tests", "Wrong"};
constexpr const char* source = "struct Wrong {};";

struct NoEnergyWhenCrushed : NeoHookean {  // its energy is no number below J = 1e-3
  template <class G, class S = typename G::Scalar>
  MPM_HD static S stored_energy(const Constants<scalar_of<S>>& c, const ElasticState<G>& state) {
    return NeoHookean::stored_energy(c, state) + real<S>(0) * log(volume_ratio(state) - real<S>(1e-3));
  }
};
struct LosesVolume : NeoHookean {  // its volume changes by a hundredth more than it should
  template <class G, class S = typename G::Scalar>
  MPM_HD static S volume_ratio(const ElasticState<G>& state) {
    return exp(real<S>(1.01) * log(NeoHookean::volume_ratio(state)));
  }
};
struct TakesInsideOut : NeoHookean {
  template <class G, class S = typename G::Scalar>
  MPM_HD static S volume_ratio(const ElasticState<G>& state) {
    return abs(NeoHookean::volume_ratio(state));
  }
  template <class G, class S = typename G::Scalar>
  MPM_HD static Sym<G::dimension, S> kirchhoff_stress(const Constants<scalar_of<S>>&, const ElasticState<G>&) {
    return {};
  }
  template <class G, class S = typename G::Scalar>
  MPM_HD static S stored_energy(const Constants<scalar_of<S>>&, const ElasticState<G>&) {
    return S(real<S>(0));
  }
  template <class G, class S = typename G::Scalar>
  MPM_HD static S wave_speed(const Constants<scalar_of<S>>&, const ElasticState<G>&) {
    return S(real<S>(1));
  }
};
struct OwesEnergy : NeoHookean {
  template <class G, class S = typename G::Scalar>
  MPM_HD static S stored_energy(const Constants<scalar_of<S>>& c, const ElasticState<G>& state) {
    return -NeoHookean::stored_energy(c, state);
  }
};
struct Creeps
    : NeoHookean {  // takes steps for a thousandth longer than they are, so that the way back is not the way there
  template <class G, class S = typename G::Scalar>
  MPM_HD static S advance(const Constants<scalar_of<S>>& c, const G& L, scalar_of<S> dt, ElasticState<G>& state) {
    return NeoHookean::advance(c, L, real<S>(1.001) * dt, state);
  }
};

std::vector<drive::Extreme> extremes_of(const Plugin& plugin, int dimension, long cycles) {
  static const Registry registry = Registry::from_folders(Registry::default_folders());
  static const app::BenchSuite suite(registry, true);
  const Component material = suite.material(plugin);
  drive::ExtremeSize size;
  size.cycles = cycles;
  return drive::extremes(material, dimension, size, [] { return false; });
}

/// The outcomes that are not as they should be, in 3-D.
template <class F>
std::set<std::string> failures() {
  static constexpr mpm_descriptor descriptor = sdk::material<F>(manual, source);
  std::set<std::string> names;
  for (const drive::Extreme& extreme : extremes_of(Plugin{&descriptor, "test"}, 3, 10))
    if (!extreme.holds()) names.insert(extreme.outcome_text());
  return names;
}

using Names = std::set<std::string>;

/// Pa, above what rounding leaves of a stress that is zero; the laws are of 1e5 Pa.
constexpr double rounding_of_stress = 1e-6;

}  // namespace

TEST_CASE("every law is right at its extremes or refuses the particle, and small cycles drift by less than rounding") {
  const Registry registry = Registry::from_folders(Registry::default_folders());
  int laws = 0;
  for (const Plugin* plugin : registry.of_kind(MPM_MATERIAL))
    for (const int dimension : {2, 3}) {
      for (const drive::Extreme& extreme : extremes_of(*plugin, dimension, 2000)) {
        INFO(plugin->id() << ", " << dimension << "-D, " << extreme.name << ": " << extreme.outcome_text());
        CHECK(extreme.holds());
        // None of those that are shipped has to refuse what a body can be.
        CHECK((extreme.must_be_refused || extreme.outcome == drive::Outcome::right));
        CHECK(extreme.drift < 1);
      }
      ++laws;
    }
  CHECK(laws >= 48);
}

TEST_CASE("a million small cycles of every law drift by less than a rounding each", "[slow]") {
  const Registry registry = Registry::from_folders(Registry::default_folders());
  for (const Plugin* plugin : registry.of_kind(MPM_MATERIAL)) {
    const drive::Extreme cycles = extremes_of(*plugin, 3, 1000000).back();
    INFO(plugin->id() << ": " << cycles.drift);
    CHECK(cycles.outcome == drive::Outcome::right);
    CHECK(cycles.drift < 1);
  }
}

TEST_CASE("a law that is right at the extremes by a clamp says so, once a clamp") {
  const Folder folder;
  const Result snow = call(folder, {"drive", "snow", "--extremes", "--cycles", "10", "--param", "youngs_modulus=1e5",
                                    "--param", "poisson_ratio=0.2", "--param", "density=400"});
  CHECK(snow.code == 0);
  CHECK(has(snow.out, "pressed evenly          right, clamped "));
  CHECK(has(snow.out, "sheared                 right  "));
  CHECK(has(snow.err, "warning: material \"snow\" was clamped (pressed evenly): below J_P = "));
  CHECK(has(snow.err, "warning: material \"snow\" was clamped (torn evenly): above J_P = "));
  CHECK(std::count(snow.err.begin(), snow.err.end(), '\n') == 2);
  // The Hugoniot's pole lies at J = 1 - 1/s, and the clamp at 1 - 0.9/s (kernel/equation_of_state.hpp), s = 2.
  const Result water = call(folder, {"drive", "newtonian_fluid", "--extremes", "--cycles", "10", "--cell-size", "0.1",
                                     "--param", "bulk_modulus=1e6", "--param", "density=1000", "--param", "viscosity=1",
                                     "--param", "equation_of_state=mie_gruneisen", "--param", "hugoniot_slope=2"});
  CHECK(has(water.err, "was clamped (pressed evenly): below J = 0.55, "));
  // With s = 95 the clamp is at 0.9905, above the state about which small cycles go.
  const Result steep = call(folder, {"drive", "newtonian_fluid", "--extremes", "--cycles", "10", "--cell-size", "0.1",
                                     "--param", "bulk_modulus=1e6", "--param", "density=1000", "--param", "viscosity=1",
                                     "--param", "equation_of_state=mie_gruneisen", "--param", "hugoniot_slope=95"});
  CHECK(has(steep.out, "10 small cycles         right, clamped "));
  CHECK(has(steep.err, "was clamped (pressed evenly, 10 small cycles): below J = 0.991, "));
  CHECK(call(folder, {"drive", "neo_hookean", "--extremes", "--cycles", "10", "--param", "youngs_modulus=1e5",
                      "--param", "poisson_ratio=0.2", "--param", "density=400"})
            .err.empty());
}

TEST_CASE("mistakes at the extremes are named") {
  CHECK(failures<NeoHookean>().empty());
  CHECK(failures<IdealGas>().empty());
  CHECK(failures<NoEnergyWhenCrushed>() == Names{"NOT FINITE"});
  CHECK(failures<LosesVolume>() == Names{"WRONG J"});
  CHECK(failures<TakesInsideOut>().count("TAKEN") == 1);
  CHECK(failures<OwesEnergy>() == Names{"NEGATIVE ENERGY"});
  static constexpr mpm_descriptor creeping = sdk::material<Creeps>(manual, source);
  CHECK(extremes_of(Plugin{&creeping, "test"}, 3, 2000).back().drift > 100);
}

TEST_CASE("the page of the material point has the speeds of waves at rest, and what of it crushed metals keep",
          "[docs]") {
  const Registry registry = Registry::from_folders(Registry::default_folders());
  const app::BenchSuite suite(registry, true);
  const Page page("docs/material_point.md");
  double least = 1e300, most = 0;
  for (const Plugin* plugin : registry.of_kind(MPM_MATERIAL)) {
    const Component material = suite.material(*plugin);
    const double speed = drive::MaterialPoint(material, 3).look().wave_speed;
    const std::string law(plugin->id());
    INFO(law << ": " << speed << " m/s");
    if (law == "ideal_gas") {
      CHECK(speed == page.read("`ideal_gas` has # m/s at rest").front().rounded());
      continue;
    }
    if (law == "mie_gruneisen") {
      CHECK(speed == page.read("`mie_gruneisen` has # m/s").front().rounded());
      continue;
    }
    least = smaller(least, speed), most = larger(most, speed);
    if (law != "johnson_cook" && !law.starts_with("von_mises")) continue;
    const auto rows = extremes_of(*plugin, 3, 1);
    const auto pressed =
        std::find_if(rows.begin(), rows.end(), [](const drive::Extreme& row) { return row.name == "pressed evenly"; });
    REQUIRE(pressed != rows.end());
    CHECK(pressed->end.wave_speed / speed ==
          page.read("those of the metals come to # of their speed at rest").front().rounded());
  }
  // As tens around all of them.
  const auto range = page.read("waves are about as fast as in rubber of 400 kPa, # to # m/s");
  INFO(least << " to " << most << " m/s");
  CHECK(10 * std::floor(least / 10) == range[0].value);
  CHECK(10 * std::ceil(most / 10) == range[1].value);
}

TEST_CASE("the page of the material point has what mpm drive every says", "[docs]") {
  const Folder folder;
  const Result result = call(folder, {"drive", "every", "--extremes", "--cycles", "1000"});
  INFO(result.err);
  REQUIRE(result.code == 0);
  std::istringstream printed(result.out);
  const std::string page = slurp(std::string(MPM_SOURCE_DIR) + "/docs/material_point.md");
  int rows = 0, clamps = 0;
  for (std::string line; std::getline(printed, line);) {
    std::istringstream words(line);
    std::string law, word;
    words >> law;
    const std::size_t at = page.find("\n" + law + " ");
    INFO(line);
    if (law == "clamped") {
      CHECK(has(page, "\n" + line + "\n"));
      ++clamps;
    }
    if (law.empty() || line.front() == ' ' || law == "material") continue;
    REQUIRE(at != std::string::npos);
    std::istringstream there(page.substr(at + 1 + law.size(), page.find('\n', at + 1) - at - 1 - law.size()));
    // To a tenth, as the page has two digits, but for what is rounding, which differs by machines: stresses of nothing and the
    // drift.
    for (int column = 0; column < 8; ++column) {
      std::string now, then;
      words >> now, there >> then;
      INFO("column " << column + 1 << " of 8");
      REQUIRE(!now.empty());
      if (column == 7)
        CHECK(std::abs(std::log2(std::stod(now) / std::stod(then))) < 1);
      else
        CHECK(std::stod(now) == Approx(std::stod(then)).epsilon(0.1).margin(rounding_of_stress));
    }
    ++rows;
  }
  CHECK(rows >= 24);
  const std::size_t table = page.find("\nmaterial  ");
  const std::string block = page.substr(table, page.find("```", table) - table);
  CHECK(std::count(block.begin(), block.end(), '\n') == rows + clamps + 3);  // two lines of the head, and the end
  CHECK(clamps == 4);
  const Result wrong = call(folder, {"drive", "every"});
  CHECK(wrong.code == 2);
  CHECK(has(wrong.err, "takes --extremes"));
}

}  // namespace mpm
