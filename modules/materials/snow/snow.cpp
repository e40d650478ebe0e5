#include "snow.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    material<mpm::Snow>,
    {"snow", "1.0.0", "Snow: fixed corotated elasticity, stretches clamped, moduli that grow with compaction",
     "Stomakhin, Schroeder, Chai, Teran & Selle (2013), A material point method for snow simulation, ACM Trans. Graph. "
     "32(4):102",
     R"(psi = h (mu |F_E - R_E|^2 + lambda/2 (J_E - 1)^2),   h = exp(xi (1 - J_P)),   F = F_E F_P:

    tau = h (2 mu (F_E - R_E) F_E^T + lambda (J_E - 1) J_E I)

Singular values of F_E beyond 1 - theta_c and 1 + theta_s go back there, and the rest goes to F_P, of which only J_P = det F_P is
kept. Compacted snow (J_P < 1) so hardens, parted snow softens. Dry powder has small theta_c and theta_s, wet and chunky snow large ones;
icy snow has a large xi and large moduli, muddy snow small ones. The paper's snow: 140 kPa, 0.2, 400 kg/m^3, and the defaults here.

`largest_hardening` is not of the paper: h stays between its inverse and itself, so that a crushed particle's waves, and with them
the time step, stay in reach and parted snow keeps a wave speed. 100 counts from J_P = 0.54 and 1.46 on; a large number leaves the
paper's law. J_P itself has no bound, and J = J_E J_P is exact. J <= 0 is refused: the run stops and names the particle.

**The law can make energy.** psi is stored, so a change of h changes what is stored. Plastic rates of stretch d_i leave

    D = h sum (tau_i/h + xi J_P psi/h) d_i

of the work. The second law asks for D >= 0, and the paper's return does not ask for it: each stretch goes back to its bound by
itself, whatever the stress along it. D is negative
- where snow parts along one axis while it is pressed on from the others, which press along that axis too by lambda: with both
  others at 1 - theta_c and the paper's numbers where J_P < 0.62, and the more often the larger Poisson's ratio is;
- where compaction hardens so fast that more is stored than the work: along all axes where xi J_P theta_c > 2/3, along one axis
  where it is > 2. The paper's numbers stay below.

The dissipation is D with its sign. So the work is stored plus dissipated energy everywhere, the ledger's material book closes, and
what the law makes shows as negative dissipation. With `dissipation_to_heat` such a particle cools.

Wave speed: sqrt((h (2 mu s^2 + lambda J_E^2) + (1 + xi J_P) max |tau_i|)/density), s the largest stretch: the elastic waves, and
what hardening and the stress that flows along can add; without xi J_P where h is at its bound.)",
     "Snow"})
