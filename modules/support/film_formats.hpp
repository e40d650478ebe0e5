#pragma once
// The formats of films, whose names are the endings of their files too.

#include <string>
#include <vector>

namespace mpm::support {

inline const std::vector<std::string>& film_formats() {
  static const std::vector<std::string> formats{"mp4", "webm", "webp"};
  return formats;
}

}  // namespace mpm::support
