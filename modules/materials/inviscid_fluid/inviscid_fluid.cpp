#include "inviscid_fluid.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    material<mpm::InviscidFluid>,
    {"inviscid_fluid", "1.0.0", "Weakly compressible fluid without viscosity, the cheapest of the laws",
     "Monaghan (1994), J. Comput. Phys. 110:399; Batchelor (1967), An Introduction to Fluid Dynamics, sec. 1.6",
     R"(tau = -p J I with the pressure p = K (1/J - 1), linear in the density: K = `bulk_modulus`, J = density at rest over density.
Sound has the one speed sqrt(K/density). The energy is K (J - 1 - ln J) per initial volume, and nothing is dissipated.

That is `newtonian_fluid` with `"equation_of_state": "linear"` and no viscosity, at less than half of its state and arithmetic: the
Kirchhoff stress K (J - 1) is linear in what the law keeps. With another equation of state, or with viscosity, take `newtonian_fluid`;
with shocks add `artificial_viscosity`.

For flows at speeds up to v take K = density (10 v)^2 or more: the density then varies by 1 %. Real water has K = 2.2 GPa, and the
time step falls with sqrt(K).

State: J - 1 alone, which keeps all its digits near J = 1, where liquids are. Shear strains nothing and meets no resistance: swirls
that the grid cannot hold are damped by the transfer alone (`apic` and `pic` do, `flip` does not).

`tension`: `kept` lets a fluid that expands pull itself together, by at most K; `none` has no pressure where J > 1, so that spray
parts; J goes on, and pressure returns when J is below 1 again.

Limits: J <= 0 is refused: the run stops and names the particle. Crushed to J = 0.001 the law keeps four digits of J in single
precision, and at J = 1e-6 one (of the stress all, which hardly changes there); newtonian_fluid keeps them all.)",
     "InviscidFluid"})
