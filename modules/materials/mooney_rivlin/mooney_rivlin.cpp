#include "mooney_rivlin.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(material<mpm::MooneyRivlin>,
                  {"mooney_rivlin", "1.0.0",
                   "Mooney-Rivlin rubber, isochoric-volumetric split, three volumetric energies",
                   "Mooney (1940), A theory of large elastic deformation, J. Appl. Phys. 11:582; Rivlin (1948), Phil. "
                   "Trans. R. Soc. A 241:379; the split: Simo & Hughes (1998), Computational Inelasticity, sec. 9.2",
                   R"(psi = C10 (I1 - 3) + C01 (I2 - 3) + K u(J), I1 and I2 the invariants of J^-2/3 b:

    tau = dev(2 C10 J^-2/3 b - 2 C01 J^2/3 b^-1) + K J u' I

Small-strain moduli are mu = 2 (C10 + C01) and K. Where the volume stays, uniaxial stress is 2 (s^2 - 1/s)(C10 + C01/s) at the
stretch s, and simple shear gives 2 (C10 + C01) gamma. C01 = 0 is the split form of `neo_hookean`. u(J) as there; `simo` is stiff at
both ends. J <= 0 is refused: the run stops and names the particle.

Rubber has K a thousand times mu or more, and the time step falls with sqrt(K): take as little as the question needs.

Wave speed: that of the split Neo-Hookean solid with mu = 2 C10, and 2 C01 (5/3 i - I2/9) more in rho0 c^2, i an upper bound of
J^2/3 b^-1's largest principal value: exact at rest, sqrt((K + 4/3 mu)/rho0).)",
                   "MooneyRivlin"})
