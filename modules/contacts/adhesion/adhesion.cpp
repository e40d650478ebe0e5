#include "adhesion.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    contact<mpm::Adhesion>,
    {"adhesion", "1.0.0", "bodies hold together within an ellipse of normal and shear strength",
     "Nairn (2013), CMES 92:271-299 (imperfect interfaces and adhesion)",
     R"(Bodies that lie within `reach` of one another move as one while (t_n / `normal_strength`)^2 + (t_s / `shear_strength`)^2
is below 1. t_n is the tension and t_s the shear that would hold them together through the step: what a weld would give
at the nodes up to two cells around, over the area of these nodes. Compression never parts them. Beyond the ellipse, and
before the forces, they part, or meet with `friction`. The law has no memory: bodies that come to rest beside one another
hold again.)",
     "Adhesion"})
