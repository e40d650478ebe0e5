#pragma once
// Formulas at many points at once, as tests of them ask for them.

#include <span>
#include <string>
#include <vector>

#include "experiment/expression.hpp"

namespace mpm::test {

inline const ExpressionScope formula_scope{"xyzXYZt", {{"A", 0.25}, {"n", 3.0}}};

inline VectorExpression formula_of(const std::string& text) {
  const VectorExpression::Term term = text;
  return VectorExpression(std::span(&term, 1), formula_scope);
}

/// A formula's values at positions x, which are the initial ones too.
inline std::vector<double> values(const VectorExpression& formula, const std::vector<Vector3>& x, double t = 0.5) {
  std::vector<double> found(x.size());
  formula.evaluate(0, x, t, found.data());
  return found;
}

}  // namespace mpm::test
