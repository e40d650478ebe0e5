#include "support/base64.hpp"

#include <openssl/evp.h>
#include <algorithm>

namespace mpm::support {

void append_base64(std::string& text, std::string_view bytes) {
  constexpr std::size_t piece_size = 3 << 20;  // a multiple of 3, so that only the last piece is padded
  text.reserve(text.size() + (bytes.size() + 2) / 3 * 4 + 1);
  while (!bytes.empty()) {
    const std::string_view piece = bytes.substr(0, std::min(piece_size, bytes.size()));
    const std::size_t start = text.size();
    text.resize(start + (piece.size() + 2) / 3 * 4 + 1);  // EVP_EncodeBlock ends its output with a NUL
    const int length =
        EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data() + start),
                        reinterpret_cast<const unsigned char*>(piece.data()), static_cast<int>(piece.size()));
    text.resize(start + static_cast<std::size_t>(length));
    bytes.remove_prefix(piece.size());
  }
}

std::string base64(std::string_view bytes) {
  std::string text;
  append_base64(text, bytes);
  return text;
}

}  // namespace mpm::support
