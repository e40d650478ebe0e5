#pragma once
// A backend takes minutes to compile for all dimensions and precisions, and an experiment needs one of them: each is a library
// of its own. The program loads it when a scene asks for it; the tests have all of them linked in.

#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "simulation/backend.hpp"

namespace mpm {

namespace device {
struct DeviceSetup;
}

/// What a library is asked to make. A backend reads what its maker below takes.
struct BackendRequest {
  const Experiment& experiment;
  const Plan& plan;
  std::vector<SeededBody> bodies;
  int threads = 1;
  bool find_number = false;
  const device::DeviceSetup* device = nullptr;
};

using MakeBackend = std::unique_ptr<Backend> (*)(BackendRequest request);

/// What a library exports, under the name of `backend_library_symbol`. Library and program hand objects to one another, so that
/// both must be compiled of the same headers: a library that is left of an earlier build is refused by their hash.
struct BackendLibrary {
  std::uint64_t headers;
  MakeBackend make;
};
inline constexpr const char* backend_library_symbol = "mpm_backend_library";

/// The maker of a library: "reference", "cpu_2_float", "cpu_2_double", "cpu_3_float", "cpu_3_double", "cpu_fused"
/// (bench/fused.hpp) and "device".
/// The program throws NotBuilt, with file and remedy, where the library is missing or of another build.
MakeBackend backend_library(std::string_view name);

/// Loads the library of the backend that an experiment names, which may have to be built first. Throws NotBuilt.
void load_backend_library(const Experiment& experiment);

}  // namespace mpm
