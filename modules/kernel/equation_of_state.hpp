#pragma once
// Pressures p(J) of fluids that depend on J = density at rest over density alone, with the energies that they store and
// their wave speeds. All have p(1) = 0 and the bulk modulus K at J = 1. Fluids keep ln J: a liquid is compressed by
// thousandths, of which J in single precision would keep four digits, and no step can make J negative by rounding.

#include "kernel/tensor.hpp"

namespace mpm {

enum class EquationOfState {
  linear = 0,         ///< p = K (1/J - 1), linear in the density
  power = 1,          ///< p = K/n (J^-n - 1): Murnaghan (1944), PNAS 30:244; with n = 7 water of Cole and Monaghan
  tait = 2,           ///< p = K C (exp((1 - J)/C) - 1): Tait's logarithmic law J = 1 - C ln(1 + p/(K C)) solved for p
  mie_gruneisen = 3,  ///< p = K x/(1 - s x)^2 with x = 1 - J, that of Mie-Gruneisen on its Hugoniot; linear where J > 1
  stiffened_gas = 4,  ///< p = K/g (J^-g - 1), the isentrope; K = g (p0 + p_infinity)
  ideal_gas = 5       ///< p = K/g (J^-g - 1), the isentrope; K = g p0
};

/// C of Tait's law, a pure number that nearly all polymers share (Rodgers 1993, J. Appl. Polym. Sci. 48:1061).
inline constexpr double tait_constant = 0.0894;
/// s x beyond which mie_gruneisen goes on along its tangent: 1 - s x vanishes at 1, and p with it is infinite.
inline constexpr double mie_gruneisen_reach = 0.9;

/// The sum of x^k/(k+2)! over k, which is (e^x - 1 - x)/x^2, to rounding for |x| <= 1/2.
template <class S>
MPM_HD S exponential_series(const S& x) {
  constexpr int terms = sizeof(scalar_of<S>) == sizeof(float) ? 7 : 13;
  S sum = S(real<S>(1));
  for (int k = terms; k > 0; --k) sum = real<S>(1) + x * sum * real<S>(1.0 / (k + 2));
  return real<S>(0.5) * sum;
}

/// e^x - 1 to a relative rounding error, also where x is small.
template <class S>
MPM_HD S exponential_change(const S& x) {
  return select(abs(x) < real<S>(0.5), x + x * x * exponential_series(x), exp(x) - real<S>(1));
}

/// e^x - 1 - x, which is never negative, to a relative rounding error.
template <class S>
MPM_HD S exponential_excess(const S& x) {
  return select(abs(x) < real<S>(0.5), x * x * exponential_series(x), exp(x) - real<S>(1) - x);
}

/// ln(1 + x) to a relative rounding error: the logarithm of the rounded sum, and what the sum lost by rounding.
template <class S>
MPM_HD S log_of_change(const S& x) {
  const S sum = real<S>(1) + x;
  return log(sum) + (x - (sum - real<S>(1))) / sum;
}

/// det(I + dt L) - 1, the change of volume in a step over the volume before it, without the rounding of a difference.
template <class S>
MPM_HD S volume_change(const Mat<2, S>& L, scalar_of<S> dt) {
  return dt * (L(0, 0) + L(1, 1) + dt * determinant(L));
}
template <class S>
MPM_HD S volume_change(const Mat<3, S>& L, scalar_of<S> dt) {
  const S minors = L(0, 0) * L(1, 1) - L(0, 1) * L(1, 0) + (L(1, 1) * L(2, 2) - L(1, 2) * L(2, 1)) +
                   (L(0, 0) * L(2, 2) - L(0, 2) * L(2, 0));
  return dt * (L(0, 0) + L(1, 1) + L(2, 2) + dt * (minors + dt * determinant(L)));
}
template <class S>
MPM_HD S volume_change(const Deformation<2, S>& L, scalar_of<S> dt) {
  const S plane = volume_change(L.plane, dt), around = dt * L.zz;
  return plane + around + plane * around;
}

/// The pressures of shocks that run at c + s u_p into a material at rest, u_p being the velocity behind them, over its bulk
/// modulus: x/(1 - s x)^2 with the compression x = 1 - J, and beyond s x = mie_gruneisen_reach the tangent there. Meyers
/// (1994), Dynamic Behavior of Materials, ch. 4.
template <class T>
struct ShockHugoniot {
  T slope;  ///< s

  /// A compression up to the largest for which the formula stands, and what is beyond. There is none where J > 1.
  template <class S>
  struct Compression {
    S within, beyond;
  };
  template <class S>
  MPM_HD Compression<S> compression(const S& x) const {
    const S whole = max(x, S(real<S>(0))), within = min(whole, S(last()));
    return {within, whole - within};
  }
  MPM_HD T last() const { return T(mie_gruneisen_reach) / slope; }

  /// The pressure, and its derivative by x, at a compression for which the formula stands.
  template <class S>
  MPM_HD S pressure(const S& within) const {
    const S left = real<S>(1) - slope * within;
    return within / (left * left);
  }
  template <class S>
  MPM_HD S tangent(const S& within) const {
    const S stretched = slope * within, left = real<S>(1) - stretched;
    return (real<S>(1) + stretched) / (left * left * left);
  }
  MPM_HD T last_pressure() const { return T(mie_gruneisen_reach / (remains * remains)) / slope; }
  MPM_HD static T last_tangent() { return T((1 + mie_gruneisen_reach) / (remains * remains * remains)); }

 private:
  static constexpr double remains = 1 - mie_gruneisen_reach;
};

/// A barotropic fluid. `l` is ln J everywhere.
template <class T>
struct Barotropic {
  T modulus;                  ///< K, Pa
  T exponent;                 ///< n of `power`, the ratio of heat capacities of the gases
  ShockHugoniot<T> hugoniot;  ///< of mie_gruneisen
  EquationOfState form;
  bool parts;  ///< there is no tension: where J > 1 there is no pressure

  /// From the parameters of a material that has the rows MPM_EQUATION_OF_STATE_PARAMETERS.
  template <class Parameters>
  MPM_HD explicit Barotropic(const Parameters& p)
      : modulus(T(p.bulk_modulus)),
        exponent(T(p.exponent)),
        hugoniot{T(p.hugoniot_slope)},
        form(static_cast<EquationOfState>(static_cast<int>(p.equation_of_state))),
        parts(p.tension != 0) {
    if (form == EquationOfState::stiffened_gas || form == EquationOfState::ideal_gas)
      exponent = T(p.heat_capacity_ratio);
  }

  /// The part of ln J that the equation of state sees.
  template <class S>
  MPM_HD S felt(const S& l) const {
    return parts ? min(l, S(real<S>(0))) : l;
  }

  /// J p, Pa: the Kirchhoff pressure, positive in compression.
  template <class S>
  MPM_HD S kirchhoff_pressure(const S& log_volume_ratio) const {
    const S l = felt(log_volume_ratio), change = exponential_change(l);
    if (form == EquationOfState::linear) return -(modulus * change);
    const S J = exp(l);
    if (form == EquationOfState::tait) {
      const T C = T(tait_constant);
      return modulus * C * (J * exponential_change(-change / C));
    }
    if (form == EquationOfState::mie_gruneisen) {
      const auto x = hugoniot.compression(S(-change));
      return modulus * select(change < real<S>(0),
                              J * (hugoniot.pressure(x.within) + hugoniot.last_tangent() * x.beyond), -change);
    }
    return modulus / exponent * (exp(l) * exponential_change(-(exponent * l)));
  }

  /// The energy stored per initial volume, J/m^3: minus the integral of p from 1 to J.
  template <class S>
  MPM_HD S energy(const S& log_volume_ratio) const {
    const S l = felt(log_volume_ratio);
    if (form == EquationOfState::linear) return modulus * exponential_excess(l);
    if (form == EquationOfState::tait) {
      const T C = T(tait_constant);
      return modulus * C * C * exponential_excess(-exponential_change(l) / C);
    }
    if (form == EquationOfState::mie_gruneisen) {
      const auto x = hugoniot.compression(S(-exponential_change(l)));
      const T s = hugoniot.slope;
      const S within = exponential_excess(-log_of_change(-(s * x.within))) / (s * s);
      const S beyond = x.beyond * (hugoniot.last_pressure() + real<S>(0.5) * hugoniot.last_tangent() * x.beyond);
      return modulus * select(l < real<S>(0), within + beyond, exponential_excess(l));
    }
    const T less = exponent - T(1);
    return modulus / exponent * (exponential_excess(-(less * l)) / less + exponential_excess(l));
  }

  /// Initial density times the square of the speed that waves have at most; far from vanishing where a fluid that is torn
  /// to J = 1000 holds on by nothing.
  template <class S>
  MPM_HD S wave_modulus(const S& log_volume_ratio) const {
    return max(tangent(log_volume_ratio), S(modulus * T(1e-12)));
  }

  /// -J^2 p'(J), Pa: initial density times the squared speed of sound c^2 = dp/d(density).
  template <class S>
  MPM_HD S tangent(const S& log_volume_ratio) const {
    const S l = felt(log_volume_ratio);
    if (form == EquationOfState::linear) return S(modulus);
    if (form == EquationOfState::tait) {
      const S change = exponential_change(l), J = exp(l);
      return modulus * (J * J * exp(-change / T(tait_constant)));
    }
    if (form == EquationOfState::mie_gruneisen) {
      const S change = exponential_change(l), J = exp(l);
      const S within = hugoniot.compression(S(-change)).within;
      return modulus * select(change < real<S>(0), J * J * hugoniot.tangent(within), S(real<S>(1)));
    }
    return modulus * exp((T(1) - exponent) * l);
  }
};

}  // namespace mpm

/// The members of Parameters and the rows of the table by which a material chooses an equation of state.
#define MPM_EQUATION_OF_STATE_MEMBERS \
  double bulk_modulus, equation_of_state, exponent, heat_capacity_ratio, hugoniot_slope, tension
#define MPM_EQUATION_OF_STATE_PARAMETERS                                                                             \
  MPM_NUMBER_PARAMETER(bulk_modulus, "Pa", required, 0.0, unbounded, MPM_ABOVE_MINIMUM,                              \
                       "bulk modulus K at rest; density (10 v)^2 keeps the density of flows at speed v within 1 %"), \
      MPM_CHOICE_PARAMETER(equation_of_state, "linear|power|tait|mie_gruneisen|stiffened_gas|ideal_gas", 0,          \
                           "p(J), see newtonian_fluid"),                                                             \
      MPM_NUMBER_PARAMETER(exponent, "", 7.0, 1.01, unbounded, 0, "n of `power`; 7 is water"),                       \
      MPM_NUMBER_PARAMETER(heat_capacity_ratio, "", 1.4, 1.01, unbounded, 0,                                         \
                           "g of `stiffened_gas` and `ideal_gas`; 1.4 is air"),                                      \
      MPM_NUMBER_PARAMETER(hugoniot_slope, "", 1.489, 0.01, unbounded, 0,                                            \
                           "s of `mie_gruneisen`, by which shocks are faster than sound; 1.489 is copper"),          \
      MPM_CHOICE_PARAMETER(tension, "kept|none", 0, "none: there is no pressure below zero")
/// The clamp of a material whose pressure is that of a ShockHugoniot while `has_pole`, with Parameters of a `hugoniot_slope`
/// and a State of a `log_volume_ratio`.
#define MPM_HUGONIOT_CLAMPS(has_pole)                                                                               \
  static constexpr mpm_clamp clamps[] = {                                                                           \
      {"below J =", "",                                                                                             \
       "the pressure of mie_gruneisen goes on along its tangent, as its formula has a pole ahead; pressures there " \
       "are too low"}};                                                                                             \
  static void clamp_bounds(const Parameters& p, double* bound) {                                                    \
    bound[0] = (has_pole) ? 1 - mie_gruneisen_reach / p.hugoniot_slope : no_bound;                                  \
  }                                                                                                                 \
  template <class AnyState>                                                                                         \
  static unsigned acting_clamps(const double* bound, const AnyState& state) {                                       \
    return exp(state.log_volume_ratio) < bound[0] ? 1 : 0;                                                          \
  }
/// The clamp of a material with the rows MPM_EQUATION_OF_STATE_PARAMETERS.
#define MPM_EQUATION_OF_STATE_CLAMPS                                                         \
  MPM_HUGONIOT_CLAMPS(static_cast<EquationOfState>(static_cast<int>(p.equation_of_state)) == \
                      EquationOfState::mie_gruneisen)
