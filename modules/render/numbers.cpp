#include "render/numbers.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "support/numbers.hpp"

namespace mpm::render {
namespace {

constexpr const char* kMinus = "−";
constexpr const char* kThinSpace = "\u2009";

/// std::log10 of an exact power of ten can fall just below the whole number.
int decade(double value) {
  return static_cast<int>(std::floor(std::log10(value) + 1e-9));
}

double nice_step(double raw) {
  const double power = std::pow(10.0, decade(raw));
  const double lead = raw / power;
  return (lead < 1.5 ? 1 : lead < 3.2 ? 2 : lead < 7.1 ? 5 : 10) * power;
}

bool is_plain_range(double lo, double hi) {
  return lo >= 0.9e-3 && hi <= 1.1e4;
}

}  // namespace

double nice_below(double value) {
  const double power = std::pow(10.0, decade(value));
  const double lead = value / power * (1 + 1e-9);
  return (lead >= 5 ? 5 : lead >= 2 ? 2 : 1) * power;
}

std::string superscript(int number) {
  static const char* digits[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string result = number < 0 ? "⁻" : "";
  for (const char c : std::to_string(std::abs(number))) result += digits[c - '0'];
  return result;
}

std::string power_of_ten(int exponent) {
  return exponent == 0 ? "1" : "10" + superscript(exponent);
}

std::string fixed(double value, int decimals) {
  std::string digits = support::fixed_point(std::fabs(value), decimals);
  const bool is_zero = digits.find_first_not_of("0.") == std::string::npos;
  const std::size_t whole = std::min(digits.find('.'), digits.size());
  if (whole >= 5) {
    for (std::size_t i = whole; i > 3; i -= 3) digits.insert(i - 3, kThinSpace);
  }
  return (value < 0 && !is_zero ? kMinus : "") + digits;
}

std::string compact(double value, int digits) {
  if (value == 0) return "0";
  if (!std::isfinite(value)) return std::isnan(value) ? "not a number" : value > 0 ? "∞" : std::string(kMinus) + "∞";
  const int power = decade(std::fabs(value));
  if (power >= -3 && power < 5) return support::without_trailing_zeros(fixed(value, std::max(0, digits - 1 - power)));
  const double lead = value / std::pow(10.0, power);
  const std::string text = support::without_trailing_zeros(fixed(lead, digits - 1));
  if (text == "1") return power_of_ten(power);
  return text + "×" + power_of_ten(power);
}

std::string with_factor(std::string_view label, int exponent) {
  if (exponent == 0) return std::string(label);
  const std::string factor = power_of_ten(exponent);
  const std::size_t open = label.rfind('(');
  if (open == std::string_view::npos || label.empty() || label.back() != ')') {
    return std::string(label) + (label.empty() ? "" : " ") + "(" + factor + ")";
  }
  const std::string_view unit = label.substr(open + 1, label.size() - open - 2);
  const bool has_unit = !unit.empty() && unit != "-" && unit != "–" && unit != "−" && unit != "1";
  return std::string(label.substr(0, open + 1)) + factor + (has_unit ? " " + std::string(unit) : "") + ")";
}

Ticks linear_ticks(double lo, double hi, int count) {
  Ticks ticks;
  const double step = nice_step((hi - lo) / std::max(count, 1));
  const int power = decade(step);
  const int top = decade(std::max(std::fabs(lo), std::fabs(hi)));
  if (top >= 4 || top < -2) ticks.exponent = 3 * static_cast<int>(std::floor(top / 3.0));
  const auto first = static_cast<std::int64_t>(std::ceil(lo / step - 1e-6));
  const auto last = static_cast<std::int64_t>(std::floor(hi / step + 1e-6));
  for (std::int64_t i = first; i <= last; ++i) {
    ticks.major.push_back(static_cast<double>(i) * step);
    ticks.labels.push_back(fixed(ticks.major.back() / std::pow(10.0, ticks.exponent), ticks.exponent - power));
  }
  return ticks;
}

Ticks log_ticks(double lo, double hi, int count) {
  const double span = std::log10(hi / lo);
  if (span < 0.7) return linear_ticks(lo, hi, count);  // with less than a decade plain steps read better
  Ticks ticks;
  const int first = static_cast<int>(std::floor(std::log10(lo) - 1e-9));
  const int last = static_cast<int>(std::ceil(std::log10(hi) + 1e-9));
  const int stride = std::max(1, static_cast<int>(std::ceil(span / std::max(count, 1))));
  const bool is_dense = 3 * span <= count + 0.5;
  const bool is_plain = is_plain_range(lo, hi);
  const auto inside = [&](double v) { return v >= lo * (1 - 1e-9) && v <= hi * (1 + 1e-9); };
  for (int n = first; n <= last; ++n) {
    for (int lead = 1; lead < 10; ++lead) {
      const double value = lead * std::pow(10.0, n);
      if (!inside(value)) continue;
      const bool is_labelled = lead == 1 ? n % stride == 0 : is_dense && (lead == 2 || lead == 5);
      if (!is_labelled) {
        if (stride == 1 || lead == 1) ticks.minor.push_back(value);
        continue;
      }
      ticks.major.push_back(value);
      const std::string power = power_of_ten(n);
      ticks.labels.push_back(is_plain ? compact(value) : lead == 1 ? power : std::to_string(lead) + "×" + power);
    }
  }
  return ticks;
}

Ticks signed_log_ticks(double lo, double hi, double linear, int count) {
  Ticks ticks;
  const int first = static_cast<int>(std::ceil(std::log10(linear) - 1e-9));
  const auto decades = [&](double end) { return end > linear ? std::log10(end / linear) : 0; };
  const int stride = std::max(1, static_cast<int>(std::ceil((decades(hi) + decades(-lo)) / std::max(count, 1))));
  const auto add = [&](double value, const std::string& label) {
    if (value < lo || value > hi) return;
    ticks.major.push_back(value), ticks.labels.push_back(label);
  };
  const int last = static_cast<int>(std::floor(std::log10(std::max({hi, -lo, linear})) + 1e-9));
  for (int n = last; n >= first; --n)
    if ((n - first) % stride == 0) add(-std::pow(10.0, n), std::string(kMinus) + power_of_ten(n));
  add(0, "0");
  for (int n = first; n <= last; ++n)
    if ((n - first) % stride == 0) add(std::pow(10.0, n), power_of_ten(n));
  return ticks.major.size() < 3 ? linear_ticks(lo, hi, count) : ticks;
}

}  // namespace mpm::render
