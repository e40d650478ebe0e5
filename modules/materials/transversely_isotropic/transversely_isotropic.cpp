#include "transversely_isotropic.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    material<mpm::TransverselyIsotropic>,
    {"transversely_isotropic", "1.0.0", "St. Venant-Kirchhoff solid with an axis: wood, fibres, layered rock",
     "Spencer (1984), Constitutive theory for strongly anisotropic solids, CISM 282; Bonet & Burton (1998), A simple "
     "orthotropic, transversely isotropic hyperelastic constitutive equation, Comput. Methods Appl. Mech. Engrg. "
     "162:151; "
     "the constants: Lekhnitskii (1963), Theory of Elasticity of an Anisotropic Elastic Body",
     R"(S = C E with Green's strain E = (F^T F - I)/2, tau = F S F^T, psi = E:C:E/2. In the frame of the axis (3) the compliance is

    E33 = S33/E_a - nu_a (S11 + S22)/E_a                  2 E23 = S23/G_a
    E11 = S11/E_t - nu_t S22/E_t - nu_a S33/E_a           2 E12 = S12 2 (1 + nu_t)/E_t

The axis (`axis_x`, `axis_y`, `axis_z`, of any length) is that of the undeformed solid, and turns and shears with it. It is one for
all particles of the material: a body with a bent grain is several bodies.

The constants need a positive definite stiffness: nu_a^2 < (1 - nu_t)/2 E_a/E_t, -1 < nu_t < 1. Others are refused. With E_a = E_t = E,
nu_a = nu_t = nu and G_a = E/(2 (1 + nu)) it is the isotropic St. Venant-Kirchhoff solid.

For small strains and large rotations. Pressed by much it softens, as Green's strain ends at -1/2: of a bar pressed along its length
the stress is largest at 1/sqrt(3) of it, beyond which it collapses; the energy at J = 0 is finite. J <= 0 is refused: the run stops
and names the particle. For large strains of isotropic solids see `hencky` and `neo_hookean`.

2-D: the axis lies in the plane or across it; another is refused, as it would shear the plane out of itself. In axisymmetric scenes it
is in the plane of radius and axis (a cone of fibres), or goes around (hoops).

Waves at rest: along the axis sqrt(C33/rho) and sqrt(G_a/rho), across it sqrt(C11/rho), sqrt(G_a/rho) and sqrt(E_t/(2 (1 + nu_t) rho)).

Wave speed: sqrt((C s^4 + max(tau, 0))/rho0), C the largest modulus of a wave at rest in any direction, s the largest stretch and tau
the largest principal stress.)",
     "TransverselyIsotropic"})
