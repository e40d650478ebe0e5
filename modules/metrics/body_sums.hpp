#pragma once
// Sums over particles: those of the whole scene, and of parts of it (a body, a group).

#include <array>
#include <string>
#include <vector>

#include "metrics/particle_quantities.hpp"
#include "metrics/totals.hpp"
#include "simulation/simulation.hpp"

namespace mpm {

/// The first axis of momenta, centre of mass and contact force that mean something, and that of angular momenta: over
/// whole rings radial sums and spin are zero by symmetry, whatever the half-plane's particles add up to.
struct RecordedAxes {
  int linear, angular;
};
RecordedAxes recorded_axes(const Experiment& experiment);

/// The units of sums, which in plane strain are per metre of depth.
struct RecordedUnits {
  bool flat;  ///< plane strain
  std::string mass, energy, momentum, spin, force, moment, area, inertia;
};
RecordedUnits units_of(const Experiment& experiment);

/// The smaller or larger of two numbers, or what is not a number where one is.
double smallest_of(double a, double b);
double largest_of(double a, double b);

/// A body's state at one time with what sums over its particles need.
struct BodyView {
  BodyView(const Experiment& experiment, const Plan& plan, int body, BodyState state);
  BodyView(const Simulation& simulation, int body)
      : BodyView(simulation.experiment(), simulation.plan(), body, simulation.backend().body_state(body)) {}
  BodyView(const BodyView&) = delete;  // it points into itself

  const Experiment& experiment;
  int body;
  BodyState state;
  MaterialQuantities material;
  std::vector<double> polynomials;          ///< J/kg, see polynomial_energy
  const double* affine_velocity = nullptr;  ///< n*D*D, 1/s; null where it carries no energy
  std::size_t count;

  /// The mass of a particle in kg, and its volume as seeded; of whole rings in axisymmetric scenes.
  double mass(std::size_t p) const { return state.mass * state.size_of(p); }
  double initial_volume(std::size_t p) const { return state.volume * state.size_of(p); }
};

/// Entry (a, b) of the shape's second moment at particle p, m^2: the particle's own, or on the diagonal the constant,
/// or f(1 - f) h^2 for the linear shape.
double second_moment(const Experiment& experiment, const BodyState& state, std::size_t p, int a, int b);

/// Totals of no particle, with extremes that any particle replaces.
Totals no_totals(const Experiment& experiment);
void add_particle(const BodyView& view, std::size_t p, Totals& totals);
void add_heat(const BodyView& view, std::size_t p, Totals& totals);
/// Adds the sums of some particles to those of others, before either is referred to the centre of mass.
void add_sums(const Totals& more, Totals& totals);
/// Turns sums into the centre of mass and the angular momentum about it.
void refer_to_centre_of_mass(Totals& totals);

/// The sums of a part of the scene.
struct PartSums {
  Totals totals;
  std::array<std::array<double, 3>, 3> mass_moment{};                 ///< kg m^2, sum of m x x^T, affine part included
  double smallest_pressure, largest_pressure, largest_von_mises = 0;  ///< Pa, of the Cauchy stress

  explicit PartSums(const Experiment& experiment);
  void add(const BodyView& view, std::size_t p);
  /// What is left to do when all particles are added.
  void finish();
  /// Replaces extremes over no particle by what is not a number.
  void forget_extremes();
  /// The angular velocity in 1/s that a rigid body of this mass and spin has; not a number where the body is a point or
  /// (in 3-D) a line. Its z alone in 2-D.
  std::array<double, 3> angular_velocity(int dimension) const;
  /// The tensor of inertia about the centre of mass, kg m^2; after finish().
  std::array<std::array<double, 3>, 3> inertia() const;
};

}  // namespace mpm
