#pragma once
// Makes the backend that an experiment names.

#include <string>

#include "simulation/simulation.hpp"

namespace mpm {

/// Makes the backend that Experiment::backend names. The cpu backend uses `threads` >= 1, or with `find_number` as many
/// of them as are fastest; results do not depend on the number. The cuda backend uses `device`: "host" or a number, empty
/// for what MPM_DEVICE says, else 0 (backends/device/program.hpp). Its factory throws device::DeviceError and
/// device::CompilerError.
BackendFactory backend_factory(int threads = 1, bool find_number = false, const std::string& device = "");

/// Makes a backend that shows the start of an experiment and takes no step. It needs no device: the reference backend
/// stands for that of cuda.
BackendFactory unstepped_backend_factory();

}  // namespace mpm
