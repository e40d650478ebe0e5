// Catch2, whichever major version is installed; each suite's main comes from its build target.
#pragma once

#if __has_include(<catch2/catch_all.hpp>)
#include <catch2/catch_all.hpp>
using Catch::Approx;
#else
#include <catch2/catch.hpp>  // version 2 brings Approx into the global namespace by itself
#endif
