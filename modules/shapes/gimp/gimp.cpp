#include "gimp.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(shape<mpm::Gimp>,
                  {"gimp", "1.0.0", "uGIMP: tents averaged over the particle's undeformed box, 3 nodes an axis, C1",
                   "Bardenhagen & Kober (2004), CMES 5:477-495",
                   R"(The tent convolved with the box that the particle had at the start, of half length
l = 0.5 / particles_per_cell_axis cells:

    w = 1 - (d^2 + l^2)/(2 l)     |d| < l
    w = 1 - |d|                   l <= |d| <= 1 - l
    w = (1 + l - |d|)^2/(4 l)     1 - l < |d| < 1 + l

with d the distance to the node in cells. The gradient is continuous, so particles cross cells without the jump of `linear`.
At one particle a cell (l = 1/2) it is `bspline_quadratic` to rounding; with more particles it is sharper, and tends to `linear`.
The box does not deform: in a large stretch boxes overlap or part and numerical fracture follows; see `gimp_contiguous` and
`cpdi` for domains that deform.

The second moment depends on the place in the cell, so APIC and MLS-MPM use one a particle, summed from the weights.)",
                   "Gimp"})
