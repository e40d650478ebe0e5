#pragma once
// Pressures of barotropic fluids, which depend on J = density at rest / density alone, with their stored energies and
// wave speeds. All three have p(1) = 0 and the bulk modulus K at J = 1.

#include "kernel/math.hpp"

namespace mpm {

enum class EquationOfState {
  linear = 0,  ///< p = K (1/J - 1), linear in the density
  power = 1,   ///< p = K/n (J^-n - 1) with exponent n: Murnaghan (1944), with n = 7 water of Monaghan (1994)
  tait = 2     ///< p = K C (exp((1 - J)/C) - 1), the logarithmic law J = 1 - C ln(1 + p/(K C)) solved for p
};

/// Tait's constant of water at room temperature (Dymond & Malhotra 1988 list it for many liquids), a pure number.
inline constexpr double tait_constant = 0.0894;

/// J^power.
template <class S>
MPM_HD S raised(const S& J, scalar_of<S> power) {
  return exp(power * log(J));
}

/// J p(J) over K: the Kirchhoff pressure, positive in compression.
template <class S>
MPM_HD S pressure_of_state(EquationOfState form, scalar_of<S> exponent, S J) {
  const scalar_of<S> one = real<S>(1), C = real<S>(tait_constant);
  if (form == EquationOfState::linear) return one - J;
  if (form == EquationOfState::power) return J * (raised(J, -exponent) - one) / exponent;
  return C * J * (exp((one - J) / C) - one);
}

/// The energy stored per initial volume over K, which is minus the integral of p/K from 1 to J.
template <class S>
MPM_HD S energy_of_state(EquationOfState form, scalar_of<S> exponent, S J) {
  const scalar_of<S> one = real<S>(1), C = real<S>(tait_constant);
  const S strain = J - one;
  if (form == EquationOfState::linear) return strain - log(J);
  if (form == EquationOfState::power) return ((raised(J, one - exponent) - one) / (exponent - one) + strain) / exponent;
  return C * (C * (exp(-strain / C) - one) + strain);
}

/// -J^2 p'(J) over K, which is (initial density) c^2 / K with c^2 = dp/d(density) of the present density.
template <class S>
MPM_HD S tangent_of_state(EquationOfState form, scalar_of<S> exponent, S J) {
  const scalar_of<S> one = real<S>(1), C = real<S>(tait_constant);
  if (form == EquationOfState::linear) return S(one);
  if (form == EquationOfState::power) return raised(J, one - exponent);
  return J * J * exp((one - J) / C);
}

}  // namespace mpm
