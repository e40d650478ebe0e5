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
the time step, stay in reach and parted snow keeps a wave speed. 100 counts from J_P = 0.54 and 1.46 on. J_P itself has no bound,
and J = J_E J_P is exact. J <= 0 is refused: the run stops and names the particle.

Stored is psi, so what hardening adds to it is stored. Heat is the rest of the work: tau on the plastic strain less psi0 dh, with
psi0 = psi/h. Compaction along one axis stores xi theta_c J_P/2 of its plastic work (an eighth at first, more if all axes are
compacted); parting gives the energy of the softened snow away as heat. Each stretch is clamped by itself though lambda couples the
stresses, so the flow has no potential and can run against the stress: snow under strong pressure from the sides that is pulled
apart along one axis, where J_P is below 0.68 (defaults), and in general where theta_c, theta_s and Poisson's ratio are such that
lambda |2 theta_c - theta_s| or lambda |2 theta_s - theta_c| exceeds 2 mu times the theta of the yielding side. Compaction where
xi theta_c J_P is about 2/3 or more stores more than its work. There heat is zero, never negative, and the law itself makes the
missing energy: the sum of the ledger grows. A Poisson's ratio above 0.3, where this rules, is
refused.

Wave speed: sqrt((h (2 mu s^2 + lambda J_E^2) + (1 + xi J_P) max |tau_i|)/density), s the largest stretch: the elastic waves, and
what hardening and the stress that flows along can add; without the factor xi J_P where h is at its bound.)",
     "Snow"})
