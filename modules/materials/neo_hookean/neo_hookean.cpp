#include "neo_hookean.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    material<mpm::NeoHookean>,
    {"neo_hookean", "1.0.0", "Neo-Hookean solid, coupled or isochoric-volumetric split, three volumetric energies",
     "Ogden (1984), Non-linear Elastic Deformations; Simo & Hughes (1998), Computational Inelasticity, ch. 9",
     R"(`coupled`: psi = mu/2 (tr b - 3 - 2 ln J) + lambda u(J). `split`: psi = mu/2 (J^-2/3 tr b - 3) + K u(J).
u(J) is (ln J)^2/2 (softens beyond J = e), (J-1)^2/2 (finite when crushed) or ((J^2-1)/2 - ln J)/2 (stiff at both ends: choose
it for impacts). They agree near J = 1. J <= 0 is refused: the run stops and names the particle.)",
     "NeoHookean"})
