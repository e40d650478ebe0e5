#pragma once
// Bodies touch while a film of some thickness is still between their faces, as fibres or roughness keep faces apart.
// Where a face is follows from the mean position of the mass that a node sees, as in `approach_and_position`.

#include "kernel/functor.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct MyPlugin {
  struct Parameters {
    double film;  ///< cells
  };

  /// The gap between the bodies along their normal, in cells, which closes where the film is all that is left. A pair has
  /// mean_a and mean_b, edge_a and edge_b, surface_a and surface_b: those that the traits ask for, along the normal from a
  /// to b, in cells from the node.
  template <class S>
  MPM_HD static S gap(const Parameters& p, const DetectionPair<S>& pair) {
    return pair.edge_b - pair.edge_a - S(real<S>(p.film));
  }

#if MPM_HOST
  static constexpr unsigned traits = MPM_READS_EDGES;
  static constexpr mpm_parameter parameters[] = {
      MPM_NUMBER_PARAMETER(film, "", 0.1, 0.0, 1.0, 0, "thickness of the film, in cells"),
  };
#endif
};

}  // namespace mpm
