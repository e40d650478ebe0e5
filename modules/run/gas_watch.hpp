#pragma once
// What gases did in the rows of a run that their law does not describe: expand through a free surface, touch another gas.

#include <optional>
#include <string>
#include <vector>

#include "simulation/simulation.hpp"

namespace mpm::app {

/// How much larger than at its start a particle's volume is where its gas counts as expanding.
inline constexpr double gas_expands = 1.25;

class GasWatch {
 public:
  explicit GasWatch(const Simulation& simulation);

  /// Looks at the gases of the scene for what was not seen before; at nothing where there is no gas.
  void look();
  std::vector<std::string> warnings() const;

  void save(ArchiveWriter& archive) const;
  void restore(ArchiveReader& archive);

 private:
  /// A body of gas.
  struct Gas {
    int body;
    std::optional<double> pressure;  ///< at rest, Pa; empty where the material does not say it
    double largest_ratio;            ///< of the volume at the start
    double expanded = 0;             ///< J of the particle at a free surface that expanded most in the first such row
  };
  struct Meeting {
    int first, second;  ///< of gases_
    bool met = false;
  };

  void look_for_expansion(Gas& gas);
  void look_for_meetings();

  const Simulation& simulation_;
  std::vector<Gas> gases_;
  std::vector<Meeting> meetings_;
};

}  // namespace mpm::app
