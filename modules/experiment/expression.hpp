#pragma once
// Formulas of position and time in experiment files, evaluated by muParser.

#include <array>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "experiment/vector3.hpp"

namespace mpm {

/// A formula that cannot be used; the message quotes it and says where in it the mistake is.
class ExpressionError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Names a formula may use beside the functions and `pi`.
struct ExpressionScope {
  std::string variables = "xyzXYZt";  ///< one letter each, of xyz (position), XYZ (initial position), t (time)
  std::vector<std::pair<std::string, double>> constants;
};

/// Throws ExpressionError when `text` is no formula over `scope`.
void check_expression(const std::string& text, const ExpressionScope& scope);

/// Functions a formula may call, and names a constant may not take.
std::vector<std::string> expression_functions();

/// Up to three numbers or formulas of x y z (position, m), X Y Z (initial position, m) and t (s), in SI. The class is a
/// value: copies share the text, and cost nothing when constant. Evaluation is thread-safe: each thread parses a
/// formula once and keeps its own parser.
class VectorExpression {
 public:
  using Term = std::variant<double, std::string>;

  VectorExpression() = default;  ///< the zero vector
  explicit VectorExpression(const Vector3& constant) : constant_(constant) {}
  /// Parses the terms. Throws ExpressionError. Formulas without variables are evaluated here, once.
  VectorExpression(std::span<const Term> terms, const ExpressionScope& scope);

  Vector3 operator()(const Vector3& x, const Vector3& X, double t) const;
  /// Evaluates one component at many positions, which are the initial ones too.
  void evaluate(int component, std::span<const Vector3> x, double t, double* result) const;

  bool is_constant() const { return !program_; }
  bool uses_position() const { return uses_position_; }
  bool uses_initial_position() const { return uses_initial_position_; }
  bool uses_time() const { return uses_time_; }
  /// Whether one component changes along an axis when position and initial position do.
  bool varies(int component, int axis) const { return varies_[component][axis]; }

 private:
  struct Program;
  struct Instance;
  static Instance& instance_of_this_thread(const std::shared_ptr<const Program>& program);

  Vector3 constant_{};                      ///< the components that are constant
  std::shared_ptr<const Program> program_;  ///< null when all components are constant
  bool uses_position_ = false, uses_initial_position_ = false, uses_time_ = false;
  std::array<std::array<bool, 3>, 3> varies_{};
};

/// One number or formula of the same variables: the first component of a VectorExpression.
class ScalarExpression {
 public:
  ScalarExpression() = default;  ///< the number zero
  explicit ScalarExpression(double constant) : first_(Vector3{constant, 0, 0}) {}
  explicit ScalarExpression(VectorExpression first) : first_(std::move(first)) {}

  double operator()(const Vector3& x, const Vector3& X, double t) const { return first_(x, X, t)[0]; }
  /// Evaluates the formula at many positions, which are the initial ones too.
  void evaluate(std::span<const Vector3> x, double t, double* result) const { first_.evaluate(0, x, t, result); }

  bool is_constant() const { return first_.is_constant(); }
  bool uses_time() const { return first_.uses_time(); }
  /// Whether the value changes along an axis when position and initial position do.
  bool varies(int axis) const { return first_.varies(0, axis); }

 private:
  VectorExpression first_;
};

}  // namespace mpm
