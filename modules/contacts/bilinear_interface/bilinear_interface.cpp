#include "bilinear_interface.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    contact<mpm::BilinearInterface>,
    {"bilinear_interface", "1.0.0", "Bodies joined by an elastic layer that is stiffer in compression than in tension",
     "Nairn (2013), CMES 92(3):271-299",
     R"(As `linear_interface`, with `tension_stiffness` where the layer is open and `compression_stiffness` where it is
closed. Tension and shear 0 with a large compression is a contact without friction that gives a little: a penalty method
whose step is never too long. Which stiffness a node takes is decided by its opening in the middle of the step, so that a
step in which the layer closes errs by a share that falls with the square of the step.)",
     "BilinearInterface"})
