#include "herschel_bulkley.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    material<mpm::HerschelBulkley>,
    {"herschel_bulkley", "1.0.0", "Yield-stress fluid (Herschel-Bulkley, Bingham) with six equations of state",
     "Yue, Smith, Batty, Zheng & Grinspun (2015), Continuum foam: a material point method for shear-dependent flows, "
     "ACM "
     "Trans. Graph. 34(5):160; Herschel & Bulkley (1926), Kolloid-Z. 39:291; Bingham (1916), Bull. Bur. Stand. 13:309",
     R"(Mud, paste, foam, fresh concrete: an elastic solid below the yield stress tau_y, which holds a slope for ever, and above it a fluid

    shear stress = tau_y + k (rate)^n      n = 1: Bingham; tau_y = 0: power-law fluid; n = 1 and tau_y = 0: a Maxwell fluid

with psi = U(J) + G/2 (tr b_e - 3), det b_e = 1, and tau = -p J I + G dev(b_e). The shear stress is |dev tau|/sqrt 2 and the rate
sqrt(2 d:d) of the viscous flow d. The pressures p(J) are those of `newtonian_fluid`, whose manual explains them, and `tension`.

G is what the yield law has beside the fluid: yield is sharp, and nothing creeps below it, which a regularised viscosity
(Papanastasiou 1987) does. Take G large beside the stresses (ten times or more): elastic strains, and with them normal stresses in
shear, then stay small; waves of G shorten the step by sqrt(1 + 4 G/(3 K)). A flow has the stress of its rate after the time k/G.

The return is implicit and radial: k g^n + a g = overstress with a = G dt tr(b_e)/3, in closed form for n = 1, else by Newton's method
on the logarithm of the rate, which cannot overshoot. Steps are as long as elastic waves allow at any viscosity.

`consistency` is the number k in Pa s^n, the stress above tau_y at a rate of 1/s.

State: the isochoric elastic b_e, and ln J. The dissipation is stress times flow, never negative. J <= 0 is refused: the run stops
and names the particle.

Wave speed: that of the split Neo-Hookean solid of G with the equation of state's stiffness, exact at rest,
sqrt((K + 4/3 G)/density); flow makes waves slower.)",
     "HerschelBulkley"})
