// How a number becomes text that a program reads back. None of these depends on the locale.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <string_view>

namespace mpm::support {

inline constexpr double infinity = std::numeric_limits<double>::infinity();

/// The shortest text that reads back as the same double; "inf", "-inf" and "nan" where it is not finite.
std::string shortest(double value);

/// Appends shortest(value) to `text`; of a float, the shortest text that reads back as the same float.
void append_shortest(std::string& text, double value);
void append_shortest(std::string& text, float value);

/// The number with seventeen significant digits, enough to read the same double back; columns of them are about equally
/// wide.
std::string full_precision(double value);

/// The number in fixed notation: `decimals` digits after the point (0 to 17; others are taken as the nearest), and a
/// point only with them.
std::string fixed_point(double value, int decimals);

/// The number with three significant digits, as "%.3g" of C writes it.
std::string three_digits(double value);
/// Four significant digits with an exponent, as 1.250e+03.
std::string exponential(double value);

/// A fixed notation without zeros at the end of its fraction, nor a point at its end: "2.50" becomes "2.5", "3.0" "3".
std::string without_trailing_zeros(std::string digits);

/// The number that the whole of `text` is, blanks around it left out; a plus sign may stand before it. Nothing when it
/// is none.
std::optional<double> number_in(std::string_view text);

}  // namespace mpm::support
