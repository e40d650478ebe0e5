#pragma once
// Totals of a run at one time: energies, momenta, volume ratios, errors against the exact solution. Computed from the
// particles as doubles, the same for every backend.

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "metrics/exact.hpp"
#include "simulation/simulation.hpp"

namespace mpm {

/// In plane strain energies, momenta and forces are per metre of depth; in axisymmetric scenes they are of whole rings.
struct Totals {
  double time = 0, time_step = 0;
  long step = 0;
  double mass = 0;
  double kinetic = 0, strain = 0, gravitational = 0;  ///< J; the kinetic energy includes the affine part
  std::array<double, 3> momentum{};                   ///< kg m/s
  std::array<double, 3> angular_momentum{};           ///< kg m^2/s about the centre of mass, affine part included
  std::array<double, 3> centre_of_mass{};             ///< m
  /// The sums of m |v| and of m |x| |v|: sizes of the terms that the momenta are sums of, against which those may be
  /// rounding.
  double momentum_scale = 0, angular_momentum_scale = 0;
  double smallest_volume_ratio = 0, largest_volume_ratio = 0;
  double largest_speed = 0;                               ///< m/s
  double position_error_rms = 0, position_error_max = 0;  ///< m, against the exact solution
  double velocity_error_rms = 0, velocity_error_max = 0;  ///< m/s
  /// Heat in J, where particles have a temperature: `heat_content` is sum m c T, with T from the melting temperature
  /// where a material has one; `latent_heat` is sum m L phi.
  double heat_content = 0, latent_heat = 0;
  double lowest_temperature = 0, highest_temperature = 0;  ///< K

  double total_energy() const { return kinetic + strain + gravitational; }
};

/// The first axis of momenta, centre of mass and contact force that mean something, and that of angular momenta: over
/// whole rings radial sums and spin are zero by symmetry, whatever the half-plane's particles add up to.
struct RecordedAxes {
  int linear, angular;
};
RecordedAxes recorded_axes(const Experiment& experiment);

/// Keeps what measuring needs of the start: the exact solution and each particle's initial velocity.
class Metrics {
 public:
  explicit Metrics(const Simulation& simulation);

  Totals measure() const;

  /// Change of total energy since the start that no cause explains, J: what time integration makes. Zero without a
  /// ledger.
  double ledger_residual(const Totals& now) const;
  /// Heat gained since the start that no row of the heat ledger explains, J: what rounding makes. Zero without a
  /// ledger.
  double heat_residual(const Totals& now) const;

  /// The ledgers' entries and residuals that files have; empty without the ledger. J.
  std::vector<ValueRow> ledger_rows(const Totals& now) const;
  std::vector<ValueRow> heat_ledger_rows(const Totals& now) const;
  /// The books of the energy ledger, each what measured and recorded values differ by ("grid", "filter", "material", "mass",
  /// "momentum"); empty without the ledger. J, kg, kg m/s.
  std::vector<ValueRow> book_rows() const;

  /// All that metrics.csv has of one time, in order: which and with what units is decided here alone.
  std::vector<ValueRow> rows(const Totals& totals) const;
  /// Their headings, and their values.
  std::vector<std::string> columns() const;
  std::vector<double> row(const Totals& totals) const;

  const Totals& initial() const { return initial_; }

 private:
  void add_body(int body, Totals& totals) const;
  void add_heat(int body, const BodyState& state, Totals& totals) const;
  void add_errors(int body, const BodyState& state, Totals& totals) const;

  const Simulation& simulation_;
  std::vector<BodyState> start_;  ///< kept only when there is an exact solution
  Totals initial_;
};

}  // namespace mpm
