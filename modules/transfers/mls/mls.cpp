#include "mls.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    transfer<mpm::Mls>,
    {"mls", "1.0.0", "MLS-MPM: APIC with the stress folded into the affine term; no weight gradients",
     "Hu, Fang, Ge, Qu, Zhu, Pradhana & Jiang (2018), ACM Trans. Graph. 37(4):150",
     R"(As `apic`, but the stress enters as -V0 tau D^-1 in the affine term and the affine matrix itself strains the
particle, so a stencil needs weights only.

On quadratic splines D^-1 w d is grad w plus s (1 - 4 s^2) / 2h times the second difference of the nodes, s being the
place beside the middle node in cells: the same as standard MPM on fields linear along each axis, off by at most 0.1 h v''
beyond. On cubic ones it is grad w minus f^2 (1 - f)^2 / 2h times the third difference, f being the place between two nodes:
the same on quadratic fields, off by at most h^2 v''' / 32 beyond. Both do the same work on affine fields, whatever the stress.

On `linear`, where w D^-1 d = grad w, it is the same as `apic`.)",
     "Mls"})
