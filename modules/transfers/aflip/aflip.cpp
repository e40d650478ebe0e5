#include "aflip.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    transfer<mpm::Aflip>,
    {"aflip", "1.0.0", "Affine FLIP: FLIP's velocity update with APIC's affine field; little dissipation, watch walls",
     "Fei, Guo, Wu, Huang & Gao (2021), ACM Trans. Graph. 40(4):109",
     R"(v <- sum w v+ + alpha (v - sum w v-) with alpha = 1 - `pic_fraction`, and C = sum v+ (x) w D^-1 d; the particle gives nodes
w m (v + C d). What the grid smooths away is given back to the particle, as in `flip`, and the affine field brings the particle's
surroundings to the grid, as in `apic` (a fraction of 1 is `apic`). sum w v+ moves the particle. The paper's alpha is 0.99.

Mass and linear momentum are conserved to rounding, affine fields pass unchanged. Angular momentum is not exact: v keeps what C holds
too. For the same reason kinetic energy and angular momentum count v alone, as with `flip`. Without forces and with a
fraction of 0 the velocity is kept, and so is noise that the grid cannot see. The grid keeps two velocities. A wave of which a
gather leaves s reaches the grid as v / s and comes back as s v: its energy swings, up to 1/s^2 of the start at full strain
(6 % more in the two lowest waves of a block of ten cells), and does not build up.

v- is the grid's velocity after conditions and contact before the forces, as in `flip`; the paper takes it before
them. Here walls are mirror images: v- of a body and its image is the velocity after the wall, and with the one before
it a slip wall would not be the plane of symmetry of a whole body. What a particle keeps therefore does not feel a
wall's or a contact's impulse before the forces, and a body that is pressed against a wall can gain energy, above all with a
fraction of 0. Watch the energy there, and raise the fraction.)",
     "Aflip"})
