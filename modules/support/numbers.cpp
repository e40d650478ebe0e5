#include "support/numbers.hpp"

#include <algorithm>
#include <array>
#include <charconv>

namespace mpm::support {

namespace {

template <class Number>
void append_digits(std::string& text, Number value) {
  std::array<char, 32> digits;
  text.append(digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr);
}

}  // namespace

void append_shortest(std::string& text, double value) {
  append_digits(text, value);
}

void append_shortest(std::string& text, float value) {
  append_digits(text, value);
}

std::string shortest(double value) {
  std::string text;
  append_shortest(text, value);
  return text;
}

std::string full_precision(double value) {
  std::array<char, 40> digits;
  return {digits.data(),
          std::to_chars(digits.data(), digits.data() + digits.size(), value, std::chars_format::general, 17).ptr};
}

std::string fixed_point(double value, int decimals) {
  std::array<char, 400> digits;  // the largest double has 309 digits before its point
  return {digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), value, std::chars_format::fixed,
                                       std::clamp(decimals, 0, 17))
                             .ptr};
}

std::string exponential(double value) {
  std::array<char, 32> digits;
  return {digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), value + 0.0,  // no negative zero
                                       std::chars_format::scientific, 3)
                             .ptr};
}

std::string three_digits(double value) {
  std::array<char, 32> digits;
  return {digits.data(),
          std::to_chars(digits.data(), digits.data() + digits.size(), value, std::chars_format::general, 3).ptr};
}

std::string without_trailing_zeros(std::string digits) {
  if (digits.find('.') == std::string::npos) return digits;
  digits.erase(digits.find_last_not_of('0') + 1);
  if (digits.back() == '.') digits.pop_back();
  return digits;
}

std::optional<double> number_in(std::string_view text) {
  constexpr std::string_view blanks = " \t\r";
  const auto first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {};
  text = text.substr(first, text.find_last_not_of(blanks) - first + 1);
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0;
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  if (result.ec != std::errc{} || result.ptr != text.data() + text.size()) return {};
  return value;
}

}  // namespace mpm::support
