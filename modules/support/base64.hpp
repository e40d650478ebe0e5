// Base64 of RFC 4648, for pictures inside HTML and numbers inside XML.
#pragma once

#include <string>
#include <string_view>

namespace mpm::support {

/// The `bytes` in base64 with padding and no line breaks.
std::string base64(std::string_view bytes);

/// Appends base64 of `bytes` to `text`, without a copy in between.
void append_base64(std::string& text, std::string_view bytes);

}  // namespace mpm::support
