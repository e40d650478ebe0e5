#pragma once
// The clamps of a scene's materials that acted in the rows of a run.

#include <string>
#include <vector>

#include "experiment/clamps.hpp"
#include "simulation/simulation.hpp"

namespace mpm::app {

class BodyClamps {
 public:
  explicit BodyClamps(const Simulation& simulation);

  /// Looks at the bodies whose material has a clamp that can still act for the first time; at no others.
  void look();
  /// A sentence for each clamp of each material that acted.
  std::vector<std::string> warnings() const;

  void save(ArchiveWriter& archive) const;
  void restore(ArchiveReader& archive);

 private:
  /// A material of the experiment, as it is or molten.
  struct Watched {
    int material;
    bool melted;
    ClampWatch watch;
  };

  const Simulation& simulation_;
  std::vector<Watched> watched_;
};

}  // namespace mpm::app
