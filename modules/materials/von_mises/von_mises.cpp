#include "von_mises.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    material<mpm::VonMises>,
    {"von_mises", "1.0.0", "Finite-strain J2 plasticity with linear isotropic hardening, no spectral decomposition",
     "Simo & Hughes (1998), Computational Inelasticity, box 9.1",
     R"(Split Neo-Hookean elasticity; the deviatoric Kirchhoff stress returns radially to the yield surface
|s| = sqrt(2/3)(yield_stress + hardening_modulus alpha). State: isochoric b_e (4 or 6), J, alpha; no deformation gradient. After
a return tr(b_e) is set so that det(b_e) = 1. Dissipation is |s| times the plastic multiplier.

`von_mises_power`, `von_mises_voce` and `johnson_cook` differ in their hardening alone.)",
     "VonMises"})
