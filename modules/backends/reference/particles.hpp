#pragma once
// The particles of one body in the reference backend, and their calls over the plugin boundary.

#include <map>
#include <string>
#include <vector>

#include "backends/reference/stencil.hpp"

namespace mpm::reference {

class Particles {
 public:
  Particles(const Experiment& experiment, const Plan& plan, int body, const SeededBody& seeded);

  std::size_t count() const { return count_; }
  int field() const { return field_; }
  double mass(std::size_t p) const { return mass_ * ring(p); }
  double volume(std::size_t p) const { return volume_ * ring(p); }
  bool axisymmetric() const { return circumference_.size() > 0; }
  bool frozen() const { return frozen_; }
  std::uint64_t bytes() const;

  Vector column(const Array& array, std::size_t p) const;
  Matrix matrix(const Array& array, std::size_t p) const;
  /// Symmetric tensor without its zz in 2-D.
  Matrix symmetric(const Array& array, std::size_t p) const;
  /// Force that stress around the axis makes on a particle's nodes, each its weight of it: -V tau_zz / r along x, N.
  Vector hoop_force(std::size_t p) const;
  void set(Array& array, std::size_t p, const Vector& v);
  void set(Array& array, std::size_t p, const Matrix& m);
  /// Copies the last particle into the padding.
  void pad(Array& array) const;

  /// Stencils and second moments at the current positions and domains; they hold until the next call. Throws
  /// RunFailure.
  void find_stencils(const Grid& grid);
  const Stencil& stencil(std::size_t p) const { return stencils_[p]; }
  /// Polynomials beyond affine at the same nodes; there when Plan::basis_functions is not 0.
  const HigherBasis& higher_basis(std::size_t p) const { return higher_bases_[p]; }

  /// Momentum coefficients b and A of all particles.
  void scatter_coefficients();
  /// The same of the velocity that the transfer makes of the gathered moments alone, particles at rest before: S+ S of
  /// a filter. Changes no particle.
  void project_coefficients(double dt);
  /// Kirchhoff stress and volume ratio at the current state. Throws RunFailure when a particle is inverted.
  void evaluate_stress();
  /// Advances material and domain by dt with `velocity_gradient`; returns the energy dissipated, J. Throws RunFailure.
  double strain(double dt);
  /// Updates velocity and transfer state from the gathered moments.
  void gather(double dt);
  /// The gathered velocity moves the particles and replaces theirs: the step was filtered.
  void take_gathered_velocity();
  /// Largest wave speed + particle speed.
  TimeStepLimit time_step_limit();

  /// Kinetic energy, J, with the affine part m/2 tr(C D C^T), D as the stencils were found.
  double kinetic_energy() const;

  BodyState state() const;
  void save(ArchiveWriter& archive) const;
  void restore(ArchiveReader& archive);

  Array position, velocity, initial_position, advection;
  Array b, A, stress, volume_ratio;
  Array gathered_velocity, gathered_increment, gathered_affine, gathered_gradient;
  Array velocity_gradient;  ///< what strains the particle
  Array corners;            ///< [points*D], cells from the particle; empty unless Plan::sample_points
  Array moved_corners;      ///< where the grid's velocity takes them in this step, from the particle as it is yet
  Array gathered_higher;    ///< [function][D], coefficients of the polynomials beyond affine, m/s
  Array higher;             ///< the same times the mass, to scatter with b and A

 private:
  using Fields = std::map<std::string, Array>;
  Array make(int components) const;
  ShapeArguments shape_arguments() const;
  void call_scatter(const Array& velocities, Fields& states);
  void call_gather(double dt, const Array& increments, Array& velocities, Fields& states, Array& advections);
  /// What saving writes and restoring reads, in order.
  template <class Self, class Visit>
  static void visit_saved(Self& self, Visit visit);
  /// D as the transfer reads it, cells^2; empty where it does not or where D is a multiple of the identity.
  Array moments_for_transfer() const;
  std::vector<void*> pointers(Fields& fields, const Plugin& plugin);
  void initialise(Fields& fields, const Plugin& plugin);
  std::int32_t update_material(const mpm_material_batch& outputs);
  double ring(std::size_t p) const { return axisymmetric() ? circumference_(0, p) : 1.0; }
  void refuse_inverted(std::int32_t particle) const;

  const Experiment& experiment_;
  const Plan& plan_;
  const Component& transfer_;
  const Component& material_;
  int body_, field_, dimension_;
  std::size_t count_, padded_;
  double mass_, volume_;  ///< in axisymmetric scenes per metre of circumference
  bool frozen_;
  Shape shape_;
  Array circumference_;  ///< m, 2 pi r as seeded; empty unless axisymmetric
  Array hoop_rate_;      ///< 1/s, v_r / r; empty unless axisymmetric
  Array domain_;         ///< [D*D], cells, column k the k-th semi-side; empty unless Plan::particle_domain
  Fields transfer_state_, material_state_;
  std::vector<Stencil> stencils_;
  std::vector<Matrix> second_moments_;  ///< m^2, with the stencils
  std::vector<HigherBasis> higher_bases_;
};

}  // namespace mpm::reference
