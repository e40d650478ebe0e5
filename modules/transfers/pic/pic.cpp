#include "pic.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    transfer<mpm::Pic>,
    {"pic", "1.0.0", "Particle-in-cell: takes the grid velocity; stable, strongly dissipative",
     "Harlow (1964), Methods in Computational Physics 3:319-343",
     R"(v <- sum w v+. Every step filters the velocity field twice, so a wave of phase theta a cell loses the
factor s2(theta) = cos^2(theta/2) (particles at cell centres), and all rotation below the grid is lost. A baseline for the
others, and a way to settle a body.)",
     "Pic"})
