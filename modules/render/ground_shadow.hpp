// The soft shadow that balls cast on the ground.
#pragma once

#include <vector>

#include "render/ball_view.hpp"

namespace mpm::render {

/// Light left over on the ground, 0 dark to 1 lit, in a square grid over a rectangle of the ground plane.
struct GroundShadow {
  double x0 = 0, y0 = 0, x1 = 1, y1 = 1;  ///< m
  int size = 0;
  std::vector<float> light;  ///< size * size, x fastest
};

/// Casts the balls' shadow. `to_light` is the unit vector towards the light, `ground` the height of the plane, m.
GroundShadow cast_shadow(const std::vector<Ball>& balls, const Vec3& to_light, double ground, double x0, double y0,
                         double x1, double y1);

}  // namespace mpm::render
