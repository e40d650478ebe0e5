#include "apic.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    transfer<mpm::Apic>,
    {"apic", "1.0.0", "Affine particle-in-cell: conserves angular momentum, little dissipation, no null-space noise",
     "Jiang, Schroeder, Selle, Teran & Stomakhin (2015), ACM Trans. Graph. 34(4):51",
     R"(The particle carries C, the affine velocity field around it: it gives nodes w m (v + C d) and takes back
v = sum w v+ and C = sum v+ (x) w D^-1 d. Affine velocity fields pass unchanged, and angular momentum is conserved to rounding.
Strain and internal force use weight gradients (see `mls` for the form without them).)",
     "Apic"})
