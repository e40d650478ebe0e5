#include "aflip.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    transfer<mpm::Aflip>,
    {"aflip", "1.0.0", "Affine FLIP: FLIP's velocity update with APIC's affine field; the least dissipation",
     "Fei, Guo, Wu, Huang & Gao (2021), ACM Trans. Graph. 40(4):109",
     R"(v <- sum w v+ + alpha (v - sum w v-) with alpha = 1 - `pic_fraction`, and C = sum v+ (x) w D^-1 d; the particle gives nodes
w m (v + C d). What the grid smooths away is given back to the particle, as in `flip`, and the affine field brings the particle's
surroundings to the grid, as in `apic` (a fraction of 1 is `apic`). sum w v+ moves the particle. The paper's alpha is 0.99.

Mass and linear momentum are conserved to rounding, affine fields pass unchanged. Angular momentum is not exact: v keeps what C holds
too. For the same reason kinetic energy and angular momentum count v alone, as with `flip`. Without forces and with a
fraction of 0 the velocity is kept, and so is noise that the grid cannot see. v- is the grid's velocity after conditions and contact
before the forces, as in `flip`. The grid keeps two velocities.)",
     "Aflip"})
