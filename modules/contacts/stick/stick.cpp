#include "stick.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    contact<mpm::Stick>,
    {"stick", "1.0.0", "Welded bodies: the single-field result, in two fields",
     "Bardenhagen, Brackbill & Sulsky (2000), Comput. Methods Appl. Mech. Engrg. 187:529-541",
     R"(Both bodies take their common velocity at every shared node, whatever normal or gap: two fields of the same
material then reproduce a single-field run to rounding. The check on the machinery of contact, and a perfect bond.)",
     "Stick"})
