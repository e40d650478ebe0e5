#pragma once
// Seeds the particles of bodies: where the experiment's `seeding` places them, with all that they begin with.

#include "simulation/backend.hpp"

namespace mpm {

/// Seeds the particles of one body. On the lattice of the cells: n along each axis of a cell, at (k + 1/2)/n of the cell,
/// where the geometry contains that point, shifted by the body's jitter, each of the volume (h/n)^D. Elsewhere as
/// experiment/places.hpp says. Throws InputError when the body holds no particle, or cannot have its initial state.
SeededBody seed_body(const Experiment& experiment, int body);

}  // namespace mpm
