#include "run/start_checks.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "simulation/seeding.hpp"

namespace mpm::app {
namespace {

/// What is wrong with a particle's initial temperature; an empty string where nothing is.
std::string trouble_of_temperature(double temperature) {
  if (!std::isfinite(temperature)) return "is not a finite number";
  return temperature < 0 ? "is " + number_text(temperature) + " K, below 0 K," : "";
}

void refuse_impossible_temperatures(const Simulation& simulation) {
  const Experiment& experiment = simulation.experiment();
  if (!experiment.has_temperature()) return;
  const std::size_t D = static_cast<std::size_t>(experiment.dimension);
  std::vector<Problem> problems;
  for (int body = 0; body < static_cast<int>(experiment.bodies.size()); ++body) {
    const BodyState state = simulation.backend().body_state(body);
    const std::vector<double>& temperature = state.host_state.at("temperature");
    const auto wrong = std::find_if_not(temperature.begin(), temperature.end(),
                                        [](double T) { return trouble_of_temperature(T).empty(); });
    if (wrong == temperature.end()) continue;
    const std::size_t particle = static_cast<std::size_t>(wrong - temperature.begin());
    problems.push_back(problem_at(experiment, experiment.bodies[body].pointer + "/temperature",
                                  trouble_of_temperature(*wrong) + " at particle " + std::to_string(particle) + ", " +
                                      point_text(std::span(state.position).subspan(particle * D, D))));
  }
  if (!problems.empty()) throw InputError(std::move(problems));
}

/// Refuses what formulas impose in the first step and nothing can have.
void refuse_impossible_values(const Experiment& experiment) {
  if (const auto imposed = impossible_value(experiment, {}, false))
    throw InputError({problem_at(experiment, imposed->pointer, text_of(*imposed))});
}

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
    Vector3 x{};
    std::copy_n(&state.position[particle * D], D, x.begin());
    const Vector3 X = undeformed_place(experiment, body, particle);
    const std::optional<NotFinite> found = experiment.bodies[body].velocity.not_finite(x, X, 0);
    const std::string why = found ? ": " + found->why : "";
    problems.push_back(problem_at(experiment, experiment.bodies[body].pointer + "/velocity",
                                  "is not a finite number at particle " + std::to_string(particle) + ", " +
                                      point_text(std::span(state.position).subspan(particle * D, D)) + why));
  }
  if (!problems.empty()) throw InputError(std::move(problems));
}

}  // namespace

Problem problem_at(const Experiment& experiment, const std::string& pointer, const std::string& message) {
  for (const auto& [known, place] : experiment.positions)
    if (known == pointer && place.first > 0)
      return {experiment.file.string(), place.first, place.second, pointer, message};
  return {experiment.where(pointer), 0, 0, pointer, message};
}

void refuse_impossible_starts(const Simulation& simulation) {
  refuse_velocities_that_are_no_numbers(simulation);
  refuse_impossible_temperatures(simulation);
  refuse_impossible_values(simulation.experiment());
}

std::string failure_text(const Failure& failure, const Simulation& simulation) {
  const Experiment& experiment = simulation.experiment();
  return place_text(failure, simulation.place_of(failure), experiment) + " " + cause_text(failure, experiment);
}

std::string failure_text(const ImposedValue& imposed, const Simulation& simulation) {
  return "step " + std::to_string(simulation.steps() + 1) + ": " + imposed.pointer + ": " + text_of(imposed);
}

}  // namespace mpm::app
