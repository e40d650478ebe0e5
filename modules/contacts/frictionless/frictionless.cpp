#include "frictionless.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    contact<mpm::Frictionless>,
    {"frictionless", "1.0.0", "Bodies that press on one another and slide freely",
     "Bardenhagen, Brackbill & Sulsky (2000), Comput. Methods Appl. Mech. Engrg. 187:529-541",
     R"(At a node where two bodies approach and their surfaces touch, the normal velocities are made equal and nothing
acts along the surface: `coulomb` with a friction of 0. Bodies that move apart are left alone. It makes no heat.)",
     "Frictionless"})
