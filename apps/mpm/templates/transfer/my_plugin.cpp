#include "my_plugin.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(transfer<mpm::MyPlugin>,
                  {"my_plugin", "0.1.0", "Rigid particle-in-cell: keeps the spin around a particle, damps shear",
                   "Jiang, Schroeder, Selle, Teran & Stomakhin (2015), ACM Trans. Graph. 34(4):51",
                   "The particle gives w m (v + W d) and takes back v = sum w v+ and W, the antisymmetric part of "
                   "C = sum v+ (x) w D^-1 d. Rigid motion passes unchanged; every other motion is damped as by PIC.",
                   "MyPlugin"})
