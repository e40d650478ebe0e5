#include "flip.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    transfer<mpm::Flip>,
    {"flip", "1.0.0", "Fluid-implicit-particle: adds the grid's velocity change; keeps energy and null-space noise",
     "Brackbill & Ruppel (1986), J. Comput. Phys. 65:314-343",
     R"(v <- (1 - a)(v + sum w (v+ - v-)) + a sum w v+ with a = `pic_fraction`. Without forces the velocity is
kept exactly, whatever the field; so is noise that the grid cannot see (v = (-1)^p never decays). A fraction of PIC damps that
noise at a cost in energy that grows as the step shrinks. The grid keeps two velocities.)",
     "Flip"})
