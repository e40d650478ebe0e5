#include "my_plugin.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(filter<mpm::MyPlugin>,
                  {"my_plugin", "0.1.0", "FMPM(m): the full mass matrix by a series of m terms",
                   "Nairn & Hammerquist (2021), Comput. Methods Appl. Mech. Engrg. 377:113667",
                   "v <- sum over k < order of (I - S+ S)^k v, applied to the velocity after the forces. It takes out "
                   "the damping of PIC without the noise of FLIP.",
                   "MyPlugin"})
