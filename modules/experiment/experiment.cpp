#include "experiment/experiment.hpp"

#include <stdexcept>

namespace mpm {

double Component::parameter(std::string_view name) const {
  if (plugin) {
    for (const mpm_parameter& declared : plugin->parameters()) {
      if (declared.name == name) return parameters.at(declared.offset / sizeof(double));
    }
  }
  throw std::out_of_range((plugin ? std::string(plugin->id()) : "no plugin") + " has no parameter " +
                          std::string(name));
}

std::string Experiment::where(std::string_view pointer) const {
  // A default has no place of its own: the nearest part of the file around it has.
  while (true) {
    for (const auto& [known, place] : positions) {
      if (known != pointer) continue;
      if (place.first == 0) return "command line";
      return file.string() + ":" + std::to_string(place.first) + ":" + std::to_string(place.second);
    }
    if (pointer.empty()) return file.string();
    pointer = pointer.substr(0, pointer.find_last_of('/') == pointer.npos ? 0 : pointer.find_last_of('/'));
  }
}

}  // namespace mpm
