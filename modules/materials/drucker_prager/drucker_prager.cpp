#include "drucker_prager.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    material<mpm::DruckerPrager>,
    {"drucker_prager", "1.0.0", "Sand: Hencky elasticity, Drucker-Prager cone with cohesion, flow at constant volume",
     "Klar, Gast, Pradhana, Fu, Schroeder, Jiang & Teran (2016), ACM Trans. Graph. 35(4):103",
     R"(tau = 2 mu eps + lambda tr(eps) I, eps the elastic Hencky strain (logarithms of the singular values of F_e). Yield:

    |dev eps| <= alpha (3 lambda + 2 mu)/(2 mu) (t - tr eps),   alpha = sqrt(2/3) 2 sin phi/(3 - sin phi)

with phi = `friction_angle` and t = c cot(phi)/K, c = `cohesion`, the volumetric strain at the tip of the cone. In stresses
q = M p + k with M = 6 sin phi/(3 - sin phi) and k = 6 c cos phi/(3 - sin phi), which meets Mohr-Coulomb in triaxial compression.
The cone is that of three-dimensional space also in 2-D, where elastic zz is kept.

Flow is not associated: the return keeps tr(eps), so shearing neither dilates nor compacts. Beyond the tip the state returns to the
tip: dry sand then carries no stress. Dissipation is tau:(eps_trial - eps) with tau after the return, never negative.

`volume_correction`: returning to the tip forgets how far the sand parted, so without correction pressure returns as soon as it is
compressed again and the sand seems to grow. With it the elastic volume is read from the total J: after opening, elastic tension
unloads first, then there is no pressure until J is below 1 again, and from there on the elastic volumetric strain is ln J. Dry
sand so has tr(eps) = min(ln J, 0) always.

Wave speed: sqrt((lambda + 2 mu + a - least principal stress)/density), never below the shear wave's. On the cone a wave that takes
pressure off takes strength off too, so it may outrun the elastic wave: a is the most that this can add (16 % of lambda + 2 mu at 30
degrees and a Poisson's ratio of 0.3).)",
     "DruckerPrager"})
