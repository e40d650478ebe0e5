#include "given.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    normal<mpm::Given>,
    {"given", "1.0.0", "One direction for all nodes, as the experiment gives it",
     "Nairn (2013), CMES - Comput. Model. Eng. Sci. 92:271-299",
     R"(The normal is the unit vector along (`x`, `y`, `z`), from the velocity field of the body that comes first in the
file to the other's. For flat faces that do not turn it is exact, and nothing is summed for it.)",
     "Given"})
