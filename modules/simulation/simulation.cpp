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
  for (const SeededBody& body : bodies) particles_ += body.count();
  backend_ = make_backend(experiment_, plan_, std::move(bodies));
}

bool Simulation::finished() const {
  return time_ >= experiment_.solver.end_time * (1 - 1e-12) || steps_ >= experiment_.solver.max_steps;
}

/// The fixed step, or courant h / (wave speed + particle speed); shortened to end at end_time. Nothing else changes it,
/// so that the cadence of outputs changes no result.
double Simulation::next_time_step() {
  const double wanted = experiment_.solver.time_step.value_or(estimate_);
  const double left = experiment_.solver.end_time - time_;
  // A remainder of rounding is taken into the last step instead of making a tiny one.
  return left <= wanted * (1 + 1e-9) ? left : wanted;
}

void Simulation::step() {
  bool chosen = false;
  for (const Pass& pass : plan_.passes) {
    if (pass.every_steps > 1 && steps_ % pass.every_steps != 0) continue;
    if (!chosen && pass.kind != PassKind::estimate_time_step) {
      dt_ = next_time_step();
      chosen = true;
    }
    const auto start = std::chrono::steady_clock::now();
    backend_->execute(pass, {dt_, time_, steps_});
    seconds_[pass.name()] += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (pass.kind == PassKind::estimate_time_step) {
      const TimeStepLimit limit = backend_->time_step_limit();
      if (!(limit.speed > 0) || !std::isfinite(limit.speed))
        throw RunFailure("not a number: its wave or particle speed gives no time step", limit.body, limit.particle);
      estimate_ = experiment_.solver.courant * experiment_.grid.cell_size / limit.speed;
    }
  }
  ++steps_;
  // A fixed step multiplies instead of summing, so that rounding does not grow with the number of steps.
  const bool fixed = experiment_.solver.time_step && dt_ == *experiment_.solver.time_step;
  time_ = fixed ? static_cast<double>(steps_) * dt_ : time_ + dt_;
  smallest_ = steps_ == 1 ? dt_ : std::min(smallest_, dt_);
  largest_ = std::max(largest_, dt_);
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
