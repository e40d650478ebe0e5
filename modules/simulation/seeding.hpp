#pragma once
// Seeds particles on a regular, centred lattice in every cell, where the body's geometry contains its points.

#include "simulation/backend.hpp"

namespace mpm {

/// Seeds the particles of one body: n along each axis of a cell, at (k + 1/2)/n of the cell, shifted by the body's
/// jitter. Every particle has the volume (h/n)^D. Throws InputError when the body holds no particle (its geometry is
/// thinner than the lattice).
SeededBody seed_body(const Experiment& experiment, int body);

}  // namespace mpm
