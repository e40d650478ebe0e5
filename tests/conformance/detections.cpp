// The gap of each contact detection, from places that are all unlike.

#include "detections/approach/approach.hpp"
#include "detections/approach_and_position/approach_and_position.hpp"
#include "detections/fixed_offset/fixed_offset.hpp"
#include "detections/particle_surfaces/particle_surfaces.hpp"
#include "support/catch.hpp"

using namespace mpm;

TEST_CASE("a detection's gap is the distance of the places that it reads, less its offset") {
  DetectionPair<double> pair{};
  pair.mean_a = -0.5, pair.mean_b = 0.75;
  pair.edge_a = 0.125, pair.edge_b = 0.375;
  pair.surface_a = 0.0625, pair.surface_b = 0.5;
  CHECK(Approach::gap({}, pair) == 0);
  CHECK(ApproachAndPosition::gap({}, pair) == 0.25);
  CHECK(FixedOffset::gap({1}, pair) == 0.25);
  CHECK(FixedOffset::gap({1.5}, pair) == -0.25);
  // A millionth of a cell, so that bodies which are seeded face to face touch in float too.
  CHECK(ParticleSurfaces::gap({}, pair) == Approx(0.4375 - 1e-6).epsilon(1e-12));
}
