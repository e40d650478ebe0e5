#include "newtonian_fluid.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    material<mpm::NewtonianFluid>,
    {"newtonian_fluid", "1.0.0", "Weakly compressible viscous fluid with six equations of state",
     "Monaghan (1994), J. Comput. Phys. 110:399; Murnaghan (1944), PNAS 30:244; Rodgers (1993), J. Appl. "
     "Polym. Sci. 48:1061 (Tait); Meyers (1994), Dynamic Behavior of Materials, ch. 4 and 5 (Mie-Gruneisen); Menikoff "
     "& "
     "Plohr (1989), Rev. Mod. Phys. 61:75 (gases)",
     R"(tau = -p J I + 2 mu J dev(D) + zeta J tr(D) I with mu = `viscosity`, zeta = `bulk_viscosity` and the rate of deformation D.
The pressure p(J), J = density at rest over density, has the modulus K = `bulk_modulus` at rest:

    linear         p = K (1/J - 1)               linear in the density; sound has one speed
    power          p = K/n (J^-n - 1)            Murnaghan; n = `exponent`, 7 for water
    tait           p = K C (exp((1 - J)/C) - 1)  Tait's logarithmic law, C = 0.0894 of polymers; finite at J = 0
    mie_gruneisen  p = K x/(1 - s x)^2, x = 1-J  on the Hugoniot of shocks at c + s u_p; s = `hugoniot_slope`; K (1/J - 1) where J > 1
    stiffened_gas  p = K/g (J^-g - 1)            isentrope; g = `heat_capacity_ratio`, K = g (p0 + p_infinity)
    ideal_gas      p = K/g (J^-g - 1)            isentrope; K = g p0

They agree near J = 1. Pressures are those above the pressure p0 at rest, and depend on J alone: what viscosity turns to heat does not
come back as pressure. A strong shock through a gas so ends too dense (a gas that is heated resists more), and `mie_gruneisen` is
right on its Hugoniot, where shocks end, and has no thermal part beside it: for that take the material `mie_gruneisen`. An ideal gas at one
temperature is `linear` with K = p0.
Gases are for confined use: what lies outside presses with p0 on every free surface.

For flows at speeds up to v take K = density (10 v)^2 or more: the density then varies by 1 %. Real water has K = 2.2 GPa, and the
time step falls with sqrt(K).

State: ln J and the viscous stress of the last step, no deformation gradient. ln J keeps all its digits near J = 1, where liquids
are, in single precision too. D is that of a whole step, sym L + dt L L^T/2, which turns exactly with the frame. The dissipation is
viscous stress : D, never negative, and the energy is minus the integral of p dJ.

`tension`: `kept` lets a fluid that expands pull itself together; `none` has no pressure where J > 1, so that spray parts; J goes on,
and pressure returns when J is below 1 again.

Limits: 1 - s x vanishes at a finite compression. From s x = 0.9 on (J = 0.40 for s = 1.489) the pressure goes on along its tangent.
A run warns of that at its end; /limits/volume_ratio stops it. In single precision J^-n is infinite where n ln J < -87 (J = 4e-6 for n = 7), and the run stops.
J <= 0 is refused: the run stops and names the particle.

Wave speed: z + sqrt(z^2 + c^2) with c^2 = dp/d(density), z = sqrt(3) nu/h, nu = (4 mu/3 + zeta) J/density and the cell size h. With
it a step within the limit of waves is also within that of explicit viscosity, for the largest wave number 2 sqrt(3)/h that a
grid's velocities hold.)",
     "NewtonianFluid"})
