#include "cam_clay.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    material<mpm::CamClay>,
    {"cam_clay", "1.0.0",
     "Clay: Hencky elasticity, ellipse of modified Cam-Clay with cohesion, hardening by compaction",
     "Borja & Tamagnini (1998), Comput. Methods Appl. Mech. Engrg. 155:73; Gaume, Gast, Teran, van Herwijnen & Jiang "
     "(2018), Nat. Commun. 9:3047",
     R"(tau = 2 mu eps + lambda tr(eps) I, eps the elastic Hencky strain (logarithms of the singular values of F_e). Yield, with the pressure
p = -tr(tau)/3 and q = sqrt(3/2) |dev tau|:

    (1 + 2 beta) q^2 + M^2 (p + beta p_c)(p - p_c) <= 0,   p_c = p_c0 exp(xi e),   e = -ln J_p

with p_c0 = `preconsolidation_pressure`, M = `critical_state_slope`, xi = `hardening`, beta = `cohesion_ratio`. J_p is what of the
volume is lost for good. Flow is associated: pressed clay (p > (1 - beta) p_c/2) compacts and hardens, sheared overconsolidated clay
dilates and softens, and both end at the critical state p = (1 - beta) p_c/2, where clay shears at constant volume and stress; q = M p
there without cohesion. In virgin compression from all sides, p = p_c, the volumetric strain is p/K + ln(p/p_c0)/xi: xi is
1/(lambda* - kappa*) of the slopes of ln v against ln p. Cohesion goes with p_c, so that clay that parts loses it, and pressure
returns when the gap has closed.

The hardening is that of Borja & Tamagnini, with constant elastic moduli in place of their elasticity by pressure, which has no
state without stress. The ellipse is that of Gaume et al.; their p_c = K sinh(xi max(e, 0)) begins at a compaction that has to be
given, and vanishes for e < 0.

**The slope of hardening is clamped.** Where dp_c/de = xi p_c is so steep that softening would make the stress jump, p_c goes on
along a straight line. Half the slope of the jump is taken: with M = 1.2, beta = 0 and a Poisson's ratio of 0.3 the clamp works from
p_c = 3.9 K/xi on.

Each step solves one equation for the compaction, between bounds, by Newton's method or by halving, with 30 iterations at most.
Dissipation is tau:(eps_trial - eps) with tau after the return, never negative. Wave speed: sqrt((lambda + 2 mu - least principal
stress)/density), never below the shear wave's; yielding only makes waves slower.)",
     "CamClay"})
