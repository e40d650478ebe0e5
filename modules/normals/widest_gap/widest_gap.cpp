#include "widest_gap.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    normal<mpm::WidestGap>,
    {"widest_gap", "1.0.0", "Across the widest gap between the particles of both bodies: right at corners too",
     "Cortes & Vapnik (1995), Mach. Learn. 20:273-297; nearest points: Gilbert, Johnson & Keerthi (1988), IEEE J. "
     "Robot. "
     "Autom. 4:193-203",
     R"(The normal joins the nearest points of the convex hulls of the particles that the node sees of each body. The ends
of a body do not tilt it, so it is the one to take where bodies slide. Where no plane parts the particles, it is that of
`average_volume_gradient`.)",
     "WidestGap"})
