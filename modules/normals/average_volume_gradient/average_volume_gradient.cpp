#include "average_volume_gradient.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    normal<mpm::AverageVolumeGradient>,
    {"average_volume_gradient", "1.0.0", "The mean of both bodies' volume gradients, whatever their densities",
     "Nairn (2013), CMES - Comput. Model. Eng. Sci. 92:271-299",
     R"(The normal is the unit vector along g_a - g_b, with g = sum V grad w of each body. It is one for the pair, so
that momentum is kept, and densities do not turn it. The ends of a body do: there the gradients of both bodies point
around the corner. Where bodies slide, `widest_gap` has no such error.)",
     "AverageVolumeGradient"})
