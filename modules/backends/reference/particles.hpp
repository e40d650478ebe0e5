#pragma once
// The particles of one body in the reference backend, and their calls over the plugin boundary.

#include <Eigen/Core>
#include <map>
#include <string>
#include <vector>

#include "backends/reference/grid.hpp"

namespace mpm::reference {

/// [component][particle], padded with copies of the last particle so that a plugin may compute whole lanes.
using Array = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// One node of a particle's stencil.
struct StencilNode {
  std::size_t index = 0;
  double weight = 0;
  Vector gradient;  ///< grad w, 1/m
  Vector distance;  ///< d = node - particle, m
  Vector affine;    ///< w D^-1 d, 1/m
};
using Stencil = std::vector<StencilNode>;

class Particles {
 public:
  Particles(const Experiment& experiment, const Plan& plan, int body, const SeededBody& seeded);

  std::size_t count() const { return count_; }
  int field() const { return field_; }
  double mass() const { return mass_; }
  double volume() const { return volume_; }
  std::uint64_t bytes() const;

  Vector column(const Array& array, std::size_t p) const;
  Matrix matrix(const Array& array, std::size_t p) const;
  /// Symmetric tensor without its zz in 2-D.
  Matrix symmetric(const Array& array, std::size_t p) const;
  void set(Array& array, std::size_t p, const Vector& v);
  void set(Array& array, std::size_t p, const Matrix& m);
  /// Copies the last particle into the padding.
  void pad(Array& array) const;

  /// Stencils at the current positions.
  void find_stencils(const Grid& grid);
  const Stencil& stencil(std::size_t p) const { return stencils_[p]; }

  /// Momentum coefficients b and A of all particles.
  void scatter_coefficients();
  /// Kirchhoff stress and volume ratio at the current state. Throws RunFailure when a particle is inverted.
  void evaluate_stress();
  /// Advances the material by dt with `velocity_gradient`; returns the energy dissipated, J. Throws RunFailure.
  double strain(double dt);
  /// Updates velocity and transfer state from the gathered moments.
  void gather(double dt);
  /// Largest wave speed + particle speed.
  TimeStepLimit time_step_limit();

  /// Kinetic energy with the affine part, J.
  double kinetic_energy() const;

  BodyState state() const;

  Array position, velocity, initial_position, advection;
  Array b, A, stress, volume_ratio;
  Array gathered_velocity, gathered_increment, gathered_affine, velocity_gradient;

 private:
  Array make(int components) const;
  std::vector<void*> pointers(std::map<std::string, Array>& fields, const Plugin& plugin);
  void initialise(std::map<std::string, Array>& fields, const Plugin& plugin);
  std::int32_t update_material(const mpm_material_batch& outputs);
  void refuse_inverted(std::int32_t particle) const;

  const Experiment& experiment_;
  const Component& transfer_;
  const Component& material_;
  int body_, field_, dimension_;
  std::size_t count_, padded_;
  double mass_, volume_;
  std::map<std::string, Array> transfer_state_, material_state_;
  std::vector<Stencil> stencils_;
};

}  // namespace mpm::reference
