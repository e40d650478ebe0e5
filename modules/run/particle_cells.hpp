#pragma once
// Particles sorted into cubes, to find those that are near to one another.

#include <array>
#include <cstdint>
#include <functional>
#include <unordered_map>
#include <vector>

#include "simulation/simulation.hpp"

namespace mpm::app {

/// The particles of one velocity field at one time, in cubes of a given edge.
class ParticleCells {
 public:
  struct Particle {
    std::array<double, 3> position;
    double half_size;  ///< m, half the spacing of the body's particles
  };
  using Particles = std::vector<Particle>;

  /// `edge` in m.
  ParticleCells(const Simulation& simulation, int field, double edge);

  /// Calls visit(particles of a cube, those of `others` in each cube in and around it).
  void for_each_cell(const ParticleCells& others,
                     const std::function<void(const Particles&, const std::vector<const Particles*>&)>& visit) const;

 private:
  using Key = std::array<std::int32_t, 3>;
  struct Hash {
    std::size_t operator()(const Key& key) const;
  };
  int dimension_;
  std::unordered_map<Key, Particles, Hash> cells_;
};

/// How many particles have no other one of their field within the reach of their shape along every axis.
std::size_t lone_particles(const Simulation& simulation);

/// The smallest gap in m between particles of different fields, as squares or cubes of their spacing along the axes:
/// negative where they overlap. At most two cells; not a number with one field.
double gap_between_fields(const Simulation& simulation);

}  // namespace mpm::app
