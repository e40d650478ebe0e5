#include "mohr_coulomb.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    material<mpm::MohrCoulomb>,
    {"mohr_coulomb", "1.0.0",
     "Soil and rock: Hencky elasticity, Mohr-Coulomb pyramid with cohesion and a dilation angle",
     "de Souza Neto, Peric & Owen (2008), Computational Methods for Plasticity, sec. 8.2; Clausen, Damkilde & Andersen "
     "(2006), Int. J. Numer. Methods Engrg. 66:1795",
     R"(tau = 2 mu eps + lambda tr(eps) I, eps the elastic Hencky strain (logarithms of the singular values of F_e). Yield, with the largest
and the least principal stress, tension positive:

    (tau_1 - tau_3) + (tau_1 + tau_3) sin phi <= 2 c cos phi

with phi = `friction_angle`, c = `cohesion`, all in Kirchhoff stresses. The middle stress does not count. Without friction this is
Tresca's law, 2 c the strength in compression.

Flow follows the same function with psi = `dilation_angle` in place of phi: shearing by a plastic angle gamma in plane strain opens the
volume by gamma sin psi. psi = phi is the associated flow, psi = 0 (the default) keeps the volume. A psi above phi counts as phi, as the
law would make energy. The strength neither hardens nor softens, so dilation does not end by itself: real soil stops dilating at
its critical state, and cam_clay does.

The return is exact, without iteration, to a face, to an edge (where two principal stresses are equal, as in a triaxial test) or to
the apex at the tension c cot phi, which is where it ends beyond both edges. Dissipation is tau:(eps_trial - eps) with tau after the
return, never negative.

A gap that opened in tension is not kept in mind: pressure returns as soon as the soil is compressed again, and loose soil that is
tossed about seems to grow. drucker_prager has a correction for that, and no dilation.

Wave speed: sqrt((lambda + 2 mu + a - least principal stress)/density), never below the shear wave's. a is a bound of what flow that is
not associated can add; it is 0 for psi = phi, 31 % of lambda + 2 mu at 30 degrees, psi = 0 and a Poisson's ratio of 0.3.)",
     "MohrCoulomb"})
