// Catch2, whichever major version is installed; each suite's main comes from its build target.
#pragma once

#include "support/larger.hpp"

#if __has_include(<catch2/catch_all.hpp>)
#include <catch2/catch_all.hpp>
using Catch::Approx;
using Catch::Matchers::ContainsSubstring;
#else
#include <catch2/catch.hpp>  // version 2 brings Approx into the global namespace by itself

#include <string>

/// The matcher that version 2 calls Contains, under its name in version 3.
inline auto ContainsSubstring(const std::string& part) {
  return Catch::Contains(part);
}
#endif
