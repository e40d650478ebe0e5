// What a reader needs to know of the machine and the build behind a result.
#pragma once

#include <nlohmann/json.hpp>

namespace mpm::output {

/// The machine and the build as {"cpu", "cores", "memory_bytes", "os", "compiler", "instructions", "build_type"}. It
/// holds no user name, host name or path, so that it can be published. What the system does not tell is left out.
nlohmann::ordered_json machine_description();

}  // namespace mpm::output
