#include "linear_interface.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    contact<mpm::LinearInterface>,
    {"linear_interface", "1.0.0", "Bodies joined by an elastic layer without thickness",
     "Nairn (2007), Comput. Mater. Sci. 40:525-536; Hashin (1991), J. Mech. Phys. Solids 39:745-762",
     R"(The traction between two bodies is `normal_stiffness` times their opening along the normal plus `shear_stiffness`
times their slip across it, both counted from where the bodies began: they are joined from the start, and the layer
neither breaks nor slides. At each node the two masses and the spring of the node's area are an oscillator, which is
integrated exactly; where the step is too long for it (k dt^2 > m) it gives way to a weld. Stiffness 0 leaves
the bodies free, a large one is a weld. The energy in the springs is the ledger's row "interface springs".)",
     "LinearInterface"})
