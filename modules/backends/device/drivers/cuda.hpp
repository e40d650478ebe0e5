#pragma once
// NVIDIA's driver is found at run time by dlopen, as its compiler is: the program builds and starts without either.

#include <string>

#include "backends/device/drivers/driver.hpp"

namespace mpm::device {

/// The table of libcuda, loaded once a process and initialised. Returns null where the library is missing, too old or
/// finds no device; `why` then says what is missing, where it was looked for and what to do.
const Driver* cuda_driver(std::string& why);

}  // namespace mpm::device
