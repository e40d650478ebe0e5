#include "experiment/experiment.hpp"

#include <algorithm>
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

bool Experiment::any_face(ConditionType type) const {
  for (int axis = 0; axis < dimension; ++axis)
    for (const FaceCondition& face : faces[axis])
      if (face.type == type) return true;
  return false;
}

bool Experiment::separates() const {
  return any_face(ConditionType::separate) || std::any_of(boxes.begin(), boxes.end(), [](const BoxCondition& box) {
           return box.type == ConditionType::separate;
         });
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
