#pragma once
// What a run keeps of its rows in memory: the last one and extremes over all of them.

#include <limits>
#include <span>
#include <vector>

#include "metrics/metrics.hpp"
#include "run/body_clamps.hpp"
#include "run/gas_watch.hpp"
#include "run/watch.hpp"

namespace mpm::app {

class RunRecord {
 public:
  explicit RunRecord(const Simulation& simulation, const Metrics& metrics);

  /// Takes a row: its totals, its chosen numbers (Metrics::chosen).
  void take(const Totals& totals, std::span<const double> chosen);

  const Totals& latest() const { return latest_; }
  double largest_total_energy() const { return extremes_.energy; }
  double smallest_volume_ratio() const { return extremes_.smallest_J; }
  double largest_volume_ratio() const { return extremes_.largest_J; }
  double largest_contact_force() const { return extremes_.contact_force; }
  double largest_penetration() const { return extremes_.penetration; }
  double momentum_scale() const { return extremes_.momentum; }
  double angular_momentum_scale() const { return extremes_.angular_momentum; }
  long most_contact_nodes() const { return extremes_.contact_nodes; }
  /// The time of the first row with a contact force, s; not a number before.
  double first_contact_time() const { return extremes_.first_contact; }

  /// A chosen number: at the start, now, and its extremes over the rows, those left out where there was none.
  struct Range {
    double initial, latest, smallest, largest;
  };
  const std::vector<Range>& chosen() const { return chosen_; }
  const Seen& seen() const { return watch_.seen(); }
  const BodyClamps& clamps() const { return clamps_; }
  const GasWatch& gases() const { return gases_; }

  void save(ArchiveWriter& archive) const;
  void restore(ArchiveReader& archive);

  /// Says that the run's last step failed on its way: what is summed over the steps holds a part of it.
  void break_off() { broken_off_ = true; }
  bool broken_off() const { return broken_off_; }
  /// Says that the particles can no longer be read: their device has failed.
  void lose_state() { state_lost_ = true; }
  bool state_lost() const { return state_lost_; }

 private:
  struct Extremes {
    double energy = 0, smallest_J = 1, largest_J = 1, contact_force = 0, penetration = 0;
    double momentum = 0, angular_momentum = 0;
    double first_contact = std::numeric_limits<double>::quiet_NaN();
    long contact_nodes = 0;
  };
  const Simulation& simulation_;
  Totals latest_;
  Extremes extremes_;
  std::vector<Range> chosen_;
  Watch watch_;
  BodyClamps clamps_;
  GasWatch gases_;
  bool broken_off_ = false;
  bool state_lost_ = false;
};

}  // namespace mpm::app
