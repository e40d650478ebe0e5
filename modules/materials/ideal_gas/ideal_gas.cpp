#include "ideal_gas.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    material<mpm::IdealGas>,
    {"ideal_gas", "1.0.0", "Ideal gas that shocks heat, with artificial viscosity",
     "von Neumann & Richtmyer (1950), J. Appl. Phys. 21:232; Landshoff (1955), Los Alamos report LA-1930 (artificial "
     "viscosity); Courant & Friedrichs (1948), Supersonic Flow and Shock Waves (the gas)",
     R"(tau = -J (p - p0 + q) I with p = (g - 1) rho e: g = `heat_capacity_ratio`, rho the density, e the internal energy per mass.

At constant entropy p J^g = p0, as `newtonian_fluid` has with `ideal_gas`. Here the work of q stays in the gas as heat, and p J^g =
p0 (1 + a) grows: a strong shock makes a gas denser by (g + 1)/(g - 1) at most, 6 for air, however strong it is.

    q = rho (C2 h^2 d^2 + C1 h c |d|)   where the gas is compressed, else 0

is the artificial viscosity: d = rate of ln J, c = speed of sound, h = cell size, C2 = `quadratic_viscosity`, C1 =
`linear_viscosity`. It spreads a shock over three to five cells, and gives it the entropy that the jump conditions ask for. With
both 0 a gas rings behind its shocks and gets no heat at all.

Pressures are those above p0, which the surroundings of the body have too: a free surface is pressed by p0, and the force on a
wall is that beyond p0. Two gases that meet, as in a shock tube, must have one p0: give a gas of another state the density
that it has after it was brought to p0 without heat, rho (p0/p)^(1/g), and the body an `initial_displacement` that makes it as dense
as it is. There is no vacuum around a gas: gaps that open in it are at p0, and a gas that is torn, whose pressure falls to
nothing, is pulled together by p0. A run warns of gas that expands through a free surface, and of two gases that meet.

Heat does not flow, and there is no shear viscosity: `newtonian_fluid` has one.

State: ln J, a, and J q of the last step. A step without q is exact, however long. The stored energy is the internal energy above that
at rest less the work of p0 on the volume, p0 ((1 + a) J^(1-g) - 1)/(g - 1) + p0 (J - 1): never negative, and with the heat. So nothing
is dissipated, and a never falls.

Limits: J <= 0 is refused: the run stops and names the particle. In single precision J^-g is infinite where g ln J < -88.

Wave speed: z + sqrt(z^2 + c^2), z = sqrt(3) nu/h, with nu the slope of q/rho by the rate in the last step, as for `newtonian_fluid`: at rest
2.2 c with the default of C1, c without it. A step does not know how fast the next one compresses: where gas is thrown at a wall, courant 0.3 or less leaves room for it.)",
     "IdealGas"})
