#include "aflip.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    transfer<mpm::Aflip>,
    {"aflip", "1.1.0", "Affine FLIP: FLIP's velocity update with APIC's affine field; little dissipation",
     "Fei, Guo, Wu, Huang & Gao (2021), ACM Trans. Graph. 40(4):109",
     R"(v <- sum w v+ + alpha (v - sum w v-) with alpha = 1 - `pic_fraction`, and C = sum v+ (x) w D^-1 d; the particle gives nodes
w m (v + C d). What the grid smooths away is given back to the particle, as in `flip`, and the affine field brings the particle's
surroundings to the grid, as in `apic` (a fraction of 1 is `apic`). sum w v+ moves the particle. The paper's alpha is 0.99.

Mass and linear momentum are conserved to rounding, affine fields pass unchanged. Angular momentum is not exact: v keeps what C holds
too. For the same reason kinetic energy and angular momentum count v alone, as with `flip`. Without forces and with a
fraction of 0 the velocity is kept, and so is noise that the grid cannot see. The grid keeps two velocities.

v- is the grid's velocity before conditions and contact, as in the paper: what a particle keeps feels their impulse before the forces
too. With the v- after them, as in `flip`, a body that is pressed against walls gains energy. Two blocks thrown into a corner of
sticking walls with 24.8 J never have more, at the default (with the other v-: 25.1 J) and at 0 (25.7 J); 11.8 and 13.5 J are left
after 3 s (`flip`: 21.4 J, `apic`: 8.8 J). Away from walls the default loses about as much as `apic`, and 0 gained 0.4 % in a second.)",
     "Aflip"})
