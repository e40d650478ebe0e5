#include "backends/device/program.hpp"

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <utility>

#include "backends/device/cache.hpp"
#include "backends/device/device.hpp"
#include "backends/device/drivers/cuda.hpp"
#include "backends/device/drivers/host_compiler.hpp"
#include "backends/device/drivers/host_driver.hpp"
#include "backends/device/drivers/nvrtc.hpp"
#include "backends/device/resources.hpp"

namespace mpm::device {
namespace {

class CompilerOfHost final : public Compiler {
 public:
  explicit CompilerOfHost(bool records = false) { compiler_.records = records; }
  std::string identity(const std::string&) const override {
    std::string all = compiler_.program + "\n" + compiler_.version();
    for (const std::string& option : compiler_.all_options()) all += "\n" + option;
    return all;
  }
  std::string compile(const Composition& composition, const std::string&) const override {
    return compiler_.compile(composition);
  }

 private:
  HostCompiler compiler_;
};

class CompilerOfCuda final : public Compiler {
 public:
  explicit CompilerOfCuda(Nvrtc nvrtc) : nvrtc_(std::move(nvrtc)) {}
  std::string identity(const std::string& architecture) const override {
    std::string all = "NVRTC " + nvrtc_.version();
    for (const std::string& option : Nvrtc::options(architecture)) all += "\n" + option;
    return all;
  }
  std::string compile(const Composition& composition, const std::string& architecture) const override {
    Cubin cubin = nvrtc_.compile(composition, architecture);
    if (!cubin.compiled)
      throw CompilerError("NVRTC " + nvrtc_.version() + " does not compile the composition " + composition.name +
                          " for " + architecture + ":\n" + cubin.log);
    return std::move(cubin.code);
  }

 private:
  Nvrtc nvrtc_;
};

constexpr const char* host_name = "host";

/// The seconds since a moment, "2.3".
std::string seconds_since(std::chrono::steady_clock::time_point start) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f",
                std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  return text;
}

DeviceSetup setup_with(const Driver& driver, int number, std::shared_ptr<const Compiler> compiler) {
  DeviceSetup setup;
  setup.driver = &driver, setup.number = number;
  setup.compile = [compiler = std::move(compiler)](const Composition& composition, const std::string& architecture) {
    return program_of(composition, *compiler, architecture);
  };
  return setup;
}

/// What --device names, else what MPM_DEVICE does, else device 0.
std::string chosen_device(const std::string& device) {
  const char* const variable = std::getenv("MPM_DEVICE");
  return !device.empty() ? device : variable && *variable ? variable : "0";
}

}  // namespace

std::string program_of(const Composition& composition, const Compiler& compiler, const std::string& architecture) {
  const ProgramCache cache = ProgramCache::of_user();
  const std::string key = cache_key(composition, compiler.identity(architecture), {architecture});
  if (std::optional<std::string> kept = cache.find(key)) return std::move(*kept);
  const auto start = std::chrono::steady_clock::now();
  std::cerr << "compiling the kernels of this scene (" << composition.name << ") ..." << std::flush;
  try {
    std::string made = compiler.compile(composition, architecture);
    std::cerr << " " << seconds_since(start) << " s\n";
    cache.keep(key, made);
    return made;
  } catch (const CompilerError& error) {
    std::cerr << "\n";
    std::string message = error.what();
    for (const auto& [name, file] : composition.plugins)
      if (message.find(name + ":") != std::string::npos || message.find(name + "(") != std::string::npos)
        message += "\nthe text of " + name + " comes from " + file;
    throw CompilerError(message);
  }
}

bool names_device(const std::string& word) {
  return word == host_name || (!word.empty() && word.size() < 5 &&
                               std::all_of(word.begin(), word.end(), [](unsigned char c) { return std::isdigit(c); }));
}

bool is_host_device(const std::string& device) {
  return chosen_device(device) == host_name;
}

DeviceSetup setup_for(const std::string& device) {
  const std::string chosen = chosen_device(device);
  if (!names_device(chosen))
    throw DeviceError((device.empty() ? "MPM_DEVICE" : "--device") +
                      std::string(": expected \"host\" or the number of ") + "a device, got \"" + chosen +
                      "\"; see mpm list --devices");
  if (chosen == host_name) return setup_with(host_driver(), 0, std::make_shared<CompilerOfHost>());
  std::string why;
  const Driver* const driver = cuda_driver(why);
  if (!driver) throw DeviceError(why);
  std::optional<Nvrtc> nvrtc = Nvrtc::find(why);
  if (!nvrtc)
    throw DeviceError("backend \"cuda\" compiles its kernels for the scene, and " + why +
                      "; or use --backend cpu, or --device host to run the device's kernels on the processor");
  DeviceSetup setup = setup_with(*driver, std::atoi(chosen.c_str()), std::make_shared<CompilerOfCuda>(*nvrtc));
  setup.lanes = lanes_of_gpu;
  return setup;
}

DeviceSetup recording_setup() {
  return setup_with(host_driver(), 0, std::make_shared<CompilerOfHost>(/*records=*/true));
}

std::string device_list() {
  const auto line = [](const std::string& word, const DeviceDescription& device) {
    return word + ": " + device.name + ", " + bytes_in_words(static_cast<double>(device.bytes));
  };
  std::string text, why;
  if (const Driver* const driver = cuda_driver(why))
    for (const DeviceDescription& device : devices_of(*driver))
      text += line(std::to_string(device.number), device) + ", " + device.architecture + "\n";
  else
    text += "no device of CUDA: " + why + "\n";
  if (std::optional<Nvrtc> nvrtc = Nvrtc::find(why))
    text += "compiler: NVRTC " + nvrtc->version() + "\n";
  else
    text += "no compiler of CUDA: " + why + "\n";
  for (const DeviceDescription& device : devices_of(host_driver()))
    text += line(host_name, device) + ", this processor: the device's kernels, compiled by " + HostCompiler{}.program +
            "\n";
  return text;
}

}  // namespace mpm::device
