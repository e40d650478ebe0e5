// Libraries of backends that are loaded when a scene asks for them: for the program.
#include <dlfcn.h>

#include <filesystem>
#include <map>
#include <mutex>
#include <string>

#include "backends/libraries/backend_library.hpp"
#include "plugin/on_demand.hpp"

namespace mpm {
namespace {

std::filesystem::path place_of(const std::string& name) {
  std::error_code error;
  for (const std::filesystem::path& folder : folders_beside_program("backends"))
    if (std::filesystem::is_regular_file(folder / (name + ".so"), error)) return folder / (name + ".so");
  return {};
}

MakeBackend load(const std::string& name) {
  if (place_of(name).empty()) build_missing({"backend_" + name});
  const std::filesystem::path file = place_of(name);
  if (file.empty())
    throw NotBuilt("the library backends/" + name +
                   ".so of this program was not found beside it: install or build it again");
  const auto refuse = [&](const std::string& what) {
    throw NotBuilt("backend " + file.string() + ": " + what + "; build it again (./mpm build)");
  };
  void* handle = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);  // stays loaded until the process ends
  if (!handle) {
    const char* reason = dlerror();
    refuse(std::string("cannot be loaded: ") + (reason ? reason : "unknown reason"));
  }
  const auto* library = static_cast<const BackendLibrary*>(dlsym(handle, backend_library_symbol));
  if (!library) refuse("exports no backend");
  if (library->headers != MPM_HASH_OF_HEADERS) refuse("is of another build than this program");
  return library->make;
}

}  // namespace

MakeBackend backend_library(std::string_view name) {
  static std::map<std::string, MakeBackend, std::less<>> loaded;
  static std::mutex guard;
  const std::lock_guard lock(guard);
  if (const auto known = loaded.find(name); known != loaded.end()) return known->second;
  return loaded.emplace(name, load(std::string(name))).first->second;
}

}  // namespace mpm
