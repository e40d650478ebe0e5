#include "newtonian_fluid.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    material<mpm::NewtonianFluid>,
    {"newtonian_fluid", "1.0.0", "Weakly compressible viscous fluid with three equations of state",
     "Monaghan (1994), J. Comput. Phys. 110, 399-406; Murnaghan (1944), PNAS 30, 244-247; Macdonald (1966), Rev. Mod. "
     "Phys. "
     "38, 669-679",
     R"(tau = -p J I + 2 mu J dev(D) + zeta J tr(D) I with mu = `viscosity`, zeta = `bulk_viscosity` and the rate of deformation D.
The pressure p(J) has the modulus K = `bulk_modulus` at rest:

    linear   p = K (1/J - 1)                     linear in the density; sound has one speed
    power    p = K/n (J^-n - 1)                  Murnaghan; n = `exponent`, 7 for water (Monaghan 1994)
    tait     p = K C (exp((1 - J)/C) - 1)        logarithmic law of Tait, C = 0.0894 of water; finite at J = 0

They agree near J = 1. For flows at speeds up to v take K = density (10 v)^2 or more: the density then varies by 1 %. State: J and
the viscous stress of the last step, no deformation gradient. D is that of a whole step, sym L + dt L L^T/2, which turns exactly
with the frame. Dissipation is that of D, never negative. `tension`: `kept` lets a fluid that expands pull itself together; `none`
cuts the pressure off at zero where J > 1, so that spray parts; J goes on, and pressure returns when J is below 1 again.

Wave speed: nu/h + sqrt((nu/h)^2 + c^2) with c^2 = dp/d(density), nu = (4 mu/3 + zeta) J/density and the cell size h. With it a
step within the limit of waves is also within that of explicit viscosity: on a line, where a wave changes sign from cell to cell,
(c dt/h)^2 + 2 nu dt/h^2 = 1.)",
     "NewtonianFluid"})
