#pragma once
// Totals of a run at one time: energies, momenta, volume ratios, errors against the exact solution. Computed from the
// particles as doubles, the same for every backend, or taken from one that offers them (simulation/offers_totals.hpp).

#include <memory>
#include <string>
#include <vector>

#include "metrics/chosen_numbers.hpp"
#include "metrics/exact.hpp"
#include "metrics/totals.hpp"
#include "simulation/simulation.hpp"

namespace mpm {

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
  /// The numbers that the experiment asks for beside the totals; the last of `rows`.
  const ChosenNumbers& chosen() const { return chosen_; }

 private:
  void add_body(int body, Totals& totals) const;
  /// Adds the body's sums where the backend offers them and nothing else of its state is wanted.
  bool add_offered(int body, Totals& totals) const;
  void add_errors(int body, const BodyState& state, Totals& totals) const;

  const Simulation& simulation_;
  ChosenNumbers chosen_;
  std::vector<BodyState> start_;  ///< kept only when there is an exact solution
  Totals initial_;
};

}  // namespace mpm
