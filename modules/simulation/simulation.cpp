#include "simulation/simulation.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <sstream>

#include "simulation/seeding.hpp"

namespace mpm {

Simulation::Simulation(const Experiment& experiment, const BackendFactory& make_backend)
    : experiment_(experiment), plan_(make_plan(experiment)) {
  std::vector<SeededBody> bodies;
  for (int body = 0; body < static_cast<int>(experiment.bodies.size()); ++body)
    bodies.push_back(seed_body(experiment, body));
  for (const SeededBody& body : bodies) body_particles_.push_back(body.count()), particles_ += body.count();
  backend_ = make_backend(experiment_, plan_, std::move(bodies));
}

bool Simulation::finished() const {
  return time_ >= experiment_.solver.end_time * (1 - 1e-12) || steps_ >= experiment_.solver.max_steps;
}

/// The fixed step, or courant h / (wave speed + particle speed); shortened to end at end_time. Nothing else changes it,
/// so that the cadence of outputs changes no result.
double Simulation::next_time_step() const {
  const double wanted = experiment_.solver.time_step.value_or(estimate_);
  const double left = experiment_.solver.end_time - time_;
  // A remainder of rounding is taken into the last step instead of making a tiny one.
  return left <= wanted * (1 + 1e-9) ? left : wanted;
}

void Simulation::estimate_time_step() {
  const TimeStepLimit limit = backend_->time_step_limit();
  if (!(limit.speed > 0) || !std::isfinite(limit.speed))
    throw RunFailure("not a number: its wave or particle speed gives no time step", limit.body, limit.particle);
  estimated_speed_ = limit.speed;
  estimate_ = experiment_.solver.courant * experiment_.grid.cell_size / limit.speed;
  // FMPM(k) is stable to 1 / sqrt(k) of the unfiltered step (Nairn 2026, arXiv 2604.07307); XPIC, before the forces, is
  // not the worse for its order.
  if (plan_.filter && !(experiment_.filter->plugin->filter().traits & MPM_FILTERS_BEFORE_FORCES))
    estimate_ /=
        std::sqrt(1.0 + experiment_.filter->plugin->filter().iterations(experiment_.filter->parameters.data()));
}

/// Whether the filter acts in the step that begins now.
bool Simulation::filter_due() {
  if (!plan_.filter) return false;
  const FilterSchedule& schedule = experiment_.filter_schedule;
  if (schedule.every_time == 0 && schedule.every_courant == 0) return (steps_ + 1) % schedule.every_steps == 0;
  const bool by_time = schedule.every_time > 0;
  const double interval = by_time ? schedule.every_time : schedule.every_courant;
  filter_clock_ += by_time ? dt_ : dt_ * estimated_speed_ / experiment_.grid.cell_size;
  if (filter_clock_ < interval * (1 - 1e-9)) return false;
  filter_clock_ -= interval * std::floor(filter_clock_ / interval * (1 + 1e-9));
  return true;
}

/// The next step's scatter needs its dt: not before an estimate, and not when there is no next step.
bool Simulation::may_fuse() const {
  if (finished() || steps_ + 1 >= experiment_.solver.max_steps) return false;
  return std::none_of(plan_.passes.begin(), plan_.passes.end(), [&](const Pass& pass) {
    return pass.kind == PassKind::estimate_time_step && (steps_ + 1) % pass.every_steps == 0;
  });
}

void Simulation::execute(const std::vector<Pass>& passes, StepInfo& step) {
  for (const Pass& pass : passes)
    if (steps_ % pass.every_steps == 0) execute(pass, step);
}

void Simulation::execute(const Pass& pass, StepInfo& step) {
  if (!chosen_ && pass.kind != PassKind::estimate_time_step) {
    dt_ = step.dt = next_time_step();
    step.filtered = filter_due();
    chosen_ = true;
  }
  if (pass.kind == PassKind::group) {
    const bool wanted = pass.condition == PassCondition::always ||
                        (pass.condition == PassCondition::unless_scattered && !scattered_) ||
                        (pass.condition == PassCondition::when_filtered && step.filtered);
    if (wanted) execute(pass.children, step);
    return;
  }
  if (pass.kind == PassKind::repeat) {
    for (int i = 0; i < pass.times; ++i) {
      execute(pass.children, step);
      const FilterRecord& record = backend_->filter_record();
      if (record.last_norm <= experiment_.filter_schedule.tolerance * record.first_norm) break;
    }
    return;
  }
  const auto start = std::chrono::steady_clock::now();
  backend_->execute(pass, step);
  seconds_[pass.name()] += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (pass.kind == PassKind::estimate_time_step) estimate_time_step();
  if (pass.kind == PassKind::project) ++filter_passes_;
}

void Simulation::step() {
  StepInfo info{0, time_, steps_};
  chosen_ = false;
  const double begin = time_;
  // A fixed step multiplies instead of summing, so that rounding does not grow with the number of steps.
  const auto end_time = [&] {
    const bool fixed = experiment_.solver.time_step && dt_ == *experiment_.solver.time_step;
    return fixed ? static_cast<double>(steps_ + 1) * dt_ : begin + dt_;
  };
  for (const Pass& pass : plan_.passes) {
    if (pass.kind != PassKind::gather_scatter) {
      if (steps_ % pass.every_steps == 0) execute(pass, info);
      continue;
    }
    // What the following step will take for its dt is known now.
    time_ = end_time();
    info.next_dt = next_time_step();
    const bool fuse = may_fuse();
    observed_ = info.observed = !fuse || !wanted_ || wanted_(time_, steps_ + 1);
    time_ = begin;
    if (fuse) {
      execute(pass, info);
    } else {
      Pass gather = pass;
      gather.kind = PassKind::gather;
      execute(gather, info);
    }
    scattered_ = fuse && backend_->scattered();
  }
  time_ = end_time();
  if (++steps_ == 1) first_entries_ = backend_->ledger();
  smallest_ = steps_ == 1 ? dt_ : std::min(smallest_, dt_);
  largest_ = std::max(largest_, dt_);
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
  if (particles != particles_) throw ArchiveError("it holds another number of particles");
  archive.get("first_entries", first_entries_);
  backend_->restore(archive);
  scattered_ = false;
  observed_ = true;
}

std::string Simulation::limiting_particle() const {
  if (experiment_.solver.time_step) return "";
  const TimeStepLimit limit = backend_->time_step_limit();
  std::ostringstream out;
  out << "particle " << limit.particle << " of " << experiment_.bodies[limit.body].name << " (wave " << limit.wave_speed
      << " m/s + speed " << limit.speed - limit.wave_speed << " m/s)";
  return out.str();
}

}  // namespace mpm
