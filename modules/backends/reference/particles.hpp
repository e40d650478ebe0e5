#pragma once
// The particles of one body in the reference backend, and their calls over the plugin boundary.

#include <deque>
#include <string_view>
#include <vector>

#include "backends/reference/stencil.hpp"

namespace mpm::reference {

/// The sums over nodes that a transfer reads: sum w v, sum w (v - v-), C = sum v (x) w D^-1 d, L = sum v (x) grad w.
struct Moments {
  Array &velocity, &increment, &affine, &gradient;
};

class Particles {
 public:
  Particles(const Experiment& experiment, const Plan& plan, int body, const SeededBody& seeded);
  Particles(const Particles&) = delete;  // others refer to its arrays

  std::size_t count() const { return count_; }
  int number() const { return body_; }
  int field() const { return field_; }
  double mass(std::size_t p) const { return mass_ * size(p); }
  double volume(std::size_t p) const { return volume_ * size(p); }
  /// The volume of a particle as it was seeded, or in axisymmetric scenes the area of its section.
  double volume_of_section(std::size_t p) const { return axisymmetric() ? volume_ : volume(p); }
  bool axisymmetric() const { return experiment_.axisymmetric(); }
  bool frozen() const { return frozen_; }
  std::uint64_t bytes() const;

  /// The plan's field of these particles with this id. It throws std::logic_error where there is none.
  Array& values(std::string_view id, Origin origin = Origin::host);
  const Array& values(std::string_view id, Origin origin = Origin::host) const;
  Vector column(const Array& array, std::size_t p) const;
  Matrix matrix(const Array& array, std::size_t p) const;
  /// The symmetric tensor of a particle, stored without its zz in 2-D.
  Matrix symmetric(const Array& array, std::size_t p) const;
  /// The force on a particle's nodes of the stress around the axis, to be shared by weight: -V tau_zz / r along x, N.
  Vector hoop_force(std::size_t p) const;
  void set(Array& array, std::size_t p, const Vector& v);
  void set(Array& array, std::size_t p, const Matrix& m);
  /// Copies the last particle into the padding.
  void pad(Array& array) const;

  /// Finds stencils and second moments at the current positions and domains; they hold until the next call. Throws
  /// RunFailure.
  void find_stencils(const Grid& grid);
  /// Finds second moments and polynomials alone, whether or not the grid holds the stencils.
  void find_second_moments();
  const Stencil& stencil(std::size_t p) const { return stencils_[p]; }
  /// The polynomials beyond affine at the same nodes, which exist when Plan::basis_functions is not 0.
  const HigherBasis& higher_basis(std::size_t p) const { return higher_bases_[p]; }

  // ---- temperature.cpp
  /// The heat capacity of particle p in its phase, J/K.
  double heat_capacity(std::size_t p) const { return mass(p) * thermal(p).heat_capacity; }
  double Ledger::*dissipation() const { return dissipation_; }  ///< the row of what the material dissipates
  double share_of_heat() const { return thermal_ ? thermal_->dissipation_to_heat : 0; }  ///< share of dissipation
  double conductivity(std::size_t p) const { return thermal(p).conductivity; }
  double heat() const;  ///< sum of heat capacity times temperature, J
  /// Computes b and A of all particles by the scene's transfer, for mass times specific heat and the velocity (T, 0,
  /// 0): row 0 is the heat that a particle gives.
  void heat_coefficients();
  /// Updates temperature and its transfer state from moments whose row 0 is that of the temperature.
  void gather_heat(double dt, const Moments& moments);
  /// Melts by the heat beyond the melting temperature and freezes by the heat that lacks. Returns the stored energy
  /// that goes with stiffer parameters, J, where `accounted`; else 0.
  double change_phase(bool accounted);

  // ---- dilation.cpp
  /// The relative change of particle p's volume by dt with `velocity_gradient`, over dt, 1/s.
  double dilation(std::size_t p, double dt) const;
  /// The mean of the normal Kirchhoff stresses in the directions that a dilation strains, Pa.
  double mean_stress(std::size_t p) const;
  /// Replaces that mean of the evaluated stress by that of a Cauchy stress, Pa.
  void take_mean_stress(const Array& cauchy);
  /// Finds the rate of strain around the axis from the gathered velocity.
  void find_hoop_rate();

  /// Computes the momentum coefficients b and A of all particles.
  void scatter_coefficients();
  /// Computes those of the velocity that the transfer makes of the gathered moments alone, as if particles had been at
  /// rest: S+ S of a filter. Changes no particle.
  void project_coefficients(double dt);
  /// Evaluates Kirchhoff stress, less J q of artificial viscosity, and volume ratio at the current state. Throws RunFailure
  /// when a particle is inverted.
  void evaluate_stress();
  /// Advances material and domain by dt with `velocity_gradient`, and warms the particle by its share of what that
  /// dissipates. What the ledger's book of the materials asks is found where `booked`. Throws RunFailure.
  StrainEnergies strain(double dt, bool booked);
  /// Updates velocity and transfer state from the gathered moments.
  void gather(double dt);
  /// Replaces the particles' velocity by the gathered one, as the step was filtered, and moves them by it, or by the
  /// mean of it and of `before`, the velocity that they had before the gather.
  void take_gathered_velocity(const Array& before, bool moves_by_mean);
  /// Finds the largest wave speed + particle speed.
  TimeStepLimit time_step_limit();

  /// The kinetic energy, J, with the affine part m/2 tr(C D C^T), D as the stencils were found.
  double kinetic_energy() const;

  BodyState state() const;
  void save(ArchiveWriter& archive) const;
  void restore(ArchiveReader& archive);

 private:
  struct Stored {
    const Field* declared;
    Array values;  ///< [component]
  };
  Array make(int components) const;
  Array& work(int components) { return work_.emplace_back(make(components)); }
  std::deque<Stored> start_fields() const;
  void seed(const SeedBatch& batch);
  std::vector<double> particle_major(const Array& array) const;
  double half_size() const;  ///< half a side of the undeformed particle's box, cells
  /// The state of the transfer or the material, in declared order.
  std::vector<void*> state_of(Origin plugin);
  ShapeArguments shape_arguments() const;
  /// D as the transfer reads it, cells^2; empty where the transfer does not or where D is a multiple of the identity.
  Array moments_for_transfer() const;
  /// Updates with the parameters of each particle's phase. Returns the first particle that failed, or -1.
  std::int32_t update_material(const mpm_material_batch& outputs);
  std::int32_t update_material(const mpm_material_batch& outputs, const std::vector<double>& parameters,
                               const std::vector<Eigen::Index>& particles);
  void scatter_by_transfer(const Array& mass, const Array& of_velocity, const std::vector<void*>& state);
  void gather_by_transfer(double dt, const Moments& moments, Array& of_velocity, const std::vector<void*>& state,
                          Array& advected);
  bool melted(std::size_t p) const;
  const ThermalProperties& thermal(std::size_t p) const;
  /// The transfer's state for the velocity (T, 0, 0), in declared order.
  std::vector<Array> state_of_temperature() const;
  /// The velocity gradient in all three directions.
  Matrix whole_gradient(std::size_t p) const;
  /// In how many directions a dilation strains: z stays as it is in plane strain.
  int dilated_directions() const { return dimension_ == 2 && !axisymmetric() ? 2 : 3; }
  /// Replaces the dilation of the velocity gradient by the mean one.
  void take_mean_dilation(double dt);
  double stored_energy();  ///< sum over all particles, J
  /// Finds J q of a strain that has just been made, from the speeds of the fastest wave; returns the work of q on it,
  /// J/m^3.
  Array strain_artificially(double dt, const Array& wave);
  double size(std::size_t p) const { return size_ ? (*size_)(0, p) : 1.0; }
  void refuse_inverted(std::int32_t particle);
  /// The work of the current stress on dt L, or where `after` on what that is of the strained body, dt L (I + dt L)^-1
  /// to second order, J.
  double work_of_stress(double dt, bool after);

  const Experiment& experiment_;
  const Plan& plan_;
  const Component& transfer_;
  const Component& material_;
  const std::optional<Thermal>& thermal_;
  double Ledger::*dissipation_;
  const std::optional<ArtificialViscositySpecification>& viscosity_;
  int body_, field_, dimension_;
  std::size_t count_, padded_;
  double mass_, volume_;  ///< of a particle of size 1
  bool frozen_;
  Shape shape_;
  std::vector<Stencil> stencils_;
  std::vector<Matrix> second_moments_;  ///< m^2, found with the stencils
  std::vector<HigherBasis> higher_bases_;
  std::deque<Stored> fields_ = start_fields();  ///< in the order of the plan
  std::deque<Array> work_;                      ///< arrays that no later step reads
  const Array* const size_ = plan_.particle_field(body_, "size") ? &values("size") : nullptr;

 public:
  Array &position = values("position"), &velocity = values("velocity");
  /// A plan for a device, whose start this backend evaluates, may have no such field.
  Array& advection =
      plan_.particle_field(body_, "advection_velocity") ? values("advection_velocity") : work(dimension_);
  Array &b = work(dimension_), &A = work(dimension_ * dimension_);
  Array &stress = work(dimension_ == 2 ? 4 : 6), &volume_ratio = work(1);
  Array &gathered_velocity = work(dimension_), &gathered_increment = work(dimension_);
  Array &gathered_affine = work(dimension_ * dimension_), &gathered_gradient = work(dimension_ * dimension_);
  Array& gathered_higher = work(plan_.basis_functions * dimension_);  ///< [function][D], polynomials beyond affine, m/s
  Array& higher = work(plan_.basis_functions * dimension_);           ///< the same times the mass, like b and A
  Array& velocity_gradient = work(dimension_ * dimension_);           ///< velocity gradient that strains the particle
  Array& hoop_rate = work(axisymmetric() ? 1 : 0);                    ///< 1/s, v_r / r
  Array& mean_dilation = work(plan_.does(Act::average_dilation) ? 1 : 0);  ///< 1/s, gathered from the nodes
};

}  // namespace mpm::reference
