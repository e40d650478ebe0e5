#include "hencky.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    material<mpm::Hencky>,
    {"hencky", "1.0.0", "St. Venant-Kirchhoff solid with Hencky's logarithmic strain",
     "Hencky (1928), Ueber die Form des Elastizitaetsgesetzes bei ideal elastischen Stoffen, Z. techn. "
     "Physik 9:215; Anand (1979), On H. Hencky's approximate strain-energy function, J. Appl. Mech. 46:78",
     R"(psi = mu eps:eps + lambda/2 tr(eps)^2, eps = ln V the logarithm of the left stretch;

    tau = 2 mu eps + lambda tr(eps) I

In principal directions tau_i = 2 mu ln s_i + lambda ln J: Hooke's law of the logarithms of the stretches s_i, so that stretches by
s and 1/s have opposite Kirchhoff stresses, ln J = tr eps is the change of volume alone, and uniaxial stress gives tau = E ln s with
s^-nu across. The elastic law of `drucker_prager`, and of metals at moderate strains.

It softens where it is stretched: Cauchy stress of a uniaxial strain is largest where ln s = 1, beyond which waves along the stretch
have no speed (the tangent lambda + 2 mu - tau_i is negative) and strains localise. Energy grows without bound as J -> 0, as (ln J)^2 does,
slowly: J <= 0 is refused, and the run stops and names the particle.

Wave speed: sqrt((max(lambda + 2 mu - tau_min, mu (x + sqrt(1 + x^2))) + mu/2 x^2/(1 + x))/rho0), tau_min the least principal stress
and x the largest difference of principal strains: the fastest wave along a principal axis, and what one askew of them can add.)",
     "Hencky"})
