#pragma once
// Two discs that collide head-on in one velocity field, and how fast their centres part.

#include <cmath>

#include "support/scene.hpp"
#include "verification/colliding_discs.hpp"

namespace mpm::test {

/// The discs of colliding_discs.hpp on quadratic B-splines, with a ledger.
inline Scene head_on_discs(const std::vector<std::string>& settings) {
  std::vector<std::string> all{"/shape/type=bspline_quadratic", "/output/ledger=true"};
  all.insert(all.end(), settings.begin(), settings.end());
  return Scene(colliding_discs::discs, all);
}

/// The mean place and velocity of a body of equal particles.
struct Centre {
  double place[2] = {}, velocity[2] = {};
};

inline Centre centre_of(const BodyState& state) {
  Centre mean;
  const double count = static_cast<double>(state.position.size()) / 2;
  for (std::size_t k = 0; k < state.position.size(); ++k) {
    mean.place[k % 2] += state.position[k] / count;
    mean.velocity[k % 2] += state.velocity[k] / count;
  }
  return mean;
}

/// How far the centres of mass of two bodies are apart, m, and how fast that grows, m/s.
struct Approach {
  double distance = 0, rate = 0;
};

inline Approach approach_of(const Scene& scene) {
  const Centre a = centre_of(scene.body(0)), b = centre_of(scene.body(1));
  const double dx = b.place[0] - a.place[0], dy = b.place[1] - a.place[1], distance = std::hypot(dx, dy);
  return {distance, ((b.velocity[0] - a.velocity[0]) * dx + (b.velocity[1] - a.velocity[1]) * dy) / distance};
}

}  // namespace mpm::test
