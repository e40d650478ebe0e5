#pragma once
// Particles from geometry: a regular lattice in every cell, centred, kept where the body's geometry contains it.

#include "simulation/backend.hpp"

namespace mpm {

/// The particles of one body: n a cell axis at (k + 1/2)/n of the cell, shifted by the body's jitter. Every particle
/// has the volume (h/n)^D. Throws InputError when the body holds no particle (its geometry is thinner than the
/// lattice).
SeededBody seed_body(const Experiment& experiment, int body);

}  // namespace mpm
