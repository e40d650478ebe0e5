#pragma once
// The numbers that an experiment asks for beside the totals: of bodies, groups of particles, probes and pairs in contact.

#include <string>
#include <vector>

#include "simulation/simulation.hpp"

namespace mpm {

class Views;

/// A column of metrics.csv, and its place in summary.json.
struct ChosenRow {
  std::vector<std::string> path;  ///< such as {"bodies", "disc", "mass"}
  ValueRow row;
};

/// A profile along a line at one time: a row a point.
struct Profile {
  std::vector<std::string> columns;
  std::vector<std::vector<double>> rows;
};

/// Knows which particles belong to what, from their places at the start.
class ChosenNumbers {
 public:
  explicit ChosenNumbers(const Simulation& simulation);

  /// The numbers as they are now. Which there are never changes.
  std::vector<ChosenRow> rows() const;
  std::size_t count() const { return paths_.size(); }
  /// Their places in summary.json, which are known whatever has become of the particles.
  const std::vector<std::vector<std::string>>& paths() const { return paths_; }
  Profile profile(const ProbeSpecification& line) const;

 private:
  /// Particles that are summed apart.
  struct Part {
    std::string prefix;
    std::vector<std::string> path;
    std::vector<std::vector<std::size_t>> particles;  ///< of each body
    int whole_body = -1;  ///< index of a body all of whose particles are summed, whichever there are
  };
  struct Followed {
    const ProbeSpecification* probe;
    int body = -1;
    std::size_t particle = 0;
  };
  void choose_parts();
  void follow();
  void add_part(const Part& part, Views& views, std::vector<ChosenRow>& rows) const;
  void add_probe(const ProbeSpecification& probe, Views& views, std::vector<ChosenRow>& rows) const;
  void add_section(const ProbeSpecification& probe, Views& views, std::vector<ChosenRow>& rows) const;
  void add_pairs(Views& views, std::vector<ChosenRow>& rows) const;
  void add_rigid_gaps(Views& views, std::vector<ChosenRow>& rows) const;

  const Simulation& simulation_;
  std::vector<Part> parts_;
  std::vector<Followed> followed_;
  std::vector<std::vector<std::string>> paths_;
};

}  // namespace mpm
