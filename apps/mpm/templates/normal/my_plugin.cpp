#include "my_plugin.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    normal<mpm::MyPlugin>,
    {"my_plugin", "0.1.0", "Between the mean of both volume gradients and the larger one",
     "Nairn (2013), CMES - Comput. Model. Eng. Sci. 92:271-299",
     "The normal is the unit vector along |g_a|^(p-1) g_a - |g_b|^(p-1) g_b with the volume gradients g of "
     "both bodies: p = 1 is their mean, and with a high p the larger one decides alone.",
     "MyPlugin"})
