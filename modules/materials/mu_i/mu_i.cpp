#include "mu_i.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    material<mpm::MuI>,
    {"mu_i", "1.0.0", "Dry grains: friction that grows with the inertial number, no stress where grains are apart",
     "Jop, Forterre & Pouliquen (2006), Nature 441:727; Dunatunga & Kamrin (2015), J. Fluid Mech. 779:483",
     R"(Elastic: tau = 2 mu eps + lambda tr(eps) I, eps the elastic Hencky strain (logarithms of the singular values of F_e). Flow, with the
pressure p = -tr(tau)/3, s = sqrt(dev tau : dev tau/2) and the plastic shear rate g, which are those of simple shear:

    s = mu(I) p,   mu(I) = mu_s + (mu_2 - mu_s)/(I_0/I + 1),   I = g d sqrt(rho_s/p)

and none where s <= mu_s p. mu_s = `static_friction`, mu_2 = `limit_friction`, I_0 = `inertial_number`, d = `grain_diameter`, rho_s =
`grain_density`; the defaults are those of glass beads in the paper. Stresses are Kirchhoff's, as everywhere here: the grains are stiff,
and J differs from 1 by p/K where they touch.

Flow keeps the volume. Grains are in contact where the density is above `critical_density` and carry the pressure K ln(density/
critical_density); below it they carry no stress, whatever happened before, and no gap is forgotten. A packing that starts at its
critical density rests without stress; one that starts looser falls freely until it is compacted to it.

A step takes s from its trial by a quadratic equation in closed form. For dt g much above s/G it is the steady flow, and for
slow changes the return to the cone s = mu_s p. mu_2 = mu_s is a Drucker-Prager law without rates. Dissipation is s g dt, never
negative; what the grains lose by parting is nothing, as they part at p = 0 and with it s = 0.

Wave speed: sqrt((lambda + 2 mu + a - least principal stress)/density), never below the shear wave's, with a the most that a cone of
friction mu_2 can add (see drucker_prager).)",
     "MuI"})
