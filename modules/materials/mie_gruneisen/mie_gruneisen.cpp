#include "mie_gruneisen.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    material<mpm::MieGruneisen>,
    {"mie_gruneisen", "1.0.0", "Solid or liquid under shocks, whose heat presses: Mie-Gruneisen with internal energy",
     "Meyers (1994), Dynamic Behavior of Materials, ch. 4 and 5; Menikoff & Plohr (1989), Rev. Mod. Phys. 61:75; von "
     "Neumann & Richtmyer (1950), J. Appl. Phys. 21:232; Landshoff (1955), Los Alamos report LA-1930 (artificial "
     "viscosity)",
     R"(tau = -J (p + q) I with x = 1 - J, J = density at rest over density, and E the internal energy per volume at rest:

    p = p_H(x) (1 - G x/2) + G E,    p_H = K x/(1 - s x)^2

p_H is the pressure behind a shock that runs with c + s u_p into the material at rest: K = `bulk_modulus` = density c^2, s =
`hugoniot_slope`, u_p the velocity behind it. There E = p_H x/2, and p = p_H whatever G = `gruneisen_parameter` is. Density times
Gruneisen's parameter is taken for constant. `newtonian_fluid` with the `equation_of_state` of this name has p = p_H everywhere: right
where one shock ends in a material at rest. This law is also right where it is shocked twice, and where it is released: at constant
entropy p falls faster, and the material comes back to no pressure hot and thinner than it was.

Where J > 1 Gruneisen's parameter itself is constant and the cold pressure linear in the density, p = K (1/J - 1) + G E/J: a stiffened
gas, which bears a tension of K/(1 + G) at most where it is torn from rest. `tension` `none` leaves the first term out, so that nothing but
heat presses there, and spray parts. There is no strength, and no viscosity but the artificial one:

    q = rho (C2 h^2 d^2 + C1 h c |d|)   where the material is compressed, else 0

with the rate d of ln J, the speed of sound c, the cell size h, C2 = `quadratic_viscosity` and C1 = `linear_viscosity`, as in
`ideal_gas`. It spreads a shock over three to five cells and gives it the heat that the jump conditions ask for. With both 0
a shock rings and heats nothing.

State: ln J, E, and J q of the last step. Without q a step adds the work of p to E, which p depends on: by a closed form where J > 1, and
by three points of Gauss where J < 1. One step from rest to J = 0.9 has E to 1e-7, and one from 0.5 to 0.4, next to the clamp, to
5e-4. A way there and back gives E back. E is the stored energy: nothing is
dissipated, as the work of q stays in the material as heat. Heat does not flow.

Limits: 1 - s x vanishes at a finite compression. From s x = 0.9 on (J = 0.40 for s = 1.489) the cold pressure goes on along its
tangent. A run warns of that at its end; /limits/volume_ratio stops it. G of 2.11 s or more is refused: cold pressure would fall before
that. J <= 0 is refused: the run stops and names the particle.

Wave speed: z + sqrt(z^2 + c^2), z = sqrt(3) nu/h, with c^2 = dp/d(density) at constant entropy and nu the slope of q/rho by the rate in
the last step, as for `ideal_gas`: where plates meet, courant 0.3 or less leaves room for the rate of the next step.)",
     "MieGruneisen"})
