#include "own_gradient.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    normal<mpm::OwnGradient>,
    {"own_gradient", "1.0.0", "A normal for each body, from its own gradient: momentum is not kept",
     "Bardenhagen, Brackbill & Sulsky (2000), Comput. Methods Appl. Mech. Engrg. 187:529-541",
     R"(Each body is struck along the unit vector of its own gradient, as the law says for that normal. Where the two
normals are not opposite, what one body gains is not what the other loses: `contact.momentum_residual` in `summary.json`
says by how much in the last step. Kept for teaching; the reason why every other normal is one for the pair.)",
     "OwnGradient"})
