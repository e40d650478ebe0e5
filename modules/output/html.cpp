#include "output/html.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <vector>

#include "support/numbers.hpp"

namespace mpm::output {
namespace {

constexpr std::string_view replacement = "\xEF\xBF\xBD";  ///< U+FFFD
constexpr std::string_view minus = "\xE2\x88\x92";        ///< U+2212
constexpr std::string_view thin_space = "\xE2\x80\xAF";   ///< U+202F, narrow and unbreakable
constexpr std::string_view nothing = "\xE2\x80\x94";      ///< an em dash stands for a missing value
constexpr std::size_t longest_open_list = 12;

/// Length of the valid UTF-8 sequence at the front of `text`, 0 when there is none.
std::size_t utf8_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const auto continues = [&](std::size_t i) { return i < text.size() && (byte(i) & 0xC0) == 0x80; };
  const unsigned char first = byte(0);
  if (first < 0x80) return 1;
  if (first >= 0xC2 && first <= 0xDF) return continues(1) ? 2 : 0;
  if (first >= 0xE0 && first <= 0xEF) {
    if (!continues(1) || !continues(2)) return 0;
    const bool overlong = first == 0xE0 && byte(1) < 0xA0;
    const bool surrogate = first == 0xED && byte(1) > 0x9F;
    return overlong || surrogate ? 0 : 3;
  }
  if (first >= 0xF0 && first <= 0xF4) {
    if (!continues(1) || !continues(2) || !continues(3)) return 0;
    const bool overlong = first == 0xF0 && byte(1) < 0x90;
    const bool too_large = first == 0xF4 && byte(1) > 0x8F;
    return overlong || too_large ? 0 : 4;
  }
  return 0;
}

void append_escaped(std::string& html, char c) {
  switch (c) {
    case '&':
      html += "&amp;";
      break;
    case '<':
      html += "&lt;";
      break;
    case '>':
      html += "&gt;";
      break;
    case '"':
      html += "&quot;";
      break;
    case '\'':
      html += "&#39;";
      break;
    default:
      if (static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\t') {
        html += replacement;
      } else {
        html += c;
      }
  }
}

std::string with_true_minus(std::string digits) {
  if (digits.starts_with('-')) digits.replace(0, 1, minus);
  return digits;
}

std::string grouped(std::string digits) {
  if (digits.size() < 5) return digits;
  for (auto i = static_cast<std::ptrdiff_t>(digits.size()) - 3; i > 0; i -= 3) digits.insert(i, thin_space);
  return digits;
}

bool holds_bytes(std::string_view key) {
  return key.find("bytes") != std::string_view::npos || key.ends_with("memory");
}

bool is_flat(const Json& value) {
  return !value.is_structured();
}

bool is_table(const Json& value) {
  return value.is_array() && !value.empty() &&
         std::all_of(value.begin(), value.end(), [](const Json& row) { return row.is_object() && !row.empty(); });
}

std::string scalar_html(std::string_view key, const Json& value) {
  if (value.is_null()) return std::string(nothing);
  if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
  if (value.is_string()) return escape_html(value.get_ref<const std::string&>());
  if (value.is_number() && holds_bytes(key)) return bytes_html(value.get<double>());
  if (value.is_number_unsigned() && value.get<std::uint64_t>() > INT64_MAX) return value.dump();
  if (value.is_number_integer()) return integer_html(value.get<std::int64_t>());
  if (value.is_number_float()) return number_html(value.get<double>());
  return escape_html(value.dump());
}

std::string joined(std::string_view key, const Json& list) {
  std::string html;
  for (const Json& item : list) html += (html.empty() ? "" : ", ") + scalar_html(key, item);
  return html;
}

std::string list_html(std::string_view key, const Json& list) {
  if (list.empty()) return std::string(nothing);
  if (std::all_of(list.begin(), list.end(), is_flat)) {
    if (list.size() <= longest_open_list) return joined(key, list);
    return "<details><summary>" + std::to_string(list.size()) + " values</summary>" + joined(key, list) + "</details>";
  }
  std::string html = "<ul>";
  for (const Json& item : list) html += "<li>" + value_html(key, item) + "</li>";
  return html + "</ul>";
}

std::string cell(std::string_view key, const Json& value) {
  const char* tag = value.is_number() ? "<td class=\"number\">" : "<td>";
  return tag + value_html(key, value) + "</td>";
}

std::vector<std::string> all_keys(const Json& rows) {
  std::vector<std::string> keys;
  for (const Json& row : rows) {
    for (const auto& item : row.items()) {
      if (std::find(keys.begin(), keys.end(), item.key()) == keys.end()) keys.push_back(item.key());
    }
  }
  return keys;
}

/// Whether an object of flat objects is better shown as one grid: {"kinetic": {"initial": …, "final": …}, …}.
bool is_grid(const Json& object) {
  if (object.size() < 2) return false;
  std::size_t filled = 0;
  for (const Json& row : object) {
    if (!row.is_object() || row.empty() || !std::all_of(row.begin(), row.end(), is_flat)) return false;
    filled += row.size();
  }
  return 2 * filled > object.size() * all_keys(object).size();
}

/// Rows are the members of a list, or of an object, whose keys then head the rows.
std::string columns_table(const Json& rows) {
  const std::vector<std::string> keys = all_keys(rows);
  const auto is_number_column = [&](const std::string& key) {
    return std::all_of(rows.begin(), rows.end(), [&](const Json& r) { return !r.contains(key) || r[key].is_number(); });
  };
  std::string html = "<div class=\"scroll\"><table><thead><tr>";
  if (rows.is_object()) html += "<td></td>";
  for (const auto& key : keys) {
    html += (is_number_column(key) ? "<th class=\"number\">" : "<th>") + label_html(key) + "</th>";
  }
  html += "</tr></thead><tbody>";
  for (const auto& row : rows.items()) {
    html += "<tr>";
    if (rows.is_object()) html += "<th scope=\"row\">" + label_html(row.key()) + "</th>";
    for (const auto& key : keys) {
      html += row.value().contains(key) ? cell(key, row.value()[key]) : "<td></td>";
    }
    html += "</tr>";
  }
  return html + "</tbody></table></div>";
}

std::string pairs_table(const Json& object) {
  std::string html = "<div class=\"scroll\"><table class=\"pairs\"><tbody>";
  for (const auto& item : object.items()) {
    html += "<tr><th scope=\"row\">" + label_html(item.key()) + "</th>" + cell(item.key(), item.value()) + "</tr>";
  }
  return html + "</tbody></table></div>";
}

}  // namespace

std::string escape_html(std::string_view text) {
  std::string html;
  html.reserve(text.size());
  while (!text.empty()) {
    const std::size_t length = utf8_length(text);
    if (length == 0) {
      html += replacement;
    } else if (length == 1) {
      append_escaped(html, text.front());
    } else {
      html += text.substr(0, length);
    }
    text.remove_prefix(std::max<std::size_t>(1, length));
  }
  return html;
}

std::string number_html(double value) {
  if (std::isnan(value)) return "not a number";
  if (std::isinf(value)) return value > 0 ? "∞" : std::string(minus) + "∞";
  if (value == 0.0) return "0";
  char buffer[64];
  const auto scientific = std::to_chars(buffer, buffer + sizeof buffer, value, std::chars_format::scientific, 5);
  const std::string text(buffer, scientific.ptr);
  const std::size_t e = text.find('e');
  const int exponent = std::stoi(text.substr(e + 1));
  if (exponent >= -4 && exponent <= 5) {
    return with_true_minus(support::without_trailing_zeros(support::fixed_point(value, 5 - exponent)));
  }
  return with_true_minus(support::without_trailing_zeros(text.substr(0, e))) + "×10<sup>" +
         with_true_minus(std::to_string(exponent)) + "</sup>";
}

std::string integer_html(std::int64_t value) {
  const std::string digits = std::to_string(value);
  return value < 0 ? std::string(minus) + grouped(digits.substr(1)) : grouped(digits);
}

std::string bytes_html(double bytes) {
  constexpr const char* units[] = {"B", "KiB", "MiB", "GiB", "TiB"};
  int unit = 0;
  for (; std::abs(bytes) >= 1024.0 && unit < 4; ++unit) bytes /= 1024.0;
  const int decimals = unit == 0 && bytes == std::floor(bytes) ? 0 : std::abs(bytes) < 10.0 ? 2 : 1;
  return with_true_minus(support::without_trailing_zeros(support::fixed_point(bytes, decimals))) + "\xC2\xA0" +
         units[unit];
}

std::string label_html(std::string_view key) {
  std::string words(key);
  std::replace(words.begin(), words.end(), '_', ' ');
  return escape_html(words);
}

std::string value_html(std::string_view key, const Json& value) {
  if (is_table(value)) return columns_table(value);
  if (value.is_object() && is_grid(value)) return columns_table(value);
  if (value.is_object()) return value.empty() ? std::string(nothing) : pairs_table(value);
  return value.is_array() ? list_html(key, value) : scalar_html(key, value);
}

std::string table_html(const Json& value) {
  return value_html({}, value);
}

std::string inline_html(std::string_view key, const Json& value) {
  if (is_flat(value)) return scalar_html(key, value);
  std::string html;
  for (const auto& item : value.items()) {
    if (!html.empty()) html += ", ";
    if (value.is_object()) html += label_html(item.key()) + " ";
    html += inline_html(key, item.value());
  }
  return html.empty() ? std::string(nothing) : html;
}

std::string relative_link(std::string_view path) {
  constexpr std::string_view plain = "-_.~/";
  std::string link;
  for (const char c : path) {
    const auto byte = static_cast<unsigned char>(c);
    const bool letter_or_digit = byte < 0x80 && std::isalnum(byte);
    if (letter_or_digit || plain.find(c) != std::string_view::npos) {
      link += c;
    } else {
      link += '%';
      link += "0123456789ABCDEF"[byte >> 4];
      link += "0123456789ABCDEF"[byte & 15];
    }
  }
  return link;
}

}  // namespace mpm::output
