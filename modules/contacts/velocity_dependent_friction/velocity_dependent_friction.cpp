#include "velocity_dependent_friction.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    contact<mpm::VelocityDependentFriction>,
    {"velocity_dependent_friction", "1.0.0", "Friction that falls, or rises, with the sliding speed",
     "Benson & Hallquist (1990), Comput. Methods Appl. Mech. Engrg. 78:141-163",
     R"(As `coulomb`, with the coefficient mu(v) = friction + (static_friction - friction) exp(-v / decay_speed) at the
sliding speed v that is left at the end of the step. A pair sticks where sticking needs no more than
`static_friction`. A coefficient that falls with the speed makes stick and slip; one that rises damps sliding.)",
     "VelocityDependentFriction"})
