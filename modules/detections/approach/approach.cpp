#include "approach.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    detection<mpm::Approach>,
    {"approach", "1.0.0", "Bodies touch wherever they share a node and approach",
     "Bardenhagen, Brackbill & Sulsky (2000), Comput. Methods Appl. Mech. Engrg. 187:529-541",
     R"(The gap is zero everywhere, so that a law is left with the velocities: bodies that approach touch as soon as a node
sees both, which with quadratic B-splines and 2 particles a cell is 1.5 to 2.5 cells too early. Nothing is summed for
it. It is kept to show what a detection by position is for. Laws that hold bodies that are near refuse it.)",
     "Approach"})
