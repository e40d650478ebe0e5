#include "mls.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    transfer<mpm::Mls>,
    {"mls", "1.0.0", "MLS-MPM: APIC with the stress folded into the affine term; no weight gradients",
     "Hu, Fang, Ge, Qu, Zhu, Pradhana & Jiang (2018), ACM Trans. Graph. 37(4):150",
     R"(As `apic`, but the stress enters as -V0 tau D^-1 in the affine term and the affine matrix itself strains the
particle, so a stencil needs weights only. For quadratic and cubic splines it agrees with standard MPM to the order of the
moving-least-squares fit. On `linear`, where w D^-1 d = grad w, it is the same as `apic`.)",
     "Mls"})
