#pragma once
// How it is said that a formula of the file has no value that can be used: one way for walls, boxes, grips, gravity, loads
// and what bodies begin with.

#include <string>

#include "experiment/problem_at.hpp"

namespace mpm {

/// The pointer of a component of a list of formulas, or that of a formula that stands alone.
std::string pointer_of(const std::string& pointer, bool is_list, int component);

/// The message for a value that is not finite: "is not a finite number at t = 2 s: "1/x" at character 1 is 1 / 0". `at`
/// says where or when, `why` names the operation and may be empty.
std::string not_finite_text(const std::string& at, const std::string& why);

/// A point of the scene in words, with as many coordinates as the scene has dimensions: "(0.1, 0.2) m".
std::string point_text(const Experiment& experiment, const Vector3& x);

}  // namespace mpm
