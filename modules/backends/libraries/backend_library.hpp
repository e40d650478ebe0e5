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

/// Changes with the size of what a library and the program hand one another: a library that is left of an earlier build, when
/// these were others, is refused.
constexpr std::uint64_t boundary_layout() {
  std::uint64_t layout = 0;
  for (const std::size_t size :
       {sizeof(Experiment), sizeof(Plan), sizeof(Pass), sizeof(StepInfo), sizeof(SeededBody), sizeof(BodyState),
        sizeof(Ledger), sizeof(HeatLedger), sizeof(ContactRecord), sizeof(PairRecord), sizeof(ContactNode),
        sizeof(FilterRecord), sizeof(Reaction), sizeof(RigidState), sizeof(BackendRequest)})
    layout = layout * 1000003 + size;
  return layout;
}

/// What a library exports, under the name of `backend_library_symbol`.
struct BackendLibrary {
  std::uint64_t layout;
  MakeBackend make;
};
inline constexpr const char* backend_library_symbol = "mpm_backend_library";

/// The maker of a library: "reference", "cpu_2_float", "cpu_2_double", "cpu_3_float", "cpu_3_double", "cpu_fused"
/// (bench/fused.hpp) and "device".
/// The program throws NotBuilt, with file and remedy, where the library is missing or of another build.
MakeBackend backend_library(std::string_view name);

}  // namespace mpm
