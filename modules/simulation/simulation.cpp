#include "simulation/simulation.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <sstream>

#include "simulation/imposed_value.hpp"
#include "simulation/particle_changes.hpp"
#include "simulation/seeding.hpp"
#include "solvers/solver.hpp"

namespace mpm {

Simulation::Simulation(const Experiment& experiment, const BackendFactory& make_backend)
    : experiment_(experiment),
      plan_(make_plan(experiment)),
      solver_(solver_of(experiment)),
      make_backend_(make_backend),
      imposes_by_time_(imposes_by_time(experiment)) {
  for_each_pass(plan_.step, [&](const Pass& pass) {
    if (pass.has(Act::estimate_time_step)) estimate_every_ = pass.every_steps;
  });
  std::vector<SeededBody> bodies;
  for (int body = 0; body < static_cast<int>(experiment.bodies.size()); ++body)
    bodies.push_back(seed_body(experiment, body));
  if (!experiment.changer_of_particles().empty())
    changes_ = std::make_unique<ParticleChanges>(experiment_, plan_, bodies);
  for (const SeededBody& body : bodies) body_particles_.push_back(body.count()), particles_ += body.count();
  backend_ = make_backend(experiment_, plan_, std::move(bodies));
}

Simulation::~Simulation() = default;

Ledger Simulation::ledger() const {
  const Ledger steps =
      backend_->ledger().times(plan_.ledger_every).plus(first_entries_.times(1.0 - plan_.ledger_every));
  return changes_ ? steps.plus(changes_->ledger()) : steps;
}

HeatLedger Simulation::heat_ledger() const {
  return changes_ ? backend_->heat_ledger().plus(changes_->heat_ledger()) : backend_->heat_ledger();
}

bool Simulation::finished() const {
  return ends_at(time_) || steps_ >= experiment_.solver.max_steps;
}

bool Simulation::ends_at(double time) const {
  return time >= experiment_.solver.end_time * (1 - 1e-12);
}

/// Returns the fixed step, or what the solver allows, shortened to end at end_time. Nothing else changes it, so that
/// the cadence of outputs changes no result.
double Simulation::time_step_from(double time) const {
  const double wanted = experiment_.solver.time_step.value_or(estimate_);
  const double left = experiment_.solver.end_time - time;
  // A remainder of rounding is taken into the last step instead of making a tiny one.
  return left <= wanted * (1 + 1e-9) ? left : wanted;
}

/// Multiplies a fixed step instead of summing it, so that rounding does not grow with the number of steps.
double Simulation::end_of_step() const {
  const bool fixed = experiment_.solver.time_step && dt_ == *experiment_.solver.time_step;
  return fixed ? static_cast<double>(steps_ + 1) * dt_ : time_ + dt_;
}

void Simulation::take_limit() {
  const TimeStepLimit limit = backend_->time_step_limit();
  if (!(limit.speed > 0) || !std::isfinite(limit.speed))
    throw RunFailure({Cause::speed_not_a_number, limit.body, limit.particle, -1, limit.speed});
  estimated_speed_ = limit.speed;
  StepLimit allowed = solver_.limit(experiment_, {limit.speed});
  if (changes_) {  // a batch stands up to a step's way in front of its emitter
    const double until = time_ + static_cast<double>(estimate_every_) * allowed.seconds;
    const double speed = changes_->emitted_speed(time_, until);
    if (speed > limit.speed) allowed = solver_.limit(experiment_, {speed});
  }
  estimate_ = allowed.seconds;
  if (experiment_.solver.time_step) return;
  limited_by_ = allowed.reason;
  limited_by_speed_ = allowed.by_speed;
}

FailurePlace Simulation::place_of(const Failure& failure) const {
  if (!is_of_a_particle(failure.cause)) return {steps_, time_, {}};
  const std::vector<double> positions = backend_->body_state(failure.body).position;
  const auto D = static_cast<std::ptrdiff_t>(experiment_.dimension);
  const auto first = positions.begin() + static_cast<std::ptrdiff_t>(failure.particle) * D;
  return {steps_ + 1, time_, {first, first + D}};
}

/// Whether the filter acts in the step that begins now.
bool Simulation::filter_due() {
  if (!plan_.filters()) return false;
  const FilterSchedule& schedule = experiment_.filter_schedule;
  if (schedule.every_time == 0 && schedule.every_courant == 0) return (steps_ + 1) % schedule.every_steps == 0;
  const bool by_time = schedule.every_time > 0;
  const double interval = by_time ? schedule.every_time : schedule.every_courant;
  filter_clock_ += by_time ? dt_ : dt_ * estimated_speed_ / experiment_.grid.cell_size;
  if (filter_clock_ < interval * (1 - 1e-9)) return false;
  filter_clock_ -= interval * std::floor(filter_clock_ / interval * (1 + 1e-9));
  return true;
}

bool Simulation::changes_at(double time, long steps) const {
  return changes_ && changes_->due(time, steps);
}

bool Simulation::ends_with_step() const {
  return ends_at(end_of_step()) || steps_ + 1 >= experiment_.solver.max_steps;
}

/// The next step's scatter needs its dt and its particles: it may neither precede an estimate or a change of the particles
/// nor be done when there is no next step.
bool Simulation::may_scatter_ahead() const {
  return !ends_with_step() && !changes_at(end_of_step(), steps_ + 1) && (steps_ + 1) % estimate_every_ != 0;
}

void Simulation::execute(const Step& step, StepInfo& info) {
  switch (step.kind) {
    case Step::Kind::pass:
      if (steps_ % step.pass.every_steps == 0 || (must_estimate_ && step.pass.has(Act::estimate_time_step)))
        execute(step.pass, info);
      return;
    case Step::Kind::sequence:
      for (const Step& child : step.children) execute(child, info);
      return;
    case Step::Kind::repeat_until:
      for (int i = 0; i < step.times; ++i) {
        for (const Step& child : step.children) execute(child, info);
        ++filter_passes_;
        const double tolerance = experiment_.filter_schedule.tolerance;
        if (tolerance == 0) continue;  // a device then knows no norm before the step's end
        const FilterRecord& record = backend_->filter_record();
        if (record.last_norm <= tolerance * record.first_norm) return;
      }
      return;
    case Step::Kind::when:
      begin(info);
      if (step.condition == Condition::may_scatter_ahead) return gather(step, info);
      if (step.condition == Condition::when_filtered ? info.filtered : !scattered_)
        for (const Step& child : step.children) execute(child, info);
  }
}

/// Executes the gather that ends a step, and with it the next step's scatter where that step's dt is known by now.
void Simulation::gather(const Step& step, StepInfo& info) {
  const bool ahead = may_scatter_ahead();
  info.next_time = end_of_step();
  info.next_dt = time_step_from(info.next_time);
  // The state is whole where no scatter goes ahead. A stop may have been asked for since the step began.
  observed_ = info.observed = !ahead || info.observed || wanted_(info.next_time, steps_ + 1);
  execute(step.children[ahead ? 0 : 1], info);
  scattered_ = ahead && backend_->scattered();
}

/// Chooses dt, and whether the filter acts, once the limit of the step is known.
void Simulation::begin(StepInfo& info) {
  if (chosen_) return;
  dt_ = info.dt = time_step_from(time_);
  if (imposes_by_time_) stop_at_impossible_value(experiment_, {time_, time_ + dt_});
  info.filtered = filter_due();
  info.observed = ends_with_step() || !wanted_ || wanted_(end_of_step(), steps_ + 1);
  chosen_ = true;
}

void Simulation::execute(const Pass& pass, StepInfo& info) {
  const bool estimates = pass.has(Act::estimate_time_step);
  if (!estimates) begin(info);
  const auto start = std::chrono::steady_clock::now();
  backend_->execute(pass, info);
  if (estimates) must_estimate_ = false;
  seconds_[pass.name()] += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (estimates) take_limit();
}

void Simulation::step() {
  StepInfo info{0, time_, steps_};
  chosen_ = false;
  execute(plan_.step, info);
  time_ = end_of_step();
  if (++steps_ == 1) first_entries_ = backend_->ledger();
  if (steps_ == 1 || dt_ < smallest_) {
    const bool shortened = !limited_by_.empty() && dt_ < estimate_ * (1 - 1e-9);
    smallest_limited_by_ = shortened ? "end of the run" : limited_by_;
    smallest_ = dt_;
  }
  largest_ = std::max(largest_, dt_);
  particle_steps_ += static_cast<double>(particles_);
  if (changes_at(time_, steps_)) change_particles();
}

void Simulation::count_particles() {
  particles_ = 0;
  for (std::size_t body = 0; body < body_particles_.size(); ++body) {
    const std::size_t scalars = backend_->body_state(static_cast<int>(body)).position.size();
    body_particles_[body] = scalars / static_cast<std::size_t>(experiment_.dimension);
    particles_ += body_particles_[body];
  }
}

/// Goes on with other particles where any have changed. The grid is scattered anew, and the step chosen for them.
void Simulation::change_particles() {
  const auto start = std::chrono::steady_clock::now();
  std::unique_ptr<Backend> next = changes_->make(*backend_, make_backend_, time_, steps_);
  seconds_["change particles"] += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (!next) return;
  backend_ = std::move(next);
  count_particles();
  scattered_ = false;
  must_estimate_ = true;
}

void Simulation::save(ArchiveWriter& archive) const {
  if (!observed_) throw std::logic_error("the last step was not to be observed: its state cannot be saved");
  for (const auto& [tag, value] : {std::pair{"time", &time_}, std::pair{"dt", &dt_}, std::pair{"estimate", &estimate_},
                                   std::pair{"smallest", &smallest_}, std::pair{"largest", &largest_},
                                   std::pair{"speed", &estimated_speed_}, std::pair{"filter_clock", &filter_clock_}})
    archive.put(tag, *value);
  archive.put("steps", steps_);
  archive.put("filter_passes", filter_passes_);
  archive.put("particles", particles_);
  archive.put("first_entries", first_entries_);
  archive.put("limited_by", limited_by_);
  archive.put("limited_by_speed", limited_by_speed_);
  archive.put("smallest_limited_by", smallest_limited_by_);
  archive.put("particle_steps", particle_steps_);
  if (changes_) {
    archive.put("must_estimate", must_estimate_);
    changes_->save(archive, *backend_);
  }
  backend_->save(archive);
}

/// The grid is not saved: the next step scatters again, which gives the same bits as the fused pass gave.
void Simulation::restore(ArchiveReader& archive) {
  for (const auto& [tag, value] : {std::pair{"time", &time_}, std::pair{"dt", &dt_}, std::pair{"estimate", &estimate_},
                                   std::pair{"smallest", &smallest_}, std::pair{"largest", &largest_},
                                   std::pair{"speed", &estimated_speed_}, std::pair{"filter_clock", &filter_clock_}})
    archive.get(tag, *value);
  archive.get("steps", steps_);
  archive.get("filter_passes", filter_passes_);
  std::size_t particles = 0;
  archive.get("particles", particles);
  if (particles != particles_ && !changes_) throw ArchiveError("it holds another number of particles");
  archive.get("first_entries", first_entries_);
  archive.get("limited_by", limited_by_);
  archive.get("limited_by_speed", limited_by_speed_);
  archive.get("smallest_limited_by", smallest_limited_by_);
  archive.get("particle_steps", particle_steps_);
  if (changes_) {
    archive.get("must_estimate", must_estimate_);
    backend_ = changes_->restore(archive, *backend_, make_backend_);
  }
  backend_->restore(archive);
  if (changes_) count_particles();
  scattered_ = false;
  observed_ = true;
}

std::string Simulation::limiting_particle() const {
  if (!limited_by_speed_) return "";
  const TimeStepLimit limit = backend_->time_step_limit();
  std::ostringstream out;
  out << "particle " << limit.particle << " of " << experiment_.bodies[limit.body].name << " (wave " << limit.wave_speed
      << " m/s + speed " << limit.speed - limit.wave_speed << " m/s)";
  return out.str();
}

}  // namespace mpm
