#include "experiment/units.hpp"

#include <cctype>
#include <charconv>
#include <cmath>
#include <numbers>
#include <vector>

#include "experiment/diagnostics.hpp"

namespace mpm {
namespace {

constexpr Dimension dimension(int kg, int m, int s, int kelvin = 0, int angle = 0) {
  return {{kg, m, s, kelvin, angle}};
}

struct Symbol {
  const char* name;
  double multiplier, divisor;
  Dimension dimension;
};

constexpr Dimension pure = dimension(0, 0, 0), mass = dimension(1, 0, 0), length = dimension(0, 1, 0),
                    duration = dimension(0, 0, 1), temperature = dimension(0, 0, 0, 1),
                    angle = dimension(0, 0, 0, 0, 1), frequency = dimension(0, 0, -1), force = dimension(1, 1, -2),
                    pressure = dimension(1, -1, -2), energy = dimension(1, 2, -2), power = dimension(1, 2, -3);

/// Every symbol is listed in full, prefix included: no surprises such as a "cPa" nobody meant.
const Symbol symbols[] = {
    {"m", 1, 1, length},        {"km", 1e3, 1, length},
    {"dm", 1, 10, length},      {"cm", 1, 100, length},
    {"mm", 1, 1000, length},    {"um", 1, 1e6, length},
    {"nm", 1, 1e9, length},     {"kg", 1, 1, mass},
    {"g", 1, 1000, mass},       {"mg", 1, 1e6, mass},
    {"t", 1e3, 1, mass},        {"s", 1, 1, duration},
    {"ms", 1, 1000, duration},  {"us", 1, 1e6, duration},
    {"ns", 1, 1e9, duration},   {"min", 60, 1, duration},
    {"h", 3600, 1, duration},   {"K", 1, 1, temperature},
    {"N", 1, 1, force},         {"mN", 1, 1000, force},
    {"kN", 1e3, 1, force},      {"MN", 1e6, 1, force},
    {"Pa", 1, 1, pressure},     {"hPa", 1e2, 1, pressure},
    {"kPa", 1e3, 1, pressure},  {"MPa", 1e6, 1, pressure},
    {"GPa", 1e9, 1, pressure},  {"bar", 1e5, 1, pressure},
    {"J", 1, 1, energy},        {"mJ", 1, 1000, energy},
    {"kJ", 1e3, 1, energy},     {"MJ", 1e6, 1, energy},
    {"W", 1, 1, power},         {"mW", 1, 1000, power},
    {"kW", 1e3, 1, power},      {"Hz", 1, 1, frequency},
    {"kHz", 1e3, 1, frequency}, {"MHz", 1e6, 1, frequency},
    {"rad", 1, 1, angle},       {"deg", std::numbers::pi, 180, angle},
    {"%", 1, 100, pure},
};

struct NamedDimension {
  Dimension dimension;
  const char* name;
};

const NamedDimension named_dimensions[] = {
    {pure, "a pure number"},
    {mass, "a mass"},
    {length, "a length"},
    {duration, "a time"},
    {temperature, "a temperature"},
    {angle, "an angle"},
    {frequency, "a rate"},
    {force, "a force"},
    {pressure, "a pressure"},
    {energy, "an energy"},
    {power, "a power"},
    {dimension(0, 2, 0), "an area"},
    {dimension(0, 3, 0), "a volume"},
    {dimension(0, 1, -1), "a velocity"},
    {dimension(0, 1, -2), "an acceleration"},
    {dimension(1, -3, 0), "a density"},
    {dimension(1, -1, -1), "a viscosity"},
    {dimension(1, 1, -1), "a momentum"},
    {dimension(1, 0, -2), "a stiffness per area"},
    {dimension(0, 2, -1), "a diffusivity"},
    {dimension(1, 1, -3, -1), "a thermal conductivity"},
    {dimension(0, 2, -2, -1), "a specific heat capacity"},
    {dimension(0, 2, -2), "an energy per mass"},
    {dimension(1, 0, -3), "a heat flux"},
    {dimension(1, 0, -3, -1), "a heat transfer coefficient"},
};

std::string dimension_name(const Dimension& wanted) {
  for (const NamedDimension& named : named_dimensions) {
    if (named.dimension == wanted) return named.name;
  }
  return "a quantity";
}

bool is_symbol_character(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return std::isalpha(byte) || c == '%' || byte >= 0x80;
}

void replace_all(std::string& text, std::string_view from, std::string_view to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
}

/// The unit with typographic forms in plain letters.
std::string plain(std::string_view unit) {
  std::string text(unit);
  const std::pair<const char*, const char*> forms[] = {{"\u00b2", "^2"}, {"\u00b3", "^3"}, {"\u00b7", "*"},
                                                       {"\u00b5", "u"},  {"\u03bc", "u"},  {"\u00b0", "deg"}};
  for (const auto& [from, to] : forms) replace_all(text, from, to);
  return text;
}

class UnitParser {
 public:
  explicit UnitParser(std::string_view text) : shown_(text), text_(plain(text)) {}

  Unit parse() {
    Unit unit = product(0);
    if (!ended()) fail("unexpected " + in_quotes(text_.substr(at_)));
    return unit;
  }

 private:
  [[noreturn]] void fail(const std::string& reason) const {
    throw UnitError("the unit " + in_quotes(shown_) + " is not understood: " + reason);
  }

  bool ended() {
    while (at_ < text_.size() && text_[at_] == ' ') ++at_;
    return at_ >= text_.size();
  }

  Unit product(int depth) {
    if (depth > 8) fail("too many parentheses");
    Unit result;
    bool divide = false;
    while (true) {
      const Unit factor = power_of(depth);
      const int sign = divide ? -1 : 1;
      result.multiplier *= divide ? factor.divisor : factor.multiplier;
      result.divisor *= divide ? factor.multiplier : factor.divisor;
      for (std::size_t i = 0; i < 5; ++i) result.dimension.exponent[i] += sign * factor.dimension.exponent[i];
      check_powers(result);
      if (ended() || text_[at_] == ')') return result;
      divide = text_[at_] == '/';
      if (divide || text_[at_] == '*') ++at_;
    }
  }

  Unit power_of(int depth) {
    Unit unit = atom(depth);
    if (ended() || text_[at_] != '^') return unit;
    ++at_;
    int power = 0;
    const char* end = text_.data() + text_.size();
    const auto [stop, error] = std::from_chars(text_.data() + at_, end, power);
    if (error != std::errc{} || power < -9 || power > 9) fail("expected a whole power such as ^2 or ^-1");
    at_ = static_cast<std::size_t>(stop - text_.data());
    for (int& exponent : unit.dimension.exponent) exponent *= power;
    check_powers(unit);
    if (power < 0) std::swap(unit.multiplier, unit.divisor);
    unit.multiplier = std::pow(unit.multiplier, std::abs(power));
    unit.divisor = std::pow(unit.divisor, std::abs(power));
    return unit;
  }

  void check_powers(const Unit& unit) const {
    for (const int exponent : unit.dimension.exponent) {
      if (exponent < -99 || exponent > 99) fail("a power beyond 99");
    }
  }

  Unit atom(int depth) {
    if (ended()) fail("a unit is missing at the end");
    if (text_[at_] == '(') {
      ++at_;
      const Unit inner = product(depth + 1);
      if (ended() || text_[at_] != ')') fail("a ')' is missing");
      ++at_;
      return inner;
    }
    if (text_[at_] == '1') {
      ++at_;
      return {};
    }
    std::size_t end = at_;
    while (end < text_.size() && is_symbol_character(text_[end])) ++end;
    if (end == at_) fail("unexpected " + in_quotes(text_.substr(at_, 1)));
    const std::string name = text_.substr(at_, end - at_);
    at_ = end;
    return look_up(name);
  }

  Unit look_up(const std::string& name) const {
    if (name == "degC" || name == "C")
      throw UnitError("degrees Celsius have another zero and are no unit here; write kelvin, which are 273.15 more");
    std::vector<std::string> known;
    for (const Symbol& symbol : symbols) {
      if (name == symbol.name) return {symbol.multiplier, symbol.divisor, symbol.dimension};
      known.push_back(symbol.name);
    }
    // A slip in case alone ("gpa", "Mm") is the likeliest: it counts as no distance.
    const std::string nearest = nearest_name(name, known);
    throw UnitError("unknown unit " + in_quotes(name) +
                    (nearest.empty() ? "; known units: " + quoted_list(known) : did_you_mean(name, known)));
  }

  std::string shown_, text_;
  std::size_t at_ = 0;
};

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.front()))) text.remove_prefix(1);
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back()))) text.remove_suffix(1);
  return text;
}

/// Takes a number from the start of `text`, which loses it; nothing when there is none.
std::optional<double> take_number(std::string_view& text) {
  std::string_view rest = text;
  const bool negative = !rest.empty() && rest[0] == '-';
  if (!rest.empty() && (rest[0] == '-' || rest[0] == '+')) rest.remove_prefix(1);
  // from_chars also takes "inf" and "nan", which are no numbers here.
  if (rest.empty() || !(std::isdigit(static_cast<unsigned char>(rest[0])) || rest[0] == '.')) return std::nullopt;
  double value = 0;
  const auto [stop, error] = std::from_chars(rest.data(), rest.data() + rest.size(), value);
  if (error != std::errc{}) return std::nullopt;
  rest.remove_prefix(static_cast<std::size_t>(stop - rest.data()));
  text = rest;
  return negative ? -value : value;
}

bool agree(const Dimension& given, const Dimension& wanted) {
  if (given == wanted) return true;
  // Radians count as a pure number beside other units ("rad/s" is "1/s"), but 30 deg is no friction coefficient.
  Dimension a = given, b = wanted;
  a.exponent[4] = b.exponent[4] = 0;
  return a == b && a != pure;
}

}  // namespace

Unit parse_unit(std::string_view text) {
  text = trimmed(text);
  return text.empty() ? Unit{} : UnitParser(text).parse();
}

std::optional<double> parse_number(std::string_view text) {
  text = trimmed(text);
  const std::optional<double> value = take_number(text);
  return text.empty() ? value : std::nullopt;
}

bool looks_like_quantity(std::string_view text) {
  text = trimmed(text);
  if (!take_number(text)) return false;
  text = trimmed(text);
  return !text.empty() && is_symbol_character(text.front()) && text.front() != '%';
}

Quantity parse_quantity(std::string_view text) {
  std::string_view rest = trimmed(text);
  const std::optional<double> number = take_number(rest);
  if (!number) throw UnitError("the string " + in_quotes(text));
  rest = trimmed(rest);
  const Unit unit = parse_unit(rest);
  const double value = *number * unit.multiplier / unit.divisor;
  if (!std::isfinite(value)) throw UnitError(in_quotes(text) + " is too large for double precision");
  return {value, unit.dimension, std::string(rest)};
}

double to_si(std::string_view text, std::string_view expected) {
  std::string_view probe = trimmed(text);
  if (!take_number(probe)) {
    throw UnitError("expected " + describe_unit(expected) + ", got the string " + in_quotes(text));
  }
  const Quantity quantity = parse_quantity(text);
  if (expected == "any") return quantity.value;
  if (quantity.unit.empty()) {
    if (expected.empty()) throw UnitError("expected a number, got the string " + in_quotes(text) + "; drop the quotes");
    throw UnitError("expected " + describe_unit(expected) + ", got the string " + in_quotes(text) +
                    " without a unit; drop the quotes for SI, or add one");
  }
  if (!agree(quantity.dimension, parse_unit(expected).dimension)) {
    throw UnitError("expected " + describe_unit(expected) + ", got " + dimension_name(quantity.dimension) + " (" +
                    quantity.unit + ")");
  }
  return quantity.value;
}

std::string describe_unit(std::string_view unit) {
  if (unit.empty() || unit == "any") return "a number";
  try {
    return dimension_name(parse_unit(unit).dimension) + " (" + std::string(unit) + ")";
  } catch (const UnitError&) {
    return "a number in " + std::string(unit);  // a plugin may name a unit that is not known here
  }
}

}  // namespace mpm
