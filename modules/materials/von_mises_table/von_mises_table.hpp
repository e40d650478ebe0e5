#pragma once
// Finite-strain J2 plasticity whose yield stress is a table over the plastic strain, with straight lines between its points. The
// return is that of kernel/j2_plasticity.hpp.

#include "kernel/j2_plasticity.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct VonMisesTable : J2Plasticity {
  static constexpr int points = 6;
  struct Parameters {
    double youngs_modulus, poisson_ratio, density, yield_stress;
    double strain_1, stress_1, strain_2, stress_2, strain_3, stress_3, strain_4, stress_4, strain_5, stress_5, strain_6,
        stress_6;
    double volumetric_energy;
  };
  /// The table's points, from (0, yield_stress) on, and how many lines they make: points follow until a strain is 0.
  struct Table {
    double strain[points + 1], stress[points + 1];
    int lines;
    MPM_HD explicit Table(const Parameters& p)
        : strain{0, p.strain_1, p.strain_2, p.strain_3, p.strain_4, p.strain_5, p.strain_6},
          stress{p.yield_stress, p.stress_1, p.stress_2, p.stress_3, p.stress_4, p.stress_5, p.stress_6},
          lines(0) {
      while (lines < points && strain[lines + 1] > 0) ++lines;
    }
  };
  template <class T>
  MPM_HD static TableHardening<T, points> hardening_of(const Parameters& p) {
    const Table table(p);
    return lines_through<T, points>(table.strain, table.stress, table.lines);
  }
  template <class T>
  struct Constants : J2Constants<T, TableHardening<T, points>> {
    MPM_HD explicit Constants(const Parameters& p) : J2Constants<T, TableHardening<T, points>>(p, hardening_of<T>(p)) {}
  };
  template <int D, class S>
  using State = J2State<D, S>;
  template <class S>
  using AxisymmetricState = J2State<2, S>;

#if MPM_HOST
  static constexpr unsigned traits = MPM_OBJECTIVE | MPM_DISSIPATES;
  static constexpr mpm_dissipation_cause dissipates_by = MPM_PLASTIC_WORK;
  static constexpr mpm_state state[] = {MPM_J2_STATE};
  static constexpr bool projects = true;  ///< an update without strain returns what is beyond the yield surface

  /// Refuses a table whose strains do not grow or whose stresses fall.
  static mpm_refusal refusal(const Parameters& p, const mpm_refusal_case&) {
    constexpr const char* strains[] = {"", "strain_1", "strain_2", "strain_3", "strain_4", "strain_5", "strain_6"};
    constexpr const char* stresses[] = {"", "stress_1", "stress_2", "stress_3", "stress_4", "stress_5", "stress_6"};
    const Table table(p);
    for (int k = 1; k <= table.lines; ++k) {
      if (!(table.strain[k] > table.strain[k - 1]))
        return {strains[k], "the strains of a table grow from point to point; the first point is yield_stress at 0",
                table.strain[k - 1]};
      if (!(table.stress[k] >= table.stress[k - 1]))
        return {stresses[k], "a metal of this law does not soften: the stresses of its table do not fall",
                table.stress[k - 1]};
    }
    return {nullptr, nullptr, 0};
  }

#define MPM_TABLE_POINT(k)                                                                                          \
  MPM_NUMBER_PARAMETER(strain_##k, "", 0.0, 0.0, unbounded, 0, "plastic strain of point " #k "; 0: no such point"), \
      MPM_NUMBER_PARAMETER(stress_##k, "Pa", 0.0, 0.0, unbounded, 0, "uniaxial yield stress (Kirchhoff) of point " #k)
  static constexpr mpm_parameter parameters[] = {
      MPM_NUMBER_PARAMETER(youngs_modulus, "Pa", required, 0.0, unbounded, MPM_ABOVE_MINIMUM,
                           "Young's modulus at small strain"),
      MPM_NUMBER_PARAMETER(poisson_ratio, "", required, -1.0, 0.5, MPM_ABOVE_MINIMUM | MPM_BELOW_MAXIMUM,
                           "Poisson's ratio at small strain"),
      MPM_NUMBER_PARAMETER(density, "kg/m^3", required, 0.0, unbounded, MPM_ABOVE_MINIMUM, "initial density"),
      MPM_NUMBER_PARAMETER(yield_stress, "Pa", required, 0.0, unbounded, MPM_ABOVE_MINIMUM,
                           "initial uniaxial yield stress (Kirchhoff): the point at strain 0"),
      MPM_TABLE_POINT(1),
      MPM_TABLE_POINT(2),
      MPM_TABLE_POINT(3),
      MPM_TABLE_POINT(4),
      MPM_TABLE_POINT(5),
      MPM_TABLE_POINT(6),
      MPM_CHOICE_PARAMETER(volumetric_energy, "logarithmic|quadratic|simo", 2, "u(J), see neo_hookean"),
  };
#undef MPM_TABLE_POINT
#endif
};

}  // namespace mpm
