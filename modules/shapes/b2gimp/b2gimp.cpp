#include "b2gimp.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    shape<mpm::B2Gimp>,
    {"b2gimp", "1.0.0", "B2GIMP: quadratic B-splines averaged over the particle's undeformed box, 4 nodes an axis, C2",
     "Bardenhagen & Kober (2004), CMES 5:477-495, over the splines of Steffen, Kirby & Berzins (2008), "
     "Int. J. Numer. Meth. Engng 76:922-948",
     R"(What `gimp` does to tents, done to quadratic B-splines N: the mean over the box that the particle had at the start, of half
length l = 0.5 / particles_per_cell_axis cells.

    w = 1/(2 l) integral of N(d + s) over |s| < l

A box inside one piece of the spline takes N + N'' l^2/6; one that straddles the middle of a cell takes a multiple of the cube of
its overlap beside. Both the spline and the box smooth, so the gradient's slope is continuous too.

Limits: `bspline_quadratic` as l -> 0, that is with many particles a cell, and `bspline_cubic` at one particle a cell (l = 1/2),
where the box is the one that a further convolution of the B-spline takes. Compared with `bspline_quadratic`, rows of particles
sum more evenly over a node.

The second moment is h^2 (1/4 + (l/h)^2/3) wherever the particle lies; since it depends on the box it is summed a particle.

The box does not deform: see `gimp_contiguous` and `cpdi` for domains that do.)",
     "B2Gimp"})
