#include "simulation/particle_changes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "experiment/diagnostics.hpp"
#include "metrics/body_sums.hpp"
#include "plan/memory.hpp"
#include "simulation/material_changes.hpp"
#include "simulation/sinks.hpp"

namespace mpm {
namespace {

std::vector<std::size_t> numbers_from(std::size_t first, std::size_t count) {
  std::vector<std::size_t> numbers(count);
  std::iota(numbers.begin(), numbers.end(), first);
  return numbers;
}

std::vector<SeededBody> without_seeds(const std::vector<SeededBody>& seeds) {
  std::vector<SeededBody> bodies;
  for (const SeededBody& seeded : seeds) {
    SeededBody& body = bodies.emplace_back();
    body.volume = seeded.volume, body.mass = seeded.mass, body.dimension = seeded.dimension;
  }
  return bodies;
}

}  // namespace

void Exchange::add(const Totals& totals, double count, double sign) {
  particles += count;
  mass += sign * totals.mass;
  energy += sign * totals.total_energy();
  heat += sign * (totals.heat_content + totals.latent_heat);
  for (std::size_t c = 0; c < 3; ++c) momentum[c] += sign * totals.momentum[c];
}

/// The changes after one step, on their way.
struct ParticleChanges::Work {
  Work(const Experiment& experiment, const Plan& plan, const Backend& present)
      : backend(present),
        state(experiment, plan),
        gone(experiment.bodies.size()),
        newcomers(experiment.bodies.size()) {}

  const Backend& backend;
  ParticleState state;                       ///< of particles that stay
  std::vector<std::vector<bool>> gone;       ///< particles that do not stay, by body; empty where all do
  std::vector<Newcomers> newcomers;          ///< what bodies are given, particles of other bodies first
  std::vector<Changed> changed;              ///< particles that go over
  std::vector<MaterialChange> changes;       ///< what they become, by the bodies between which they go
  std::vector<std::size_t> first_of_change;  ///< of each change: its first particle among the newcomers
  std::vector<std::size_t> changed_to;       ///< by body: how many of the newcomers are such
  std::unique_ptr<Backend> next;
};

ParticleChanges::ParticleChanges(const Experiment& experiment, const Plan& plan, std::vector<SeededBody>& seeds)
    : experiment_(experiment), plan_(plan), of_start_(without_seeds(seeds)), emitters_(experiment, seeds) {
  refuse_unknown_quantities(experiment);
  emitters_.begin(seeds);
}

bool ParticleChanges::due(double time, long steps) const {
  return emitters_.due(time) || sinks_are_due(experiment_, time, steps) ||
         changes_of_material_are_due(experiment_, steps);
}

Totals ParticleChanges::totals_of(const Backend& backend, int body, const std::vector<std::size_t>& particles) const {
  Totals totals = no_totals(experiment_);
  if (particles.empty()) return totals;
  const BodyView view(experiment_, plan_, body, backend.body_state(body));
  for (const std::size_t p : particles) {
    add_particle(view, p, totals);
    if (experiment_.has_temperature()) add_heat(view, p, totals);
  }
  return totals;
}

std::unique_ptr<Backend> ParticleChanges::make(const Backend& backend, const BackendFactory& make_backend, double time,
                                               long steps) {
  Work work(experiment_, plan_, backend);
  work.gone = caught_by_sinks(experiment_, backend, time, steps);
  const auto any = [](const std::vector<bool>& marks) {
    return std::find(marks.begin(), marks.end(), true) != marks.end();
  };
  work.changed = changing_particles(experiment_, backend, steps, work.gone);
  const bool caught = std::any_of(work.gone.begin(), work.gone.end(), any);
  if (!caught && work.changed.empty() && !emitters_.due(time)) return nullptr;
  const std::array<Exchange, 3> counted{emitted_, removed_, changed_};
  ArchiveWriter emitters;
  emitters_.save(emitters);
  try {
    work.state.read(backend);
    take_out(work);
    change_materials(work);
    emitters_.emit(time, work.state, work.newcomers);
    build(work, make_backend);
  } catch (...) {
    emitted_ = counted[0], removed_ = counted[1], changed_ = counted[2];
    ArchiveReader saved(emitters.bytes());
    emitters_.restore(saved);
    throw;
  }
  return std::move(work.next);
}

/// Books the particles that sinks have caught.
void ParticleChanges::take_out(Work& work) {
  for (std::size_t body = 0; body < work.gone.size(); ++body) {
    std::vector<std::size_t> caught;
    for (std::size_t p = 0; p < work.gone[body].size(); ++p)
      if (work.gone[body][p]) caught.push_back(p);
    removed_.add(totals_of(work.backend, static_cast<int>(body), caught), static_cast<double>(caught.size()));
  }
}

/// Finds what the particles that go over become, books what they were, and leaves out all that do not stay.
void ParticleChanges::change_materials(Work& work) {
  work.changed_to.assign(of_start_.size(), 0);
  // What goes from one body to one other stands together, as a body's particles go to one other body alone.
  for (auto first = work.changed.begin(); first != work.changed.end();) {
    const auto last = std::find_if(first, work.changed.end(), [&](const Changed& c) { return c.from != first->from; });
    const std::vector<Changed> some(first, last);
    const auto from = static_cast<std::size_t>(first->from), to = static_cast<std::size_t>(first->to);
    const BodyView view(experiment_, plan_, first->from, work.backend.body_state(first->from));
    const MaterialChange& change = work.changes.emplace_back(experiment_, view, work.state, some, of_start_[to]);
    work.first_of_change.push_back(work.changed_to[to]);
    work.changed_to[to] += some.size();
    work.newcomers[to].append(change.newcomers());
    std::vector<std::size_t> numbers;
    for (const Changed& changed : some) numbers.push_back(changed.particle);
    changed_.add(totals_of(work.backend, first->from, numbers), static_cast<double>(some.size()), -1);
    if (work.gone[from].empty()) work.gone[from].resize(work.state.bodies()[from].count);
    for (const std::size_t p : numbers) work.gone[from][p] = true;
    first = last;
  }
  for (std::size_t body = 0; body < work.gone.size(); ++body)
    if (!work.gone[body].empty())
      work.state.bodies()[body].remove(work.gone[body], static_cast<std::size_t>(experiment_.dimension));
}

std::unique_ptr<Backend> ParticleChanges::backend_for(const ParticleState& state,
                                                      const std::vector<Newcomers>& newcomers,
                                                      const BackendFactory& make_backend) const {
  std::vector<SeededBody> seeds;
  for (std::size_t body = 0; body < of_start_.size(); ++body)
    seeds.push_back(state.seeds(body, of_start_[body], newcomers[body]));
  return make_backend(experiment_, plan_, std::move(seeds));
}

/// Stops where the machine cannot hold the particles once more: both backends stand side by side for a moment.
void ParticleChanges::stop_beyond_memory(const Work& work) const {
  double bytes = 0;
  int body_of_most = 0;
  std::size_t most = 0;
  for (std::size_t body = 0; body < of_start_.size(); ++body) {
    const std::size_t count = work.state.bodies()[body].count + work.newcomers[body].count;
    bytes += static_cast<double>(count) * static_cast<double>(plan_.bytes_per_particle(static_cast<int>(body)));
    if (count > most) most = count, body_of_most = static_cast<int>(body);
  }
  constexpr double copies = 3;  // as the next backend keeps them, as it saves them, and as doubles
  const double free = available_bytes();
  if (copies * bytes < 0.9 * free) return;
  Failure failure{Cause::too_many_particles, body_of_most, 0, -1, static_cast<double>(most)};
  failure.formula = "they take " + number_text(std::round(copies * bytes / 1e6)) + " MB more, and " +
                    number_text(std::round(free / 1e6)) + " MB are free";
  throw RunFailure(failure);
}

/// Builds the backend that goes on: newcomers as it seeds them, all others as they were.
void ParticleChanges::build(Work& work, const BackendFactory& make_backend) {
  std::size_t count = 0;
  std::vector<std::size_t> kept;
  for (std::size_t body = 0; body < of_start_.size(); ++body) {
    kept.push_back(work.state.bodies()[body].count);
    count += kept.back() + work.newcomers[body].count;
  }
  if (count == 0) throw RunFailure({Cause::no_particle_left});
  stop_beyond_memory(work);
  work.next = backend_for(work.state, work.newcomers, make_backend);
  ParticleState next(experiment_, plan_);
  next.read(*work.next);
  for (std::size_t body = 0; body < of_start_.size(); ++body) {
    const ParticleState::OfBody& before = work.state.bodies()[body];
    ParticleState::OfBody& after = next.bodies()[body];
    std::copy(before.position.begin(), before.position.end(), after.position.begin());
    for (std::size_t k = 0; k < after.fields.size(); ++k)
      std::copy(before.fields[k].begin(), before.fields[k].end(), after.fields[k].begin());
  }
  std::size_t number = 0;
  for (const MaterialChange& change : work.changes) {
    const std::size_t to = change.to();
    change.put(next, kept[to] + work.first_of_change[number++]);
  }
  ArchiveWriter edited;
  next.write(edited, work.backend);
  ArchiveReader archive(edited.bytes());
  work.next->restore(archive);
  for (std::size_t body = 0; body < of_start_.size(); ++body) {
    const std::size_t changed = work.changed_to[body], emitted = next.bodies()[body].count - kept[body] - changed;
    const int index = static_cast<int>(body);
    changed_.add(totals_of(*work.next, index, numbers_from(kept[body], changed)), 0);
    emitted_.add(totals_of(*work.next, index, numbers_from(kept[body] + changed, emitted)),
                 static_cast<double>(emitted));
  }
}

Ledger ParticleChanges::ledger() const {
  Ledger ledger;
  ledger.emitted = emitted_.energy, ledger.removed = -removed_.energy, ledger.changed_material = changed_.energy;
  return ledger;
}

HeatLedger ParticleChanges::heat_ledger() const {
  HeatLedger ledger;
  ledger.emitted = emitted_.heat, ledger.removed = -removed_.heat, ledger.changed_material = changed_.heat;
  return ledger;
}

void ParticleChanges::save(ArchiveWriter& archive, const Backend& backend) const {
  archive.put("emitted", emitted_);
  archive.put("removed", removed_);
  archive.put("changed", changed_);
  emitters_.save(archive);
  for (int body = 0; body < static_cast<int>(of_start_.size()); ++body)
    archive.put("initial_position", backend.body_state(body).initial_position);
}

std::unique_ptr<Backend> ParticleChanges::restore(ArchiveReader& archive, const Backend& begun,
                                                  const BackendFactory& make_backend) {
  archive.get("emitted", emitted_);
  archive.get("removed", removed_);
  archive.get("changed", changed_);
  emitters_.restore(archive);
  std::vector<std::vector<double>> initial(of_start_.size());
  for (std::vector<double>& places : initial) archive.get("initial_position", places);
  ArchiveReader ahead = archive;
  ParticleState state(experiment_, plan_);
  state.read(ahead, begun);
  for (std::size_t body = 0; body < initial.size(); ++body) {
    ParticleState::OfBody& particles = state.bodies()[body];
    if (state.keeps_initial_position(body) && initial[body].size() != particles.position.size())
      throw ArchiveError("value \"initial_position\" is of other particles");
    particles.initial_position = std::move(initial[body]);
  }
  return backend_for(state, std::vector<Newcomers>(initial.size()), make_backend);
}

}  // namespace mpm
