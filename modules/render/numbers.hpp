// Which numbers stand on an axis, and how a number is written: plain, engineering or 10ⁿ, never 1e+05.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace mpm::render {

/// Marks of an axis. Labels belong to `major`; they are the values divided by 10^exponent.
struct Ticks {
  std::vector<double> major, minor;
  std::vector<std::string> labels;
  int exponent = 0;
};

/// Marks at multiples of 1, 2 or 5 times a power of ten in [lo, hi], about `count` of them; a common factor of 10³ᵏ is
/// taken out when the largest value is 10⁴ or more, or below 10⁻². Requires lo < hi, both finite.
Ticks linear_ticks(double lo, double hi, int count);

/// Decades in [lo, hi] as major marks, 2 to 9 between them as minor; where `count` allows, 2 and 5 are labelled too.
/// Requires 0 < lo < hi.
Ticks log_ticks(double lo, double hi, int count);

/// Zero, and decades of both signs from `linear` on in [lo, hi], for an axis that is linear within it and logarithmic beyond.
/// Requires lo < hi and linear > 0.
Ticks signed_log_ticks(double lo, double hi, double linear, int count);

/// The largest of 1, 2, 5 times a power of ten that is not above `value` (> 0).
double nice_below(double value);

/// 10 with the exponent as superscript digits: 10⁻³; 10⁰ is "1".
std::string power_of_ten(int exponent);

/// Superscript digits with a superscript minus.
std::string superscript(int number);

/// Fixed notation with a true minus sign and thin spaces between thousands from 10 000 on.
std::string fixed(double value, int decimals);

/// `digits` significant digits, trailing zeros left out: plain from 10⁻³ to below 10⁵, else a power of ten.
std::string compact(double value, int digits = 4);

/// "kinetic energy T (J)" with exponent 3 becomes "kinetic energy T (10³ J)".
std::string with_factor(std::string_view label, int exponent);

}  // namespace mpm::render
