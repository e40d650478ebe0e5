#pragma once
// What the rim of a curved body costs where bodies meet: it is built of steps, since particles lie in rows.

#include <string>

#include "experiment/experiment.hpp"

namespace mpm::app {

/// The particle spacings that the radius of a body in contact should have. The contact of two spheres that deform as those
/// of the study of curved contact then errs by less than a tenth of its peak force.
inline constexpr double enough_rows_a_radius = 80;

/// What to say of the body whose radius has the fewest particle spacings; "" where all have enough, or no contact law looks
/// at the surfaces.
std::string warning_of_rim_steps(const Experiment& experiment);

}  // namespace mpm::app
