#include "bspline_cubic.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    shape<mpm::BsplineCubic>,
    {"bspline_cubic", "1.0.0", "Cubic B-splines, 4 nodes an axis, C2: the smoothest field, at the widest stencil",
     "Steffen, Kirby & Berzins (2008), Int. J. Numer. Meth. Engng 76:922-948",
     R"(Weights |d|^3/2 - d^2 + 2/3 for |d| <= 1 and (2 - |d|)^3/6 up to 2 cells. Not only the gradient is continuous, as
with `bspline_quadratic`, but its slope too: a particle that crosses a cell changes forces without a kink, and a wave of a few
cells meets less quadrature error.

The second moment is h^2/3 everywhere, so APIC and MLS-MPM need no matrix inverse.

Price: 64 nodes a particle in 3-D instead of 27 (16 instead of 9 in 2-D); `mpm bench options` prints it as time. Bodies feel each
other from farther away, and PIC damps more a step. The largest stable step of a lattice with one particle a cell is 1.37 instead
of 0.71 Courant numbers with particles at cell centres (FLIP, stress last), and 1.60 instead of 1.67 with particles on nodes.)",
     "BsplineCubic"})
