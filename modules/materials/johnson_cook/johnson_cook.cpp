#include "johnson_cook.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    material<mpm::JohnsonCook>,
    {"johnson_cook", "1.0.0", "Finite-strain J2 plasticity, flow stress by strain, rate and temperature (Johnson-Cook)",
     "Johnson & Cook (1983), A constitutive model and data for metals subjected to large strains, high strain rates "
     "and "
     "high temperatures, Proc. 7th Int. Symp. on Ballistics, 541; the return: Simo & Hughes (1998), Computational "
     "Inelasticity, box 9.1",
     R"(The flow stress at the equivalent plastic strain alpha, its rate and the temperature T is

    sigma = (A + B alpha^n) (1 + C ln(rate/rate_0)) (1 - T*^m),   T* = (T - T_room)/(T_melt - T_room)

with A = `yield_stress`, B = `hardening_coefficient`, n = `hardening_exponent`, C = `rate_coefficient`, rate_0 = `reference_rate`, m =
`thermal_exponent`. T* is kept within 0 and 1, and rates below rate_0 count as rate_0 (the logarithm would soften without bound).
A run warns once of particles beyond either bound of T*, and not of the rate's, below which whatever is slow lies.
The paper's OFHC copper: 90 MPa, 292 MPa, 0.31, 0.025, 1/s, 1.09, melting at 1356 K; 4340 steel: 792 MPa, 510 MPa, 0.26, 0.014,
1/s, 1.03, 1793 K.

T is the particle's temperature in scenes with `thermal` materials; `dissipation_to_heat` there heats what flows. Scenes without
have 293.15 K everywhere.

The rate is that of the step, so that a state has no yield surface of its own: a projection is not offered.

Elasticity, return and state are those of `von_mises`; nothing but the yield stress differs. The plastic strain of a step
solves one equation a particle by Newton's method, which a bracket around the root keeps from running away: about six evaluations of
the law. A particle that does not yield costs one.)",
     "JohnsonCook"})
