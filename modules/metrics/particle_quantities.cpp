#include "metrics/particle_quantities.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "operators/heat.hpp"
#include "plugin/extension_of.hpp"

namespace mpm {
namespace {

const std::array<QuantityDescription, 9> common{{{"speed", "speed |v|", "m/s"},
                                                 {"pressure", "pressure p", "Pa"},
                                                 {"von_mises_stress", "von Mises stress", "Pa"},
                                                 {"volume_ratio", "volume ratio J", ""},
                                                 {"stored_energy", "stored energy density ψ", "J/m³"},
                                                 {"displacement", "displacement |u|", "m"},
                                                 {"temperature", "temperature T", "K"},
                                                 {"melted_fraction", "melted fraction φ", ""},
                                                 {"body", "body", ""}}};

/// Suffixes of the components of a field, in the order they are stored.
std::vector<std::string> component_names(std::uint32_t shape, int dimension) {
  const std::string axes = "xyz";
  std::vector<std::string> names;
  if (shape == MPM_STATE_VECTOR)
    for (int i = 0; i < dimension; ++i) names.emplace_back(1, axes[i]);
  if (shape == MPM_STATE_DEFORMATION && dimension == 2) names = {"xx", "xy", "yx", "yy", "zz"};
  if (shape == MPM_STATE_MATRIX || (shape == MPM_STATE_DEFORMATION && dimension == 3))
    for (int i = 0; i < dimension; ++i)
      for (int j = 0; j < dimension; ++j) names.push_back({axes[i], axes[j]});
  if (shape == MPM_STATE_SYMMETRIC)
    names = dimension == 2 ? std::vector<std::string>{"xx", "yy", "zz", "xy"}
                           : std::vector<std::string>{"xx", "yy", "zz", "yz", "xz", "xy"};
  return names;
}

/// A field of state and the component of it that a name such as "deformation_gradient_xy" means; -1: none.
int component_of(const std::string& name, const mpm_state& field, int dimension, bool axisymmetric = false) {
  if (field.shape == MPM_STATE_SCALAR) return name == field.name ? 0 : -1;
  const auto suffixes = component_names(kept_shape(field, axisymmetric), dimension);
  for (std::size_t k = 0; k < suffixes.size(); ++k)
    if (name == std::string(field.name) + "_" + suffixes[k]) return static_cast<int>(k);
  return -1;
}

constexpr mpm_state velocity_field{"velocity", "m/s", "velocity v", MPM_STATE_VECTOR, MPM_INITIAL_ZERO};
constexpr mpm_state position_field{"position", "m", "position x", MPM_STATE_VECTOR, MPM_INITIAL_ZERO};
constexpr mpm_state displacement_field{"displacement", "m", "displacement u", MPM_STATE_VECTOR, MPM_INITIAL_ZERO};
constexpr mpm_state stress_field{"stress", "Pa", "Cauchy stress σ", MPM_STATE_SYMMETRIC, MPM_INITIAL_ZERO};
constexpr const mpm_state* computed_fields[] = {&velocity_field, &position_field, &displacement_field, &stress_field};

void add_names(const mpm_state& field, std::vector<std::string>& names) {
  std::vector<std::string> added;
  if (field.shape == MPM_STATE_SCALAR) added.emplace_back(field.name);
  for (const std::string& suffix : component_names(kept_shape(field, false), 3))
    added.push_back(std::string(field.name) + "_" + suffix);
  for (const std::string& name : added)
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
}

std::size_t padded(std::size_t n) {
  return (n + MPM_LANES - 1) / MPM_LANES * MPM_LANES;
}

const Component& material_of(const Experiment& experiment, int body) {
  return experiment.materials[experiment.bodies[body].material].component;
}

}  // namespace

namespace {

/// The state of some of a body's particles as a batch of its material takes it, padded with the last of them.
struct StateBatch {
  std::uint32_t stride = 0;
  std::vector<std::vector<double>> fields;
  std::vector<void*> pointers;
  std::vector<double> temperature;  ///< empty where the material reads none

  StateBatch(const Experiment& experiment, const Plugin& material, const BodyState& state,
             const std::vector<std::size_t>& particles)
      : stride(static_cast<std::uint32_t>(padded(particles.size()))) {
    const std::size_t n = particles.size();
    for (const mpm_state& declared : material.state()) {
      const int components = state_components(kept_shape(declared, experiment.axisymmetric()), experiment.dimension);
      const std::vector<double>& values = state.material_state.at(declared.name);
      std::vector<double>& field = fields.emplace_back(static_cast<std::size_t>(components) * stride);
      for (std::size_t p = 0; p < stride; ++p)
        for (int c = 0; c < components; ++c)
          field[c * std::size_t{stride} + p] = values[particles[std::min(p, n - 1)] * components + c];
    }
    for (auto& field : fields) pointers.push_back(field.data());
    if (const auto kept = state.host_state.find("temperature");
        kept != state.host_state.end() && extension_of<mpm_material_temperature>(material)) {
      temperature.resize(stride);
      for (std::size_t p = 0; p < stride; ++p) temperature[p] = kept->second[particles[std::min(p, n - 1)]];
    }
  }
  const double* temperatures() const { return temperature.empty() ? nullptr : temperature.data(); }
};

/// Asks a material with these parameters for the quantities of some of a body's particles.
void evaluate(const Experiment& experiment, const Plugin& material, const std::vector<double>& parameters,
              const BodyState& state, const std::vector<std::size_t>& particles, MaterialQuantities& result) {
  if (particles.empty()) return;
  const int D = experiment.dimension, symmetric = D == 2 ? 4 : 6;
  const std::size_t n = particles.size();
  StateBatch kept(experiment, material, state, particles);
  const std::size_t stride = kept.stride;

  std::vector<double> stress(symmetric * stride), stored_energy(stride), wave_speed(stride), volume_ratio(stride);
  mpm_material_batch batch{};
  batch.count = batch.stride = static_cast<std::uint32_t>(stride);
  batch.dimension = static_cast<std::uint32_t>(D);
  batch.state = kept.pointers.data();
  batch.temperature = kept.temperatures();
  batch.kirchhoff_stress = stress.data();
  batch.stored_energy = stored_energy.data();
  batch.wave_speed = wave_speed.data();
  batch.volume_ratio = volume_ratio.data();
  if (experiment.axisymmetric()) batch.velocity_gradient_zz = stress.data();  // it must be given, but is not read
  material.material().update[MPM_SCALAR_DOUBLE][D - 2](parameters.data(), &batch);

  for (std::size_t p = 0; p < n; ++p) {
    for (int c = 0; c < symmetric; ++c) result.stress[particles[p] * symmetric + c] = stress[c * stride + p];
    result.stored_energy[particles[p]] = stored_energy[p];
    result.wave_speed[particles[p]] = wave_speed[p];
    result.volume_ratio[particles[p]] = volume_ratio[p];
  }
}

}  // namespace

double von_mises(const double* tau, int dimension) {
  const double p = (tau[0] + tau[1] + tau[2]) / 3;
  double norm = 0;
  for (int i = 0; i < 3; ++i) norm += (tau[i] - p) * (tau[i] - p);
  for (int i = 3; i < (dimension == 2 ? 4 : 6); ++i) norm += 2 * tau[i] * tau[i];
  return std::sqrt(1.5 * norm);
}

MaterialQuantities material_quantities(const Experiment& experiment, int body, const BodyState& state) {
  const MaterialSpecification& material = experiment.materials[experiment.bodies[body].material];
  const std::size_t n = state.position.size() / experiment.dimension;
  MaterialQuantities result;
  result.stress.resize(n * (experiment.dimension == 2 ? 4 : 6));
  for (auto* array : {&result.stored_energy, &result.wave_speed, &result.volume_ratio}) array->resize(n);
  std::vector<std::size_t> all(n), solid, melted;
  std::iota(all.begin(), all.end(), std::size_t{0});
  std::partition_copy(all.begin(), all.end(), std::back_inserter(melted), std::back_inserter(solid),
                      [&](std::size_t p) { return has_melted(experiment, body, state, p); });
  const Plugin& plugin = *material.component.plugin;
  evaluate(experiment, plugin, material.component.parameters, state, solid, result);
  if (!melted.empty())
    evaluate(experiment, plugin, material.thermal->phase_change->melted_parameters, state, melted, result);
  if (const auto kept = state.host_state.find("artificial_pressure"); kept != state.host_state.end())
    for (std::size_t p = 0; p < n; ++p)
      for (std::size_t k = 0; k < 3; ++k) result.stress[p * result.stress.size() / n + k] -= kept->second[p];
  return result;
}

void look_for_clamps(const Experiment& experiment, int body, const BodyState& state, bool melted, double time,
                     ClampWatch& watch) {
  std::vector<std::size_t> particles;
  for (std::size_t p = 0; p < state.position.size() / static_cast<std::size_t>(experiment.dimension); ++p)
    if (has_melted(experiment, body, state, p) == melted) particles.push_back(p);
  if (particles.empty()) return;
  const StateBatch kept(experiment, watch.material(), state, particles);
  mpm_clamp_batch batch{};
  batch.count = static_cast<std::uint32_t>(particles.size()), batch.stride = kept.stride;
  batch.dimension = static_cast<std::uint32_t>(experiment.dimension);
  batch.axisymmetric = experiment.axisymmetric();
  batch.temperature = kept.temperatures();
  batch.state = kept.pointers.data();
  watch.look(batch, time);
}

bool has_melted(const Experiment& experiment, int body, const BodyState& state, std::size_t p) {
  const auto& thermal = experiment.materials[experiment.bodies[body].material].thermal;
  return thermal && thermal->phase_change && is_melted(state.host_state.at("melted_fraction")[p]);
}

std::span<const QuantityDescription> common_quantities() {
  return common;
}

std::vector<std::string> quantity_names(const Registry& registry) {
  std::vector<std::string> names;
  for (const QuantityDescription& description : common) names.push_back(description.name);
  for (const mpm_state* field : computed_fields) add_names(*field, names);
  for (const mpm_kind kind : {MPM_MATERIAL, MPM_TRANSFER, MPM_CONTACT})
    for (const Plugin* plugin : registry.of_kind(kind))
      for (const mpm_state& field : plugin->state()) add_names(field, names);
  return names;
}

std::vector<std::string> quantity_names(const Experiment& experiment, int body) {
  std::vector<std::string> names;
  const auto& thermal = experiment.materials[experiment.bodies[body].material].thermal;
  for (const QuantityDescription& description : common)
    if ((description.name != "temperature" || thermal) &&
        (description.name != "melted_fraction" || (thermal && thermal->phase_change)))
      names.push_back(description.name);
  const auto add = [&](const mpm_state& field) {
    if (field.shape == MPM_STATE_SCALAR) names.emplace_back(field.name);
    for (const std::string& suffix :
         component_names(kept_shape(field, experiment.axisymmetric()), experiment.dimension))
      names.push_back(std::string(field.name) + "_" + suffix);
  };
  for (const mpm_state* field : computed_fields) add(*field);
  for (const mpm_state& field : material_of(experiment, body).plugin->state()) add(field);
  for (const mpm_state& field : experiment.transfer.plugin->state()) add(field);
  for (const mpm_state& field : experiment.contact_state()) add(field);
  return names;
}

QuantityDescription describe_quantity(const Experiment& experiment, const std::string& name) {
  for (const QuantityDescription& description : common)
    if (description.name == name) return description;
  const auto described = [&](const mpm_state& field) -> QuantityDescription {
    const std::string suffix = field.shape == MPM_STATE_SCALAR ? "" : name.substr(name.rfind('_'));
    return {name, field.doc + (suffix.empty() ? "" : ", component " + suffix.substr(1)), field.unit};
  };
  for (const mpm_state* field : computed_fields)
    if (component_of(name, *field, 3) >= 0) return described(*field);
  for (const MaterialSpecification& material : experiment.materials)
    for (const mpm_state& field : material.component.plugin->state())
      if (component_of(name, field, 3) >= 0) return described(field);
  for (const mpm_state& field : experiment.transfer.plugin->state())
    if (component_of(name, field, 3) >= 0) return described(field);
  for (const mpm_state& field : experiment.contact_state())
    if (component_of(name, field, 3) >= 0) return described(field);
  return {name, name, ""};
}

std::vector<double> quantity(const Experiment& experiment, int body, const BodyState& state, const std::string& name) {
  const int D = experiment.dimension, symmetric = D == 2 ? 4 : 6;
  const std::size_t n = state.position.size() / D;
  std::vector<double> values(n, 0.0);
  const auto length_of = [&](const std::vector<double>& vectors, std::size_t p) {
    double sum = 0;
    for (int c = 0; c < D; ++c) sum += vectors[p * D + c] * vectors[p * D + c];
    return std::sqrt(sum);
  };
  if (const auto kept = state.host_state.find(name); kept != state.host_state.end() && kept->second.size() == n) {
    values = kept->second;
  } else if (name == "body") {
    values.assign(n, body);
  } else if (name == "speed") {
    for (std::size_t p = 0; p < n; ++p) values[p] = length_of(state.velocity, p);
  } else if (name == "displacement") {
    std::vector<double> u(state.position);
    for (std::size_t k = 0; k < u.size() && k < state.initial_position.size(); ++k) u[k] -= state.initial_position[k];
    for (std::size_t p = 0; p < n && !state.initial_position.empty(); ++p) values[p] = length_of(u, p);
  } else if (const int axis = component_of(name, velocity_field, D); axis >= 0) {
    for (std::size_t p = 0; p < n; ++p) values[p] = state.velocity[p * D + axis];
  } else if (const int place = component_of(name, position_field, D); place >= 0) {
    for (std::size_t p = 0; p < n; ++p) values[p] = state.position[p * D + place];
  } else if (const int moved = component_of(name, displacement_field, D); moved >= 0) {
    for (std::size_t p = 0; p < n && !state.initial_position.empty(); ++p)
      values[p] = state.position[p * D + moved] - state.initial_position[p * D + moved];
  } else if (const int component = component_of(name, stress_field, D); component >= 0) {
    const MaterialQuantities material = material_quantities(experiment, body, state);
    for (std::size_t p = 0; p < n; ++p)
      values[p] = material.stress[p * symmetric + component] / material.volume_ratio[p];
  } else if (name == "pressure" || name == "von_mises_stress" || name == "volume_ratio" || name == "stored_energy") {
    MaterialQuantities material = material_quantities(experiment, body, state);
    if (name == "volume_ratio") return material.volume_ratio;
    if (name == "stored_energy") return material.stored_energy;
    for (std::size_t p = 0; p < n; ++p) {  // Cauchy stress is tau / J
      const double* tau = &material.stress[p * symmetric];
      values[p] = (name == "pressure" ? -(tau[0] + tau[1] + tau[2]) / 3 : von_mises(tau, D)) / material.volume_ratio[p];
    }
  } else {
    const auto take = [&](const Plugin& plugin, const std::map<std::string, std::vector<double>>& fields) {
      for (const mpm_state& field : plugin.state()) {
        const bool axisymmetric = experiment.axisymmetric();
        const int component = component_of(name, field, D, axisymmetric);
        const int components = state_components(kept_shape(field, axisymmetric), D);
        for (std::size_t p = 0; component >= 0 && p < n; ++p)
          values[p] = fields.at(field.name)[p * components + component];
      }
    };
    take(*material_of(experiment, body).plugin, state.material_state);
    take(*experiment.transfer.plugin, state.transfer_state);
    const std::span<const mpm_state> contact = experiment.contact_state();
    for (std::size_t k = 0; k < contact.size(); ++k)
      for (std::size_t p = 0; name == contact[k].name && p < n; ++p)
        values[p] = state.host_state.at("contact_state")[p * contact.size() + k];
  }
  return values;
}

}  // namespace mpm
