#include "mass_gradient.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    normal<mpm::MassGradient>,
    {"mass_gradient", "1.0.0", "The difference of both bodies' mass gradients: the denser body decides",
     "Bardenhagen, Brackbill & Sulsky (2000), Comput. Methods Appl. Mech. Engrg. 187:529-541",
     R"(The normal is the unit vector along G_a - G_b, with G = sum m grad w of each body. Between bodies of one density it
is that of `average_volume_gradient`. Of bodies with different densities the denser one decides alone, and where its
gradient is worse than the mean of both, so is the normal.)",
     "MassGradient"})
