#include "gimp_contiguous.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    shape<mpm::GimpContiguous>,
    {"gimp_contiguous", "1.0.0",
     "cpGIMP: tents averaged over a box that stretches with F along the axes, 4 nodes an axis",
     "Bardenhagen & Kober (2004), CMES 5:477-495; stretch by U: Charlton, Coombs & Augarde (2017), Computers & "
     "Structures "
     "190:108-125",
     R"(`gimp` with a box that is made anew each step from the particle's deformation, along the axes of the grid: half lengths
l_a = l0 |F_aa| (`stretch_by` "deformation_gradient") or l_a = l0 U_aa ("right_stretch", U of F = R U), l0 = 0.5 /
particles_per_cell_axis cells. At F = I it is `gimp`. With N the tent and d the distance to the node in cells

    w = N(d) + e(d + 1) - 2 e(d) + e(d - 1),    e(s) = max(0, l - |s|)^2/(4 l)

Under a stretch along the axes neighbouring boxes stay contiguous, so a bar that is pulled along an axis does not come apart as
with `gimp`. A box cannot shear or turn: see `cpdi` for domains that do. Keep boxes shorter than a cell: a particle moves with
the mean velocity of its box and not with that of its ends, so boxes longer than a cell part from their neighbours where
velocities are not linear, and particles pair up. The bar of lesson 5, stretched by 4, comes back with 4 particles a cell and
axis and tears with 2.

Rotation is where the two differ. The diagonal of F is cos(angle) under a rigid turn: at 90 degrees the box has collapsed to a
point and the shape is `linear`, with its noise at cell faces. U does not see a turn at all. But U lies in the frame of the
undeformed body: a bar that was stretched along x and then turned onto y keeps a box that is long along x.

Four nodes an axis hold boxes of up to two cells, l <= 1: a stretch of 2 x particles_per_cell_axis. A particle beyond that stops
the run, by name, with exit code 3. No wider stencil on purpose: a list of nodes as `cpdi` has would hold any length at several
times the cost of this product of weights along the axes, for boxes that are past their use anyway.

The second moment depends on the box and on the place in the cell, so APIC and MLS-MPM use one a particle, summed from the weights.)",
     "GimpContiguous"})
