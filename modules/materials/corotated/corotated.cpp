#include "corotated.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    material<mpm::Corotated>,
    {"corotated", "1.0.0", "Linear corotated solid: Hooke's law in the frame that turns with F",
     "Mueller & Gross (2004), Interactive virtual materials, Graphics Interface; Sifakis & Barbic (2012), "
     "FEM simulation of 3D deformable solids, SIGGRAPH course, sec. 3.4",
     R"(psi = mu |F - R|^2 + lambda/2 tr(R^T F - I)^2, R the rotation of the polar decomposition F = R S;

    tau = 2 mu (F - R) F^T + lambda tr(S - I) R F^T

It is Hooke's law of the stretch S, to the letter: principal first Piola stresses are 2 mu (s_i - 1) + lambda sum (s_j - 1).
Small-strain moduli are those of `linear_elastic`, without its false stress under rotation.

**It differs from `fixed_corotated` in the volumetric term**, lambda/2 (sum (s_i - 1))^2 here and lambda/2 (J - 1)^2 there. Both agree to
first order. At finite strain the sum is no measure of the volume: stretches 2, 1/2, 1 keep the volume and have a sum of 1/2, and
stretches 3/2, 1/2, 1 have none and 3/4 of the volume. So at larger Poisson's ratios volume is lost in shear and bending, which is why
the fixed law replaced it. In uniaxial strain both are the same. Equal stretches s need the same energy as here with
9 (s - 1)^2 instead of (s^3 - 1)^2: softer in tension, and in compression stiffer.

No barrier against crushing: energy and stress stay finite as J -> 0, so under strong compression particles invert sooner than with
`neo_hookean`; J <= 0 is refused: the run stops and names the particle.

Wave speed: sqrt((2 mu s^2 + max(lambda s^2, (lambda tr(S - I) - 2 mu) s, 0))/rho0), s the largest stretch: the longitudinal wave along s,
or a bound of the shear waves of a solid that is stretched much in all directions.)",
     "Corotated"})
