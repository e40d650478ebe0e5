#include "coulomb.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    contact<mpm::Coulomb>,
    {"coulomb", "1.0.0", "Coulomb friction with separation, static and kinetic",
     "Bardenhagen, Brackbill & Sulsky (2000), Comput. Methods Appl. Mech. Engrg. 187:529-541",
     R"(At a node where two bodies approach and their surfaces touch, the normal velocities are made equal and the
tangential impulse is that of sticking, or `friction` times the normal impulse where sticking would need more than
`static_friction`. Bodies that move apart are left alone. Energy turned to heat by sliding is reported.)",
     "Coulomb"})
