#include "oldroyd_b.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    material<mpm::OldroydB>,
    {"oldroyd_b", "1.0.0", "Oldroyd-B liquid: upper-convected Maxwell polymer, Newtonian solvent, volumetric energy",
     "Oldroyd (1950), On the formulation of rheological equations of state, Proc. R. Soc. A 200:523; Bird, Armstrong & "
     "Hassager (1987), Dynamics of Polymeric Liquids, vol. 1, sec. 7.2; energy and dissipation: Wapperom & Hulsen "
     "(1998), J. Rheol. 42:999",
     R"(tau = G (A - I) + K J u' I + 2 eta_s J dev d,   dA/dt = L A + A L^T - (A - I)/lambda,   G = eta_p/lambda

A is the conformation of the polymer, the mean of its chains' end-to-end vectors squared, I at rest. Stress of the polymer per initial
volume, as its chains are those of the mass. Steady shear at the rate g: viscosity eta_p + eta_s at any rate, first normal stress
difference 2 eta_p lambda g^2, no second. Extension at more than 1/(2 lambda) has no steady state: chains grow without bound, as no
spring of the model does end. Stress after a sudden strain falls by exp(-t/lambda).

Stored is G/2 (tr A - 3 - ln det A) + K u(J); dissipated are G/(2 lambda) tr(A + A^-1 - 2 I) by the polymer and 2 eta_s J dev d : d by the
solvent.

The step takes A to f A f^T, f = I + dt L, and relaxes it in closed form with what the step's own strain adds: second order in dt,
exact for relaxation and for the shear stress of simple shear, positive definite for any step; steps longer than lambda end at
the viscous stress. No deformation gradient is kept: A, the solvent's stress (4 or 6 scalars each) and J. A liquid in tension does not
cavitate: it pulls by K u. A solvent is part of the law: the upper-convected Maxwell liquid is met by one as thin as wanted.

**Time step.** What is reported as wave speed is the speed by which `courant` holds with the solvent's viscosity, see `kelvin_voigt`:
a + sqrt(c^2 + a^2), c the wave of the instant, rho0 c^2 = K J^2 u'' + G (1 + largest principal value of A), and a = sqrt(3) J 4/3
eta_s/(rho0 h). K sets it as a rule; take as little as keeps the flow's Mach number below 0.1.)",
     "OldroydB"})
