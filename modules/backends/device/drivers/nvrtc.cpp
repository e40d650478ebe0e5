#include "backends/device/drivers/nvrtc.hpp"

#include <dlfcn.h>

#include <algorithm>
#include <cstdlib>

namespace mpm::device {

/// The functions used, with the signatures of nvrtc.h (unchanged since CUDA 11.1).
struct Nvrtc::Functions {
  using Program = struct Opaque*;
  std::string file;
  int (*version)(int* major, int* minor) = nullptr;
  int (*create)(Program*, const char* source, const char* name, int headers, const char* const* texts,
                const char* const* names) = nullptr;
  int (*compile)(Program, int count, const char* const* options) = nullptr;
  int (*log_size)(Program, std::size_t*) = nullptr;
  int (*log)(Program, char*) = nullptr;
  int (*code_size)(Program, std::size_t*) = nullptr;
  int (*code)(Program, char*) = nullptr;
  int (*destroy)(Program*) = nullptr;
  const char* (*words)(int) = nullptr;

  bool load(void* library) {
    const auto find = [&](auto& function, const char* name) {
      function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(dlsym(library, name));
      return function != nullptr;
    };
    return find(version, "nvrtcVersion") && find(create, "nvrtcCreateProgram") &&
           find(compile, "nvrtcCompileProgram") && find(log_size, "nvrtcGetProgramLogSize") &&
           find(log, "nvrtcGetProgramLog") && find(code_size, "nvrtcGetCUBINSize") && find(code, "nvrtcGetCUBIN") &&
           find(destroy, "nvrtcDestroyProgram") && find(words, "nvrtcGetErrorString");
  }
};

std::optional<Nvrtc> Nvrtc::find(std::string& why) {
  std::vector<std::string> folders{""};  // what the user names comes before the usual place
  const auto add = [&](const std::string& root) {
    const std::string folder = root + "/lib64/";
    if (std::find(folders.begin(), folders.end(), folder) == folders.end()) folders.push_back(folder);
  };
  for (const char* variable : {"CUDA_PATH", "CUDA_HOME"})
    if (const char* root = std::getenv(variable); root && *root) add(root);
  add("/usr/local/cuda");
  for (const std::string& folder : folders)
    for (const char* name : {"libnvrtc.so", "libnvrtc.so.13", "libnvrtc.so.12", "libnvrtc.so.11.2"}) {
      // The library stays loaded until the process ends, as it keeps threads and memory of its own.
      void* library = dlopen((folder + name).c_str(), RTLD_NOW | RTLD_LOCAL);
      if (!library) continue;
      auto functions = std::make_shared<Functions>();
      functions->file = folder + name;
      if (!functions->load(library)) {
        why = functions->file + " is not an NVRTC of CUDA 11.2 or newer; install a newer CUDA toolkit";
        return {};
      }
      Nvrtc found;
      found.functions_ = std::move(functions);
      return found;
    }
  why = "NVRTC was not found: no libnvrtc.so, .so.13, .so.12 or .so.11.2 on the loader's path";
  for (std::size_t k = 1; k < folders.size(); ++k) why += " or in " + folders[k];
  why += "; install the CUDA toolkit or set CUDA_PATH to its folder";
  return {};
}

std::string Nvrtc::version() const {
  int major = 0, minor = 0;
  functions_->version(&major, &minor);
  return std::to_string(major) + "." + std::to_string(minor) + " (" + functions_->file + ")";
}

std::vector<std::string> Nvrtc::options(std::string_view architecture) {
  // Without -default-device a generic lambda counts as a host function.
  return {"--gpu-architecture=" + std::string(architecture), "-std=c++17", "-default-device", "-DMPM_DEVICE_PASS=1"};
}

Cubin Nvrtc::compile(const Composition& composition, std::string_view architecture, bool verbose) const {
  Cubin cubin;
  Functions::Program program = nullptr;
  if (const int error = functions_->create(&program, composition.text.c_str(), "composition.cu", 0, nullptr, nullptr)) {
    cubin.log = std::string("nvrtcCreateProgram: ") + functions_->words(error);
    return cubin;
  }
  std::vector<std::string> words = options(architecture);
  if (verbose) words.emplace_back("--ptxas-options=-v");
  std::vector<const char*> pointers;
  for (const std::string& word : words) pointers.push_back(word.c_str());
  const int error = functions_->compile(program, static_cast<int>(pointers.size()), pointers.data());
  std::size_t size = 0;
  if (functions_->log_size(program, &size) == 0 && size > 1) {  // the size counts the closing zero
    cubin.log.resize(size);
    functions_->log(program, cubin.log.data());
    cubin.log.resize(size - 1);
  }
  if (error)
    cubin.log = composition.name + ": " + functions_->words(error) + "\n" + cubin.log;
  else if (functions_->code_size(program, &size) == 0 && size > 0) {
    cubin.code.resize(size);
    cubin.compiled = functions_->code(program, cubin.code.data()) == 0;
  }
  functions_->destroy(&program);
  return cubin;
}

}  // namespace mpm::device
