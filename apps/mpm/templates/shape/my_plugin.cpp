#include "my_plugin.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(shape<mpm::MyPlugin>,
                  {"my_plugin", "0.1.0", "Quadratic B-splines, 3 nodes an axis, C1",
                   "Steffen, Kirby & Berzins (2008), Int. J. Numer. Meth. Engng 76:922-948, eq. 26",
                   "N(d) = 3/4 - d^2 within half a cell, (3/2 - |d|)^2 / 2 up to one and a half. Its gradient is "
                   "continuous, so particles cross cells without a kick.",
                   "MyPlugin"})
