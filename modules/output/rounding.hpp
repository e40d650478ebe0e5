// Which figures of a run show nothing but rounding.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "output/report_parts.hpp"

namespace mpm::output::report {

/// A figure shows rounding where none of its numbers is above 1e-12 of a size that the run itself gives:
///   momentum            sum m |v|, the largest of the recorded rows
///   angular momentum    sum m |x| |v|, likewise
///   energy, its ledger and dissipation   the largest kinetic, strain or gravitational energy
///   contact force       the force that changes sum m |v| by itself within the simulated time
///   nodes in contact    one node
///   position error      sum m |x| |v| / sum m |v|, a mean distance from the origin
///   volume ratio        one, against which J - 1 is held
/// The limit is that of double precision, whose unit is 1.1e-16, after some thousand operations. In a float run rounding
/// is larger and its figures stay: what it costs is what such a run is looked at for.
class RoundingRule {
 public:
  /// Reads the sizes from summary.json and metrics.csv of the run; a size that is missing there judges no figure.
  explicit RoundingRule(const Run& run);

  /// What is said of the figure whose CSV twin is figures/STEM.csv, as HTML, where it shows nothing but rounding.
  /// Nothing for a figure that is none of the above, or whose twin or size is not known.
  std::optional<std::string> remark(const std::string& stem) const;

 private:
  struct Size {
    double value;      ///< value in the unit of the figure
    const char* name;  ///< name in HTML
  };
  std::filesystem::path figures_;
  std::map<std::string, Size> sizes_;  ///< sizes by the figure's stem
};

}  // namespace mpm::output::report
