// A compiler may make one operation of a product and a sum where a step advances and asks for the stress, and two where the
// stress is asked alone: fused passes would then round otherwise than separate ones. This law's stress is such a case.
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("fp-contract=off")
#endif

#include "kelvin_voigt.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(material<mpm::KelvinVoigt>,
                  {"kelvin_voigt", "1.0.0", "Kelvin-Voigt solid: a Neo-Hookean spring beside a Newtonian dashpot",
                   "Simo & Hughes (1998), Computational Inelasticity, sec. 9.2 (the spring); Landau & Lifshitz, Fluid "
                   "Mechanics, sec. 15 (the dashpot)",
                   R"(tau = mu dev(J^-2/3 b) + K J u' I + J (2 eta dev d + zeta tr(d) I)

The spring is the split form of `neo_hookean`; the dashpot gives the Cauchy stress of a compressible Newtonian fluid. d is the rate of
deformation over the last step, ln(f f^T)/(2 dt) of f = I + dt L by a Cayley transform, so that no rigid turn makes stress. The
work of the viscous stress is dissipated, and nothing else is.

Small strains of shear: tau = mu gamma + eta dgamma/dt. Under a stress put on at once they creep as (tau/mu)(1 - exp(-t mu/eta)); held they
do not relax, and a sudden strain meets no bound: for a glassy modulus take `prony`. It damps short waves, with the loss factor
eta w/mu at the frequency w.

Rates need a state: the viscous stress (4 or 6 scalars).

**Time step.** Viscosity limits explicit steps by h^2, so the law asks for the cell size h, and what it reports as wave speed is the
speed by which `courant` holds: a + sqrt(c^2 + a^2), c the elastic wave's and a = sqrt(3) J (4/3 eta + zeta)/(rho0 h). Without
viscosity that is c. Steps then fall as 1/eta where a is large.)",
                   "KelvinVoigt"})
