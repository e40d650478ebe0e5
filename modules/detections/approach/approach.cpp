#include "approach.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    detection<mpm::Approach>,
    {"approach", "1.0.0", "Bodies touch wherever they share a node and approach",
     "Bardenhagen, Brackbill & Sulsky (2000), Comput. Methods Appl. Mech. Engrg. 187:529-541",
     R"(The gap is zero everywhere, so that a law is left with the velocities: bodies that approach touch as soon as a node
sees both, one or two cells too early by the shape function, and bodies that part are free. Nothing is summed for it. Kept
to show what a detection by position is for.)",
     "Approach"})
