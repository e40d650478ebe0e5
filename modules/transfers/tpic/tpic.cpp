#include "tpic.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    transfer<mpm::Tpic>,
    {"tpic", "1.0.0", "Taylor particle-in-cell: carries the velocity gradient; needs no second moment to gather",
     "Nakamura, Matsumura & Mizutani (2023), Comput. Methods Appl. Mech. Engrg. 403:115720",
     R"(The particle carries L, the gradient of the velocity field at its place: it gives nodes w m (v + L d), the Taylor
expansion of the field to first order, and takes back v = sum w v+ and L = sum v+ (x) grad w. Affine velocity fields pass
unchanged on any shape that is linearly consistent. No second moment is inverted, so shapes whose second moment is singular or
differs from particle to particle (`linear`, `gimp`, `cpdi`) need nothing special.

On `linear` it is `apic`, since there w D^-1 d = grad w. On other shapes L is not the affine moment C, so angular momentum is kept
to the accuracy of the gradient only: use `apic` where it must be kept to rounding.)",
     "Tpic"})
