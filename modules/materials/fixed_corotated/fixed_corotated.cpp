#include "fixed_corotated.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(material<mpm::FixedCorotated>,
                  {"fixed_corotated", "1.0.0",
                   "Fixed corotated solid: Hooke's law in the frame that turns with F, J in the volumetric part",
                   "Stomakhin, Howes, Schroeder & Teran (2012), Energetically consistent invertible elasticity, Symp. "
                   "Computer Animation: the fixed corotated energy",
                   R"(psi = mu |F - R|^2 + lambda/2 (J - 1)^2, R the rotation of the polar decomposition F = R S;

    tau = 2 mu (F - R) F^T + lambda (J - 1) J I

The first Piola stress of a deformation at constant volume is linear in its stretches. Small-strain moduli are those of
`linear_elastic`, without its false stress under rotation. The usual elastic law of computer graphics and the base of its snow.

No barrier against crushing: energy and stress stay finite as J -> 0, so under strong compression particles invert sooner than with
`neo_hookean`; J <= 0 is refused: the run stops and names the particle. In plane strain tau_zz = lambda (J - 1) J.

The wave speed is sqrt((2 mu s^2 + lambda J^2)/rho0), s the largest stretch: the fastest tangent wave, longitudinal along s.)",
                   "FixedCorotated"})
