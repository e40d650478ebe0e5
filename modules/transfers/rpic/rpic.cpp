#include "rpic.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    transfer<mpm::Rpic>,
    {"rpic", "1.0.0",
     "Rigid particle-in-cell: keeps the spin alone; conserves angular momentum, damps all other motion",
     "Jiang, Schroeder, Selle, Teran & Stomakhin (2015), ACM Trans. Graph. 34(4):51, section 5.2",
     R"(The particle carries its spin W, an antisymmetric matrix: it gives nodes w m (v + W d) and takes back v = sum w v+ and the W
that has the angular momentum of the grid's field about it. With C = sum v+ (x) w D^-1 d and D = sum w d d^T, the stencil's own
second moment, that is the W of W D + D W = C D - (C D)^T (the paper's K^-1 L). Where D is a multiple of the identity (splines) this
is W = (C - C^T) / 2; on `linear`, `gimp` and `cpdi` the antisymmetric part of C alone would not conserve, and the program solves
for W with the particle's D.

Rigid motion passes unchanged. Angular momentum is conserved to rounding by every gather and every scatter, on every shape; over whole
steps too where D is constant (splines). Stretch and shear below the grid are damped as by `pic`: more than by `apic`, which
keeps them. Use it where a body should settle without losing its spin.)",
     "Rpic"})
