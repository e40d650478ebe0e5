#include "run/start_checks.hpp"

#include <algorithm>
#include <cmath>

#include "run/overlaps.hpp"
#include "simulation/seeding.hpp"

namespace mpm::app {
namespace {

/// Where a particle is before the initial displacement, m, which a run may not keep.
Vector3 undeformed_place(const Experiment& experiment, int body, std::size_t particle) {
  const std::size_t D = static_cast<std::size_t>(experiment.dimension);
  Vector3 X{};
  seed_body(experiment, body).for_each_batch([&](const SeedBatch& batch) {
    if (particle >= batch.first && particle < batch.first + batch.count)
      std::copy_n(batch.undeformed() + (particle - batch.first) * D, D, X.begin());
  });
  return X;
}

/// A particle for messages: "particle 0, (0.4, 0.3) m".
std::string particle_text(const Experiment& experiment, std::size_t particle, const Vector3& x) {
  return "particle " + std::to_string(particle) + ", " + point_text(experiment, x);
}

Vector3 place_of(const BodyState& state, std::size_t particle, int dimension) {
  Vector3 x{};
  std::copy_n(&state.position[particle * static_cast<std::size_t>(dimension)], dimension, x.begin());
  return x;
}

void refuse_impossible_temperatures(const Simulation& simulation) {
  const Experiment& experiment = simulation.experiment();
  if (!experiment.has_temperature()) return;
  std::vector<Problem> problems;
  for (int body = 0; body < static_cast<int>(experiment.bodies.size()); ++body) {
    const BodyState state = simulation.backend().body_state(body);
    const std::vector<double>& temperature = state.host_state.at("temperature");
    const auto wrong =
        std::find_if_not(temperature.begin(), temperature.end(), [](double T) { return std::isfinite(T) && T >= 0; });
    if (wrong == temperature.end()) continue;
    const std::size_t particle = static_cast<std::size_t>(wrong - temperature.begin());
    const Vector3 x = place_of(state, particle, experiment.dimension);
    const std::string at = particle_text(experiment, particle, x);
    const auto found =
        experiment.bodies[body].temperature->not_finite(x, undeformed_place(experiment, body, particle), 0);
    problems.push_back(problem_at(experiment, experiment.bodies[body].pointer + "/temperature",
                                  std::isfinite(*wrong) ? "is " + number_text(*wrong) + " K, below 0 K, at " + at
                                                        : not_finite_text(at, found ? found->why : "")));
  }
  if (!problems.empty()) throw InputError(std::move(problems));
}

/// Warns of bodies that begin in one place, or in a rigid body. Throws InputError where two are the same.
std::vector<std::string> look_for_overlaps(const Experiment& experiment) {
  std::vector<std::string> warnings;
  std::vector<Problem> problems;
  for (const Overlap& overlap : overlaps_of(experiment)) {
    const std::string text = overlap.text(experiment);
    if (overlap.identical)
      problems.push_back(problem_at(experiment, experiment.bodies[overlap.second].pointer, text));
    else
      warnings.push_back(text);
  }
  if (!problems.empty()) throw InputError(std::move(problems));
  for (const RigidOverlap& overlap : rigid_overlaps_of(experiment)) warnings.push_back(overlap.text(experiment));
  return warnings;
}

/// Warns of grips that leave a component free on bodies that meet others: contact laws see such a body as if none held it,
/// so that its partner sinks in under a steady load (docs/method.md#grips).
void look_for_loose_grips(const Experiment& experiment, std::vector<std::string>& warnings) {
  if (!experiment.contact) return;
  for (const Grip& grip : experiment.grips)
    if (!std::all_of(grip.held.begin(), grip.held.begin() + experiment.dimension, [](bool held) { return held; }))
      warnings.push_back(grip.pointer + " leaves a component of \"" + experiment.bodies[grip.body].name +
                         "\" free, and contact takes the body for one that gives way: what presses on its gripped part "
                         "sinks in; hold all components there (docs/method.md#grips)");
}

/// Refuses what formulas impose in the first step and nothing can have.
void refuse_impossible_values(const Experiment& experiment) {
  if (const auto imposed = impossible_value(experiment, {}, false))
    throw InputError({problem_of(experiment, *imposed)});
}

void refuse_velocities_that_are_no_numbers(const Simulation& simulation) {
  const Experiment& experiment = simulation.experiment();
  const std::size_t D = static_cast<std::size_t>(experiment.dimension);
  std::vector<Problem> problems;
  for (int body = 0; body < static_cast<int>(experiment.bodies.size()); ++body) {
    const BodyState state = simulation.backend().body_state(body);
    const auto wrong = std::find_if_not(state.velocity.begin(), state.velocity.end(),
                                        [](double component) { return std::isfinite(component); });
    if (wrong == state.velocity.end()) continue;
    const std::size_t particle = static_cast<std::size_t>(wrong - state.velocity.begin()) / D;
    const Vector3 x = place_of(state, particle, experiment.dimension);
    const auto found = experiment.bodies[body].velocity.not_finite(x, undeformed_place(experiment, body, particle), 0);
    const int component = static_cast<int>(static_cast<std::size_t>(wrong - state.velocity.begin()) % D);
    problems.push_back(problem_at(experiment,
                                  pointer_of(experiment.bodies[body].pointer + "/velocity", true, component),
                                  not_finite_text(particle_text(experiment, particle, x), found ? found->why : "")));
  }
  if (!problems.empty()) throw InputError(std::move(problems));
}

}  // namespace

std::vector<std::string> check_start(const Simulation& simulation) {
  const Experiment& experiment = simulation.experiment();
  std::vector<std::string> warnings = look_for_overlaps(experiment);
  look_for_loose_grips(experiment, warnings);
  refuse_velocities_that_are_no_numbers(simulation);
  refuse_impossible_temperatures(simulation);
  refuse_impossible_values(experiment);
  if (!experiment.damping.pointer.empty() && !experiment.damping.acts())
    warnings.push_back(experiment.damping.pointer +
                       " damps nothing, as \"viscous\" and \"local\" are 0: give one of them, or remove it "
                       "(docs/experiment_file.md#damping)");
  return warnings;
}

std::string failure_text(const Failure& failure, const Simulation& simulation) {
  const Experiment& experiment = simulation.experiment();
  return place_text(failure, simulation.place_of(failure), experiment) + " " + cause_text(failure, experiment);
}

std::string failure_text(const ImposedValue& imposed, const Simulation& simulation) {
  return "step " + std::to_string(simulation.steps() + 1) + ": " + problem_of(simulation.experiment(), imposed).text();
}

}  // namespace mpm::app
