#include "von_mises_power.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(material<mpm::VonMisesPower>,
                  {"von_mises_power", "1.0.0", "Finite-strain J2 plasticity with power-law hardening (Swift)",
                   "Swift (1952), Plastic instability under plane stress, J. Mech. Phys. Solids 1:1; the return: Simo "
                   "& Hughes (1998), "
                   "Computational Inelasticity, box 9.1",
                   R"(The yield stress at the equivalent plastic strain alpha is

    sigma = yield_stress (1 + alpha/reference_strain)^hardening_exponent

Swift's k (eps_0 + alpha)^n has k = yield_stress/eps_0^n. The strain at which a bar in tension necks is about n - eps_0.

Elasticity, return and state are those of `von_mises`; nothing but the yield stress differs. The plastic strain of a step
solves one equation a particle by Newton's method, which a bracket around the root keeps from running away: about six evaluations of
the law. A particle that does not yield costs one.)",
                   "VonMisesPower"})
