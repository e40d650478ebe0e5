#pragma once
// Numbers with units: "0.5 mm", "1.5 g/cm^3", "30 deg". Everything inside the program is SI.

#include <array>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

namespace mpm {

/// A text that is no number with a unit, or one of the wrong dimension; the message says what was expected.
class UnitError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Exponents of kg, m, s, K and of the angle (radians, which is otherwise a pure number).
struct Dimension {
  std::array<int, 5> exponent{};
  bool operator==(const Dimension&) const = default;
};

struct Unit {
  double multiplier = 1,
         divisor = 1;  ///< one such unit is multiplier / divisor in SI: kept apart, so that decimals stay exact
  Dimension dimension;
};

struct Quantity {
  double value = 0;  ///< value in SI
  Dimension dimension;
  std::string unit;  ///< unit as written
};

/// Parses a unit: symbols joined by '*', '·' or a blank and by '/', integer powers ("m^2", "m²"), parentheses. Each '/'
/// divides by the one factor after it. The empty text is a pure number. Throws UnitError with the nearest known unit.
Unit parse_unit(std::string_view text);

/// Parses "number unit". Throws UnitError.
Quantity parse_quantity(std::string_view text);

/// True when the text starts with a number that a unit follows ("2 mm", "5kPa"), so it is not an expression.
bool looks_like_quantity(std::string_view text);

/// The number that the whole text is; nothing when it is none.
std::optional<double> parse_number(std::string_view text);

/// SI value of `text`, which must have the dimension of the SI unit `expected` ("Pa"; "" a pure number, "any"
/// whatever). Throws UnitError: "expected a pressure (Pa), got a length (mm)".
double to_si(std::string_view text, std::string_view expected);

/// The unit in words: "a pressure (Pa)"; "a number" for a pure number.
std::string describe_unit(std::string_view unit);

}  // namespace mpm
