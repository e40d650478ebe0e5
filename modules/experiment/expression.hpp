#pragma once
// Formulas of position and time in experiment files. muParser checks them and evaluates single points; a program of its
// own (formula_program.hpp) evaluates many.

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "experiment/vector3.hpp"

namespace mpm {

namespace formula {
class Graph;
}

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

/// Functions a formula may call.
std::vector<std::string> expression_functions();

/// Whether a constant may be called so: a name that means nothing in formulas yet.
bool is_free_in_formulas(const std::string& name);

/// Places of points as arrays of one coordinate each, m; null where there is none, which counts as 0.
template <class T = double>
struct PointArrays {
  std::array<const T*, 3> x{}, X{};
};

/// Why a formula has no finite value at a point.
struct NotFinite {
  int component = 0;  ///< the first without one
  double value = 0;   ///< nan, inf or -inf
  std::string why;    ///< "\"log(x)\" at character 3 is log(-1)"
};

/// Up to three numbers or formulas of x y z (position, m), X Y Z (initial position, m) and t (s), in SI. The class is a
/// value: copies share the text, and cost nothing when constant. Evaluation is thread-safe: each thread has a parser
/// and a work space of its own.
///
/// Many points are evaluated by one compiled program of all components: constants are folded, equal terms are found
/// once, terms of t alone once a call, the rest in lanes. It is much faster than single points and agrees with them to
/// rounding (sin and cos are within 1.5 ulp, exp and log within 1, small whole powers are products). A point has the same bits
/// wherever it stands among others, on any thread. All evaluate() return the number of points before the first one
/// where a value is not finite; values are written for all points nevertheless.
class VectorExpression {
 public:
  using Term = std::variant<double, std::string>;

  VectorExpression() = default;  ///< the zero vector
  explicit VectorExpression(const Vector3& constant) : constant_(constant) {}
  /// Parses the terms. Throws ExpressionError. Formulas without variables are evaluated here, once.
  VectorExpression(std::span<const Term> terms, const ExpressionScope& scope);

  Vector3 operator()(const Vector3& x, const Vector3& X, double t) const;
  /// Evaluates at many points, in the precision of their places; what depends on t alone is found in double in either.
  /// `result` holds an array a component, null where a component is not wanted. For double and float.
  template <class T>
  std::size_t evaluate(std::size_t count, const PointArrays<T>& at, double t, const std::array<T*, 3>& result) const;
  /// Evaluates at many positions x with initial positions X; `result` is as long as they are.
  std::size_t evaluate(std::span<const Vector3> x, std::span<const Vector3> X, double t,
                       std::span<Vector3> result) const;
  /// Evaluates one component at many positions x with initial positions X.
  std::size_t evaluate(int component, std::span<const Vector3> x, std::span<const Vector3> X, double t,
                       double* result) const;
  /// The same at positions that are the initial ones too.
  std::size_t evaluate(int component, std::span<const Vector3> x, double t, double* result) const {
    return evaluate(component, x, x, t, result);
  }

  /// Looks for the operation that gives no finite number at a point; nothing where all values are finite.
  std::optional<NotFinite> not_finite(const Vector3& x, const Vector3& X, double t) const;
  /// The operations that a point costs, for tests: one an instruction of all components.
  std::size_t operations_at_points() const;
  /// The operations that a call costs once, whatever its points.
  std::size_t operations_of_call() const;

  /// The formulas as terms, and which of them the components are; null and empty where all components are constant.
  const formula::Graph* graph() const;
  std::vector<int> terms() const;

  bool is_constant() const { return !formulas_; }
  bool uses_position() const { return uses_position_; }
  bool uses_initial_position() const { return uses_initial_position_; }
  bool uses_time() const { return uses_time_; }
  /// Whether one component changes along an axis when position and initial position do.
  bool varies(int component, int axis) const { return varies_[component][axis]; }

 private:
  struct Formulas;
  struct Instance;
  static Instance& instance_of_this_thread(const std::shared_ptr<const Formulas>& formulas);

  Vector3 constant_{};                        ///< the components that are constant
  std::shared_ptr<const Formulas> formulas_;  ///< null when all components are constant
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
  /// Evaluates the formula at many positions x with initial positions X.
  std::size_t evaluate(std::span<const Vector3> x, std::span<const Vector3> X, double t, double* result) const {
    return first_.evaluate(0, x, X, t, result);
  }
  /// The same at positions that are the initial ones too.
  std::size_t evaluate(std::span<const Vector3> x, double t, double* result) const { return evaluate(x, x, t, result); }
  /// Looks for the operation that gives no finite number at a point.
  std::optional<NotFinite> not_finite(const Vector3& x, const Vector3& X, double t) const {
    return first_.not_finite(x, X, t);
  }

  bool is_constant() const { return first_.is_constant(); }
  bool uses_time() const { return first_.uses_time(); }
  /// Whether the value changes along an axis when position and initial position do.
  bool varies(int axis) const { return first_.varies(0, axis); }

 private:
  VectorExpression first_;
};

}  // namespace mpm
