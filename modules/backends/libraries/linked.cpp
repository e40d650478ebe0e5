// Libraries of backends that are linked into the program: for tests and the Python package.
#include <stdexcept>
#include <string>

#include "backends/libraries/backend_library.hpp"

namespace mpm {

namespace reference {
std::unique_ptr<Backend> make(BackendRequest request);
}
namespace device {
std::unique_ptr<Backend> make(BackendRequest request);
}
namespace cpu {
std::unique_ptr<Backend> make_2_float(BackendRequest request);
std::unique_ptr<Backend> make_2_double(BackendRequest request);
std::unique_ptr<Backend> make_3_float(BackendRequest request);
std::unique_ptr<Backend> make_3_double(BackendRequest request);
std::unique_ptr<Backend> make_fused(BackendRequest request);
}  // namespace cpu

MakeBackend backend_library(std::string_view name) {
  if (name == "reference") return reference::make;
  if (name == "device") return device::make;
  if (name == "cpu_2_float") return cpu::make_2_float;
  if (name == "cpu_2_double") return cpu::make_2_double;
  if (name == "cpu_3_float") return cpu::make_3_float;
  if (name == "cpu_3_double") return cpu::make_3_double;
  if (name == "cpu_fused") return cpu::make_fused;
  throw std::logic_error("no backend has the library " + std::string(name));
}

}  // namespace mpm
