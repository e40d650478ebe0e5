#include "simulation/material_changes.hpp"

#include <algorithm>
#include <cmath>

#include "experiment/diagnostics.hpp"
#include "plugin/extension_of.hpp"
#include "simulation/formula_problem.hpp"
#include "simulation/material_at_rest.hpp"

namespace mpm {
namespace {

std::vector<double> chosen(const std::vector<double>& values, std::size_t components,
                           const std::vector<Changed>& particles) {
  std::vector<double> some;
  for (const Changed& changed : particles) {
    const auto first = values.begin() + static_cast<std::ptrdiff_t>(changed.particle * components);
    some.insert(some.end(), first, first + static_cast<std::ptrdiff_t>(components));
  }
  return some;
}

}  // namespace

void refuse_unknown_quantities(const Experiment& experiment) {
  std::vector<Problem> problems;
  for (int body = 0; body < static_cast<int>(experiment.bodies.size()); ++body) {
    const auto& becomes = experiment.bodies[static_cast<std::size_t>(body)].becomes;
    if (!becomes) continue;
    const std::vector<std::string> names = quantity_names(experiment, body);
    if (std::find(names.begin(), names.end(), becomes->quantity) != names.end()) continue;
    problems.push_back(problem_at(
        experiment, becomes->pointer + "/when/quantity",
        "no particle of body " + in_quotes(experiment.bodies[static_cast<std::size_t>(body)].name) + " has " +
            in_quotes(becomes->quantity) + suggestion(becomes->quantity, names, "they have " + quoted_list(names))));
  }
  if (!problems.empty()) throw InputError(std::move(problems));
}

bool changes_of_material_are_due(const Experiment& experiment, long steps) {
  return std::any_of(experiment.bodies.begin(), experiment.bodies.end(), [&](const BodySpecification& body) {
    return body.becomes && steps % body.becomes->every_steps == 0;
  });
}

std::vector<Changed> changing_particles(const Experiment& experiment, const Backend& backend, long steps,
                                        const std::vector<std::vector<bool>>& gone) {
  std::vector<Changed> all;
  for (std::size_t body = 0; body < experiment.bodies.size(); ++body) {
    const auto& becomes = experiment.bodies[body].becomes;
    if (!becomes || steps % becomes->every_steps != 0) continue;
    const int number = static_cast<int>(body);
    const std::vector<double> values = quantity(experiment, number, backend.body_state(number), becomes->quantity);
    for (std::size_t p = 0; p < values.size(); ++p)
      if (becomes->meets(values[p]) && (gone[body].empty() || !gone[body][p]))
        all.push_back({number, becomes->body, p});
  }
  return all;
}

MaterialChange::MaterialChange(const Experiment& experiment, const BodyView& view, const ParticleState& state,
                               const std::vector<Changed>& particles, const SeededBody& of_start)
    : experiment_(experiment),
      particles_(particles),
      from_(static_cast<std::size_t>(particles.front().from)),
      to_(static_cast<std::size_t>(particles.front().to)),
      kept_(state.fields(to_).size()) {
  newcomers_.count = particles.size();
  std::vector<double>& size = newcomers_.others["size"];
  for (const Changed& changed : particles) {
    size.push_back(view.mass(changed.particle) / of_start.mass);
    volume_ratio_.push_back(view.material.volume_ratio[changed.particle]);
  }
  take_seeds(state);
  rest_at_volume();
}

/// Takes what both bodies keep of a particle, whatever it is made of.
void MaterialChange::take_seeds(const ParticleState& state) {
  const auto D = static_cast<std::size_t>(experiment_.dimension);
  const ParticleState::OfBody& source = state.bodies()[from_];
  newcomers_.position = chosen(source.position, D, particles_);
  if (!source.initial_position.empty()) newcomers_.initial_position = chosen(source.initial_position, D, particles_);
  for (std::size_t k = 0; k < kept_.size(); ++k) {
    const Field& field = *state.fields(to_)[k];
    // Its size follows from its mass, and its artificial viscosity from its next strain.
    const bool of_material = field.origin == Origin::material || field.id == "artificial_pressure";
    if (of_material || (field.origin == Origin::host && field.id == "size")) continue;
    const int other = state.number(from_, field.origin, field.id);
    if (other < 0) continue;
    kept_[k] =
        chosen(source.fields[static_cast<std::size_t>(other)], static_cast<std::size_t>(field.components), particles_);
    if (field.origin != Origin::host) continue;
    if (field.id == "velocity") newcomers_.velocity = kept_[k];
    if (field.id == "temperature") temperature_ = kept_[k];
    if (field.id == "melted_fraction") melted_ = kept_[k];
    if (field.first == First::seeded && field.id != "velocity") newcomers_.others[field.id] = kept_[k];
  }
  const auto& thermal = experiment_.materials[static_cast<std::size_t>(experiment_.bodies[to_].material)].thermal;
  if (!thermal || !thermal->phase_change || !melted_.empty()) return;
  for (const double T : temperature_) melted_.push_back(T > thermal->phase_change->temperature ? 1 : 0);
  newcomers_.others["melted_fraction"] = melted_;
}

/// Strains the new material from rest to the particle's volume ratio, alike in all directions in which it may.
void MaterialChange::rest_at_volume() {
  const MaterialSpecification& material =
      experiment_.materials[static_cast<std::size_t>(experiment_.bodies[to_].material)];
  const Plugin& plugin = *material.component.plugin;
  const bool plane = experiment_.dimension == 2 && !experiment_.axisymmetric();
  for (const bool liquid : {false, true}) {
    std::vector<std::size_t> of_phase;
    for (std::size_t k = 0; k < particles_.size(); ++k)
      if (liquid == (!melted_.empty() && melted_[k] > 0.5)) of_phase.push_back(k);
    if (of_phase.empty()) continue;
    std::vector<double> warm;
    if (!temperature_.empty() && extension_of<mpm_material_temperature>(plugin))
      for (const std::size_t k : of_phase) warm.push_back(temperature_[k]);
    MaterialAtRest rest(experiment_, plugin,
                        liquid ? material.thermal->phase_change->melted_parameters : material.component.parameters,
                        std::move(warm), of_phase.size());
    std::vector<std::array<double, 9>> F;
    for (const std::size_t k : of_phase) {
      const double stretch = plane ? std::sqrt(volume_ratio_[k]) : std::cbrt(volume_ratio_[k]);
      F.push_back({stretch, 0, 0, 0, stretch, 0, 0, 0, plane ? 1 : stretch});
    }
    if (!rest.strain(F)) {
      const std::size_t p = particles_[of_phase[rest.first_inverted()]].particle;
      throw RunFailure(
          {Cause::inverted, static_cast<int>(from_), p, -1, volume_ratio_[of_phase[rest.first_inverted()]]});
    }
    std::size_t number = 0;
    for (const mpm_state& declared : plugin.state()) {
      const std::size_t components = rest.components(number);
      std::vector<double>& values = newcomers_.others[std::string("material/") + declared.name];
      values.resize(particles_.size() * components);
      for (std::size_t k = 0; k < of_phase.size(); ++k)
        for (std::size_t c = 0; c < components; ++c) values[of_phase[k] * components + c] = rest.state(number, k, c);
      ++number;
    }
  }
}

void MaterialChange::put(ParticleState& state, std::size_t first) const {
  ParticleState::OfBody& body = state.bodies()[to_];
  for (std::size_t k = 0; k < kept_.size(); ++k) {
    const Field& field = *state.fields(to_)[k];
    const std::vector<double>* values = &kept_[k];
    if (field.origin == Origin::material) values = &newcomers_.others.at(seed_key(field));
    if (values->empty()) continue;
    std::copy(values->begin(), values->end(),
              body.fields[k].begin() + static_cast<std::ptrdiff_t>(first * static_cast<std::size_t>(field.components)));
  }
}

}  // namespace mpm
