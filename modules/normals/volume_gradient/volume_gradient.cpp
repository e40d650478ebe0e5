#include "volume_gradient.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    normal<mpm::VolumeGradient>,
    {"volume_gradient", "1.0.0", "The volume gradient of the body that has the larger one at the node",
     "Nairn (2013), CMES - Comput. Model. Eng. Sci. 92:271-299",
     R"(The normal is the unit vector along g_a or along -g_b, g = sum V grad w, whichever is longer: a body that only
touches the node with a corner does not turn it. It is one for the pair, so that momentum is kept.)",
     "VolumeGradient"})
