#pragma once
// What the library of the cpu backend in one dimension and precision holds beside the units that it is cut into.

#include <utility>

#include "backends/cpu/cpu_backend.hpp"
#include "backends/libraries/backend_library.hpp"

/// What instantiation.cpp.in makes of this header for every dimension and scalar: the other units have the rest.
#define MPM_INSTANTIATE_LIBRARY(D, T)                                                                      \
  extern template class GridStep<D, T>;                                                                    \
  extern template class ParticleStep<D, T>;                                                                \
  std::unique_ptr<Backend> make_##D##_##T(BackendRequest request) {                                        \
    return std::make_unique<CpuBackend<D, T>>(request.experiment, request.plan, std::move(request.bodies), \
                                              request.threads, request.find_number);                       \
  }
