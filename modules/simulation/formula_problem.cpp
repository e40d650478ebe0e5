#include "simulation/formula_problem.hpp"

#include <span>

#include "simulation/failure.hpp"

namespace mpm {

std::string pointer_of(const std::string& pointer, bool is_list, int component) {
  return is_list ? pointer + "/" + std::to_string(component) : pointer;
}

std::string not_finite_text(const std::string& at, const std::string& why) {
  return "is not a finite number at " + at + (why.empty() ? "" : ": " + why);
}

std::string point_text(const Experiment& experiment, const Vector3& x) {
  return point_text(std::span(x).first(static_cast<std::size_t>(experiment.dimension)));
}

}  // namespace mpm
