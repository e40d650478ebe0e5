#pragma once
// Particles of one material as the checks strain them: deformation is imposed as the host does it, by velocity
// gradients over a step, so that laws without F are checked too.

#include <array>

#include "conformance/support.hpp"

namespace mpm::conformance {

inline constexpr double step = 0x1p-6;  ///< s; a power of two, so that increments / step are exact

/// The increment of I + dt L of every lane.
using Increments = std::array<Matrix3, full>;

/// A batch of particles of one material, with all outputs; in axisymmetric scenes L has its zz.
struct MaterialBatch {
  const Plugin& plugin;
  const ParameterSample& parameters;
  Variant variant;
  int count;
  bool axisymmetric;
  Array gradient, hoop, stress, energy, dissipated, wave, ratio;
  Array temperature{};  ///< K; empty stands for the reference temperature
  std::vector<Array> state;

  MaterialBatch(const Plugin& p, const Variant& v, const ParameterSample& sample, int entries = full,
                bool around_axis = false)
      : plugin(p), parameters(sample), variant(v), count(entries), axisymmetric(around_axis) {
    const Element element = element_of(v);
    const std::uint32_t n = static_cast<std::uint32_t>(entries);
    gradient = Array(element, v.dimension * v.dimension, n);
    stress = Array(element, v.symmetric(), n);
    for (Array* scalar : {&hoop, &energy, &dissipated, &wave, &ratio}) *scalar = Array(element, 1, n);
    for (mpm_state field : p.state()) {
      const mpm_state_shape shape = kept_shape(field, axisymmetric);
      field.shape = shape;
      state.emplace_back(element, state_components(shape, v.dimension), n);
      initialise(state.back(), field);
    }
  }

  void initialise(Array& array, const mpm_state& field) const {
    for (int c = 0; c < array.components(); ++c)
      for (int lane = 0; lane < count; ++lane) array.set(c, lane, initial_value(field, c, variant.dimension));
  }

  /// Sets the velocity gradient that makes the increments over one step.
  void strain_by(const Increments& increments, double dt = step) {
    const int D = variant.dimension;
    for (int lane = 0; lane < count; ++lane)
      for (int i = 0; i < D; ++i)
        for (int j = 0; j < D; ++j) gradient.set(i * D + j, lane, increments[lane](i, j) / dt);
    for (int lane = 0; axisymmetric && lane < count; ++lane) hoop.set(0, lane, increments[lane](2, 2) / dt);
  }
  /// Advances by the increments over one step; returns what the plugin returns.
  std::int32_t advance(const Increments& increments, double dt = step) {
    strain_by(increments, dt);
    return update(gradient.data(), dt);
  }
  std::int32_t evaluate() { return update(nullptr, step); }

  std::int32_t update(const void* velocity_gradient, double dt) {
    std::vector<void*> fields;
    for (Array& field : state) fields.push_back(field.data());
    const mpm_material_batch batch{static_cast<std::uint32_t>(count),
                                   gradient.stride(),
                                   static_cast<std::uint32_t>(variant.dimension),
                                   0,
                                   dt,
                                   velocity_gradient,
                                   axisymmetric ? hoop.data() : nullptr,
                                   temperature.data(),
                                   fields.data(),
                                   stress.data(),
                                   energy.data(),
                                   dissipated.data(),
                                   wave.data(),
                                   ratio.data()};
    return plugin.material().update[variant.precision][variant.dimension - 2](parameters.data(), &batch);
  }

  Matrix3 tau(int lane) const { return symmetric(stress, lane); }
  /// A symmetric tensor of three-dimensional space.
  Matrix3 symmetric(const Array& array, int lane) const {
    Matrix3 t{};
    for (int i = 0; i < 3; ++i) t(i, i) = array(i, lane);
    for (int c = 3; c < variant.symmetric(); ++c) {
      const int i = variant.dimension == 2 || c == 5 ? 0 : c == 3 ? 1 : 0, j = variant.dimension == 2 || c == 5 ? 1 : 2;
      t(i, j) = t(j, i) = array(c, lane);
    }
    return t;
  }
};

/// The stiffness rho c^2 at rest: the size by which stress and energy errors are judged.
double stiffness(const Plugin& plugin, const Variant& v, const ParameterSample& parameters);

/// Makes `steps` increments that wander around one direction a lane and add up to `strain`; every fourth lane strains
/// little, so that packs hold particles that yield beside some that do not.
std::vector<Increments> random_path(Random& random, int dimension, int steps, double strain);

MaterialBatch after_path(const Plugin& plugin, const Variant& v, const ParameterSample& parameters,
                         const std::vector<Increments>& path);

inline unsigned traits_of(const Plugin& plugin) {
  return plugin.material().traits;
}

/// Whether a law has one of the traits of finite strain. With neither, its stress and energy agree to the order of the
/// strain only.
inline bool is_finite_strain(const Plugin& plugin) {
  return traits_of(plugin) & (MPM_OBJECTIVE | MPM_HYPERELASTIC);
}

/// What a check needs of the case it runs in.
struct Context {
  const Plugin& plugin;
  const Variant& variant;
  const ParameterSample& parameters;
  double modulus;  ///< rho c^2 at rest
  std::string where;
  Findings& findings;

  MaterialBatch batch() const { return {plugin, variant, parameters}; }
};

/// Checks that the balance closes to the order of the time step; that of a law of small strains closes to the order of
/// the strain only.
void check_energy_balance(const Context& c, Random& random);
/// Checks the same around closed paths, some of which enclose an area in the space of F: what the work of the stress leaves
/// unexplained after each quarter of a turn is no more than the step makes it, and a hyperelastic law that dissipates
/// nothing is back at its stress and energy.
void check_closed_paths(const Context& c);
/// Checks that stress is the derivative of the stored energy in strains in which nothing flows: from a state that has been
/// strained, unloaded a little and left at rest for ages, there and back by 3e-6 in six directions.
void check_elastic_strains(const Context& c, Random& random);
/// Runs the checks of what the material offers beyond its table, at the end of a path and where else they need.
void check_material_extensions(const Context& c, const std::vector<Increments>& path);

}  // namespace mpm::conformance
