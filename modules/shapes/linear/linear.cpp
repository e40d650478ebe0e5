#include "linear.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(shape<mpm::Linear>,
                  {"linear", "1.0.0", "Tent functions, 2 nodes an axis, C0; cell-crossing noise is expected",
                   "Sulsky, Chen & Schreyer (1994), Comput. Methods Appl. Mech. Engrg. 118:179-196",
                   R"(Weights N(d) = 1 - |d| within one cell. The cheapest shape and the first of the method.

The gradient is constant in a cell and jumps at its faces: a particle that crosses one changes the force on the nodes at once
("cell-crossing noise"), so convergence stalls when particles cross cells. Lesson 2 shows it.

The second moment f(1-f)h^2 vanishes at nodes, but the affine moment of APIC and MLS-MPM stays finite, since
w D^-1 d = grad w for these weights: on this shape MLS-MPM and APIC coincide.)",
                   "Linear"})
