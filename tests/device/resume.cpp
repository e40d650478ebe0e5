// A run goes on with another backend than the one that began it: each gives and takes the same state.

#include <cstring>

#include "device/device_support.hpp"
#include "parity/heat_scenes.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// A mix on a backend by its name.
class Run {
 public:
  Run(const Mix& mix, const std::string& backend, const std::string& precision)
      : experiment(experiment_of(mix, backend, precision)), simulation(experiment, factory(backend)) {}
  void steps(int count) {
    for (int k = 0; k < count; ++k) simulation.step();
  }
  ArchiveWriter saved() const {
    ArchiveWriter archive;
    simulation.save(archive);
    return archive;
  }
  void restore(const ArchiveWriter& archive) {
    ArchiveReader reader(archive.bytes());
    simulation.restore(reader);
    CHECK(reader.at_end());
  }

  const Experiment experiment;
  Simulation simulation;

 private:
  static Experiment experiment_of(const Mix& mix, const std::string& backend, const std::string& precision) {
    Experiment experiment = device_experiment(mix.text(), precision, mix.overrides);
    experiment.backend = backend;
    return experiment;
  }
  static BackendFactory factory(const std::string& backend) {
    if (backend == "cuda") return device_factory();
    return [backend](const Experiment& e, const Plan& plan, std::vector<SeededBody> bodies) {
      return backend == "cpu" ? make_cpu_backend(e, plan, std::move(bodies), 1)
                              : make_reference_backend(e, plan, std::move(bodies));
    };
  }
};

/// The largest difference of particles and of the ledger, each value over the scene's scale of it, in epsilons.
double run_difference(const Run& expected, const Run& found, const std::string& precision) {
  const Backend &a = expected.simulation.backend(), &b = found.simulation.backend();
  double worst = 0;
  for (int body = 0; body < static_cast<int>(expected.experiment.bodies.size()); ++body)
    worst = larger(worst, state_difference(expected.experiment, a.body_state(body), b.body_state(body)));
  const double energy = Metrics(expected.simulation).initial().kinetic;
  worst = larger(worst, difference(ledger_values(expected), ledger_values(found), energy));
  return worst / epsilon_of(precision);
}

template <class Record>
bool same_bits(const Record& a, const Record& b) {
  return std::memcmp(&a, &b, sizeof(Record)) == 0;
}

void check_same_records(const Backend& a, const Backend& b) {
  CHECK(values_of(a.ledger()) == values_of(b.ledger()));
  CHECK(values_of(a.heat_ledger()) == values_of(b.heat_ledger()));
  CHECK(same_bits(a.contact_record(), b.contact_record()));
  CHECK(same_bits(a.filter_record(), b.filter_record()));
  const TimeStepLimit limit = a.time_step_limit(), found = b.time_step_limit();
  CHECK((found.speed == limit.speed && found.wave_speed == limit.wave_speed));
  CHECK((found.body == limit.body && found.particle == limit.particle));
  REQUIRE(a.reactions().size() == b.reactions().size());
  for (std::size_t k = 0; k < a.reactions().size(); ++k) CHECK(same_bits(a.reactions()[k], b.reactions()[k]));
  REQUIRE(a.contact_pairs().size() == b.contact_pairs().size());
  for (std::size_t k = 0; k < a.contact_pairs().size(); ++k)
    CHECK(same_bits(a.contact_pairs()[k], b.contact_pairs()[k]));
}

/// Goes 7 of 14 steps on one backend and the rest on the other. The end is that of a whole run on either, as near as
/// the two whole runs must be to each other.
void check_goes_on(const Mix& mix, const std::string& precision, const std::string& first, const std::string& second) {
  if (!is_chosen_check()) return;
  INFO(mix.name() << " " << precision << ", " << first << " to " << second);
  Run whole(mix, first, precision), other(mix, second, precision), part(mix, first, precision),
      resumed(mix, second, precision);
  whole.steps(14), other.steps(14);
  part.steps(7);
  resumed.steps(2);  // steps to be forgotten, whatever they did
  resumed.restore(part.saved());
  CHECK(resumed.simulation.steps() == 7);
  CHECK(resumed.simulation.time() == part.simulation.time());
  CHECK(run_difference(part, resumed, precision) <= 4);  // the state itself is the same: positions change their units
  check_same_records(part.simulation.backend(), resumed.simulation.backend());
  resumed.steps(7);
  CHECK(run_difference(whole, resumed, precision) <= device_bound(mix));
  CHECK(run_difference(other, resumed, precision) <= device_bound(mix));
}

/// Scenes that keep states of every kind.
std::vector<Mix> mixes() {
  std::vector<Mix> all(2);
  all[1].dimension = 3;
  Mix filtered;
  filtered.transfer = R"({"type": "flip"})", filtered.contact = R"({"type": "coulomb", "friction": 0.2})";
  filtered.filter = R"({"type": "fmpm", "order": 2, "every_steps": 3})";
  filtered.more = R"J(, "body_force": ["2*sin(3*X)+t", "x-Y*y"], "output": {"reactions": true})J";
  all.push_back(filtered);
  filtered.dimension = 3, filtered.more = "", filtered.shape = R"({"type": "gimp"})";
  all.push_back(filtered);
  for (const std::string order : {"modified_last", "first"}) {
    Mix corners;
    corners.shape = R"({"type": "cpdi2"})", corners.stress_update = order;
    all.push_back(corners);
    corners.shape = R"({"type": "cpdi"})", corners.transfer = R"({"type": "tpic"})";
    all.push_back(corners);
  }
  Mix melting;
  melting.material = material(plastic, melts + "}}");
  all.push_back(warm(melting));
  Mix rings;
  rings.overrides = {set("/grid/symmetry", "axisymmetric"), set("/gravity", "[0, -1.3]")};
  all.push_back(rings);
  Mix without_ledger;  // particles advance in one launch of the device
  without_ledger.more = R"(, "output": {"ledger": false})";
  all.push_back(without_ledger);
  Mix polynomials;
  polynomials.transfer = R"({"type": "polypic", "basis": "full"})";
  all.push_back(polynomials);
  return all;
}

}  // namespace

TEST_CASE("a run goes on with another backend, within rounding of the whole run on either", "[device][resume]") {
  for (const Mix& mix : mixes())
    for (const std::string precision : {"double", "float"}) {
      check_goes_on(mix, precision, "cpu", "cuda");
      check_goes_on(mix, precision, "cuda", "cpu");
      if (precision == "float") continue;  // the reference backend has doubles only
      check_goes_on(mix, precision, "reference", "cpu");
      check_goes_on(mix, precision, "cpu", "reference");
      check_goes_on(mix, precision, "reference", "cuda");
      check_goes_on(mix, precision, "cuda", "reference");
    }
}

TEST_CASE("a state of another precision is refused by every backend", "[device][resume]") {
  const Mix mix;
  for (const std::string writer : {"cpu", "cuda"})
    for (const std::string reader : {"cpu", "cuda"}) {
      INFO(writer << " to " << reader);
      Run written(mix, writer, "double"), read(mix, reader, "float");
      written.steps(1);
      CHECK_THROWS_AS(read.restore(written.saved()), ArchiveError);
    }
}
