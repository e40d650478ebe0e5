#include "von_mises_voce.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    material<mpm::VonMisesVoce>,
    {"von_mises_voce", "1.0.0", "Finite-strain J2 plasticity with hardening that saturates (Voce)",
     "Voce (1948), The relationship between stress and strain for homogeneous deformation, J. Inst. Metals 74:537; the "
     "return: Simo & Hughes (1998), Computational Inelasticity, box 9.1",
     R"(The yield stress at the equivalent plastic strain alpha is

    sigma = yield_stress + saturation_hardening (1 - exp(-alpha/saturation_strain)) + hardening_modulus alpha

Papers that write exp(-delta alpha) have saturation_strain = 1/delta, and those with a final stress have saturation_hardening =
final stress - yield_stress.

Elasticity, return and state are those of `von_mises`; nothing but the yield stress differs. The plastic strain of a step
solves one equation a particle by Newton's method, which a bracket around the root keeps from running away: about six evaluations of
the law. A particle that does not yield costs one.)",
     "VonMisesVoce"})
