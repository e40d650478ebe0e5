#include "experiment/problem_at.hpp"

namespace mpm {

Problem problem_at(const Experiment& experiment, const std::string& pointer, const std::string& message) {
  for (const auto& [known, place] : experiment.positions)
    if (known == pointer && place.first > 0)
      return {experiment.file.string(), place.first, place.second, pointer, message};
  return {experiment.where(pointer), 0, 0, pointer, message};
}

}  // namespace mpm
