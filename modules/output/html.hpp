// Words, numbers and nested values as safe HTML.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace mpm::output {

using Json = nlohmann::ordered_json;

/// The text made safe between tags and inside quoted attributes, in HTML and in XML: the five special characters are
/// escaped, control characters and invalid UTF-8 become U+FFFD.
std::string escape_html(std::string_view text);

/// The number with six significant digits, never 1e+05: "0.0123", "123457", "1.5×10<sup>−7</sup>".
std::string number_html(double value);

/// Every digit of a whole number, in groups of three from 10 000 on.
std::string integer_html(std::int64_t value);

/// The size with its unit: "96 B", "1.5 KiB", "3.2 GiB".
std::string bytes_html(double bytes);

/// The key as words: "particle_steps_per_second" -> "particle steps per second", escaped.
std::string label_html(std::string_view key);

/// The HTML of any value: numbers formatted, objects and lists of objects as tables, long lists folded away but
/// complete. `key` tells numbers of bytes from others.
std::string value_html(std::string_view key, const Json& value);

/// An object as a table of key and value, a list of objects as a table with a column a key.
std::string table_html(const Json& value);

/// One line of plain text for a heading or a card: strings as they are, numbers formatted, lists joined by commas.
std::string inline_html(std::string_view key, const Json& value);

/// A relative link's address: every byte that could end the address or start a scheme is percent-encoded.
std::string relative_link(std::string_view path);

}  // namespace mpm::output
