#pragma once
// Where the particles of a body are, and what each holds, for every way of seeding but the lattice of the cells.

#include <cstdint>
#include <vector>

#include "experiment/experiment.hpp"

namespace mpm {

struct Places {
  std::vector<Vector3> points;  ///< m
  /// What each particle holds of `volume`, and a whole one of its ring; empty where all hold it.
  std::vector<double> shares;
  double volume = 0;          ///< m^dimension, of a particle of share 1
  std::vector<double> boxes;  ///< m, dimension*dimension a particle, or once for all: columns are semi-sides
  Vector3 spacing{};          ///< m, of the rows along each axis
};

/// What placing reads of a scene.
struct PlacingScene {
  const GridSpecification& grid;
  int dimension = 2;
  std::uint64_t seed = 0;  ///< of this body
};

/// Places the particles of a body whose seeding is not SeedingKind::lattice. There may be none.
Places place_particles(const PlacingScene& scene, const BodySpecification& body);

/// The volume of a body's particles at the given number a cell, m^dimension.
double nominal_volume(const GridSpecification& grid, int dimension, const BodySpecification& body);

}  // namespace mpm
