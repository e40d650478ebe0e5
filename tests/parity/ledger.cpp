// A ledger of every so many steps: its entries are those of the steps that it takes, on either backend, and what it
// leaves out changes nothing but rounding.

#include "parity/parity.hpp"
#include "support/results.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr int every = 3;
const std::string sampled = R"(/output={"ledger_every": 3})";

/// Mixes in which the ledger alone asks for what it reads, and others in which more does; each is named by what it has.
std::vector<Mix> mixes() {
  const std::string von_mises =
      R"({"type": "von_mises", "youngs_modulus": 1000, "poisson_ratio": 0.3, "density": 1000, "yield_stress": 60})";
  std::vector<Mix> all;
  for (const int dimension : {2, 3}) {
    Mix mix;
    mix.dimension = dimension;
    mix.transfer = R"({"type": "mls"})", mix.material = von_mises;
    all.push_back(mix);
    mix.close = true;  // the walls take part
    all.push_back(mix);
    mix.stress_update = "modified_last";
    all.push_back(mix);
    mix.stress_update = "last", mix.boundaries = R"({"all": "separate"})";
    all.push_back(mix);
    mix.boundaries = R"({"all": "slip"})", mix.transfer = R"({"type": "flip"})";
    all.push_back(mix);
    mix.transfer = R"({"type": "apic"})", mix.filter = R"({"type": "fmpm", "order": 3})";
    all.push_back(mix);
    mix.filter = R"({"type": "xpic", "order": 2})", mix.contact = R"({"type": "coulomb", "friction": 0.2})";
    mix.close = false;
    all.push_back(mix);
    mix.filter.clear();
    mix.more = dimension == 2 ? R"J(, "body_force": ["2*sin(3*X)+t", "x-Y*y"])J" : "";
    all.push_back(mix);
    mix.more.clear(), mix.contact.clear();
    for (const std::string shape : {"gimp", "cpdi"}) {  // their particles' affine energy changes as they move
      mix.shape = "{\"type\": \"" + shape + "\"}";
      all.push_back(mix);
    }
    mix.shape = Mix().shape, mix.stress_update = "first";
    mix.filter = R"({"type": "fmpm", "order": 2})";  // strains by the velocity before the filter
    all.push_back(mix);
  }
  return all;
}

}  // namespace

TEST_CASE("a ledger of every third step holds the entries of those steps", "[parity][ledger]") {
  for (const Mix& mix : mixes())
    for (const std::string backend : {"reference", "cpu"}) {
      INFO(mix.name() << " on " << backend);
      std::vector<std::string> overrides{set("/backend", backend), "/solver/end_time=1"};
      Scene whole(mix.text(), overrides);
      overrides.push_back(sampled);
      Scene part(mix.text(), overrides);
      std::vector<double> expected(values_of(Ledger{}).size()), counted = expected, before = expected;
      for (long step = 0; step < 14; ++step) {
        whole.run_steps(1), part.run_steps(1);
        const std::vector<double> now = values_of(whole.simulation.backend().ledger());
        for (std::size_t i = 0; i < now.size(); ++i)
          if (step == 0 || (step - 1) % every == every / 2) {
            expected[i] += now[i] - before[i];
            counted[i] += (step == 0 ? 1 : every) * (now[i] - before[i]);  // each entry stands for the steps around it
          }
        before = now;
      }
      const std::vector<double> found = values_of(part.simulation.backend().ledger());
      const double scale = whole.metrics.initial().kinetic;
      CHECK(difference(expected, found, scale) < 1e-11);
      CHECK(difference(counted, values_of(part.simulation.ledger()), scale) < 1e-11);
      CHECK(std::abs(found[0]) > 1e-6 * scale);  // the scatter's entry
      compare_states(whole, part, std::numeric_limits<double>::epsilon(), parity_tolerance);
    }
}

TEST_CASE("the backends keep the same ledger of every third step", "[parity][ledger]") {
  for (Mix mix : mixes()) {
    mix.overrides.push_back(sampled);
    check_parity(mix);
  }
}

TEST_CASE("a ledger of every third step is the same fused, apart and resumed", "[parity][ledger]") {
  for (const Mix& mix : mixes())
    for (const std::string precision : {"double", "float"}) {
      INFO(mix.name() << " " << precision);
      const std::vector<std::string> overrides{set("/precision", precision), "/solver/end_time=1", sampled};
      std::vector<std::string> apart = overrides;
      apart.push_back(set("/solver/passes", "separate"));
      CpuRun separate(mix.text(), apart, 1), whole(mix.text(), overrides, 2);
      separate.steps(14), whole.steps(5);
      ArchiveWriter archive;
      whole.simulation.save(archive);  // the next step is one that the ledger takes
      whole.steps(9);
      CHECK(different(all_results(separate.simulation), all_results(whole.simulation)) == 0);
      CpuRun resumed(mix.text(), overrides, 1);
      ArchiveReader reader(archive.bytes());
      resumed.simulation.restore(reader);
      resumed.steps(9);
      CHECK(different(all_results(whole.simulation), all_results(resumed.simulation)) == 0);
      CHECK(different(values_of(whole.simulation.ledger()), values_of(resumed.simulation.ledger())) == 0);
    }
}
