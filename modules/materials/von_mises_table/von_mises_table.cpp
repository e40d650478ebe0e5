#include "von_mises_table.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    material<mpm::VonMisesTable>,
    {"von_mises_table", "1.0.0", "Finite-strain J2 plasticity whose yield stress is a table",
     "Simo & Hughes (1998), Computational Inelasticity, box 9.1 (the return); the table is the user's",
     R"(The yield stress runs along straight lines from `yield_stress` at the plastic strain 0 through the points (strain_1, stress_1),
(strain_2, stress_2) and so on, and stays beyond the last. There are as many points as there are strains above 0, up to six. The
stresses are uniaxial and true, on the undeformed volume (Kirchhoff), over the equivalent plastic strain: of a tension test that
kept the volume, force over present area against the logarithm of the stretch less stress/E.

A table whose strains do not grow, or whose stresses fall, is refused. One without points is ideally plastic; with one it is
`von_mises` up to there.

Elasticity, return and state are those of `von_mises`; nothing but the yield stress differs. The plastic strain of a step solves one
equation a particle by Newton's method within a bracket, as in `von_mises_voce`.)",
     "VonMisesTable"})
