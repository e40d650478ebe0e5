#include "bspline_quadratic.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    shape<mpm::BsplineQuadratic>,
    {"bspline_quadratic", "1.0.0", "Quadratic B-splines, 3 nodes an axis, C1: no cell-crossing noise",
     "Steffen, Kirby & Berzins (2008), Int. J. Numer. Meth. Engng 76:922-948",
     R"(Weights 3/4 - d^2 for |d| <= 1/2 and (3/2 - |d|)^2/2 up to 3/2 cells. Continuous gradients remove the
cell-crossing noise of tent functions. The second moment is h^2/4 everywhere, so APIC and MLS-MPM need no matrix inverse.

It is the tent convolved with a box one cell wide: uGIMP with that particle size is the same function (Gao et al. 2017).)",
     "BsplineQuadratic"})
