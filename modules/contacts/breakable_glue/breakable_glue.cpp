#include "breakable_glue.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    contact<mpm::BreakableGlue>,
    {"breakable_glue", "1.0.0", "Bodies glued by an elastic layer that breaks once and for all",
     "Nairn (2013), CMES 92(3):271-299 (imperfect interfaces, and the ellipse of adhesion)",
     R"(Bodies that begin within `reach` of one another are joined by a layer as of `bilinear_interface`: tractions t_n and t_s
by opening and slip, `compression_stiffness` where the layer is closed. Where (t_n / `normal_strength`)^2 + (t_s /
`shear_strength`)^2 reaches 1, t_n in tension alone, the layer breaks, and never holds again: particles keep the share of
their glue that has broken, and a node holds while less than half of it is, and up to twice its own strength. Broken glue,
and bodies that began apart, meet with `friction`. An area gives up `normal_strength`^2 / (2 `tension_stiffness`) when it
is pulled off, and `shear_strength`^2 / (2 `shear_stiffness`) when it is sheared off, which leaves the ledger's row
"interface springs" for "friction". Automatic steps are short enough for the stiffest of the three; a longer fixed one is
refused, and so are more than two velocity fields. Take layers that are soft beside a cell, k h < E / 10: in stiffer ones the rows of nodes that a face is spread
over open unlike.)",
     "BreakableGlue"})
