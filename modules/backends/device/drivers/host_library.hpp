#pragma once
// The image of a module of the host driver is a shared library.

#include <cstddef>
#include <string_view>

namespace mpm::device {

/// The length of an ELF image, whose table of sections ends it as linkers write it; 0 for anything else.
std::size_t length_of_image(const void* image);

/// Loads a shared library from its bytes; null where it cannot be loaded.
void* load_library(std::string_view bytes);

}  // namespace mpm::device
