#include "prony.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    material<mpm::Prony>,
    {"prony", "1.0.0", "Generalised Maxwell solid: Neo-Hookean equilibrium spring and two relaxing branches",
     "Simo (1987), On a fully three-dimensional finite-strain viscoelastic damage model, Comput. Methods Appl. Mech. "
     "Engrg. 60:153; Simo & Hughes (1998), Computational Inelasticity, sec. 10.3; the branches: Green & Tobolsky "
     "(1946), "
     "J. Chem. Phys. 14:80, Linder, Tkachuk & Miehe (2011), J. Mech. Phys. Solids 59:2134",
     R"(tau = mu dev(J^-2/3 b) + G_1 dev(A_1) + G_2 dev(A_2) + K J u' I,   dA_i/dt = L' A_i + A_i L'^T - (A_i - I)/t_i

with L' = L - tr(L)/3 I: shear relaxes, volume does not. The shear modulus after a sudden strain is the Prony series
mu + G_1 exp(-t/t_1) + G_2 exp(-t/t_2), at any stretch: stress then is dev(J^-2/3 b) times it. At the instant it is `neo_hookean` (split)
with mu + G_1 + G_2, after all relaxation with mu.

Each branch is a network whose chains break and reform at rest with the rate 1/t_i. Its energy G_i/2 (tr A_i - 3 - ln det A_i) and
dissipation G_i/(2 t_i) tr(A_i + A_i^-1 - 2 I) are those of the second law, at any strain, which those of Simo's linear branches need not be;
stress after a sudden strain is the same in both.

The step pushes A_i forward by its isochoric deformation, so that it turns with the particle, and relaxes it in closed form with what
the step's own strain adds: small strains that are piecewise linear in time have the exact stress for any step, finite ones to
second order. A_i stays positive definite.

Branches are two, always: what a plugin's particles carry is fixed when it is built. One alone has G_2 = 0, and carries 4 or 6 scalars
that do nothing. A spectrum of more times is fitted by two in the decade or so that a run resolves; slower branches belong to mu, and
branches faster than the run to the viscosity of `kelvin_voigt`.

Wave speed: that of the split Neo-Hookean solid with the sum of all springs for mu b', the glassy wave; at rest
sqrt((K + 4/3 (mu + G_1 + G_2))/rho0). Relaxation does not limit the step.)",
     "Prony"})
