#include "my_plugin.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(contact<mpm::MyPlugin>,
                  {"my_plugin", "0.1.0", "Coulomb friction up to a shear strength",
                   "Orowan (1943), Proc. Inst. Mech. Eng. 150:140-167; Bardenhagen, Brackbill & Sulsky (2000)",
                   "Normal velocities become equal where surfaces touch and press; the tangential impulse is that of "
                   "sticking, at most mu times the normal impulse and at most the shear strength times area and step.",
                   "MyPlugin"})
