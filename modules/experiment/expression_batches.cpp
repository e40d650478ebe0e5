// Expressions at many points at once, and what is wrong at one of them.

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "experiment/diagnostics.hpp"
#include "experiment/expression_formulas.hpp"

namespace mpm {
namespace {

using formula::batch_size;

/// The number of the first value that is not finite.
template <class T>
int finite_before(const formula::Values<T>& values, int count) {
  if (values.same_everywhere()) return std::isfinite(values[0]) ? count : 0;
  // The exponent of what is not finite is all ones, and one more carries into the sign.
  using Bits = std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>;
  constexpr Bits one = Bits(1) << (std::numeric_limits<T>::digits - 1), sign = Bits(1) << (8 * sizeof(T) - 1);
  Bits carried = 0;
  for (int p = 0; p < count; ++p) carried |= (std::bit_cast<Bits>(values.values[p]) & (sign - one)) + one;
  if ((carried & sign) == 0) return count;
  int p = 0;
  while (std::isfinite(values[p])) ++p;
  return p;
}

/// Calls take(p, value) for each point.
template <class T, class Take>
void for_each(const formula::Values<T>& values, int count, Take take) {
  if (values.same_everywhere())
    for (int p = 0; p < count; ++p) take(p, values[0]);
  else
    for (int p = 0; p < count; ++p) take(p, values.values[p]);
}

/// Runs a program for all points: fill(variable, first, count, to) writes a variable's values, and
/// take(output, first, count, values) reads those of an output.
template <class T, class Fill, class Take>
std::size_t run(const formula::Program& program, std::uint64_t id, int outputs, std::size_t count, double t, Fill fill,
                Take take) {
  thread_local formula::Space<T> space;
  // A thread that evaluates one program for chunk after chunk finds what depends on time alone once.
  thread_local std::pair<std::uint64_t, std::uint64_t> found{0, 0};
  if (const std::pair now{id, std::bit_cast<std::uint64_t>(t)}; now != found) program.begin(t, space), found = now;
  std::size_t finite = count;
  for (std::size_t first = 0; first < count; first += batch_size) {
    const int n = static_cast<int>(std::min<std::size_t>(batch_size, count - first));
    const int lanes = (n + formula::pack_size<T> - 1) / formula::pack_size<T> * formula::pack_size<T>;
    for (int variable = 0; variable < formula::time_variable; ++variable) {
      T* const to = program.input(variable, space);
      if (!to) continue;
      fill(variable, first, n, to);
      std::fill(to + n, to + lanes, to[n - 1]);  // a full pack does what a part of one would, to the last bit
    }
    formula::Program::run(space, lanes);
    for (int output = 0; output < outputs; ++output) {
      const formula::Values<T> values = program.output(output, space);
      take(output, first, n, values);
      if (const int good = finite_before(values, n); good < n) finite = std::min(finite, first + good);
    }
  }
  return finite;
}

/// Fills variables from positions and initial positions.
auto from(std::span<const Vector3> x, std::span<const Vector3> X) {
  return [x, X](int variable, std::size_t first, int n, double* to) {
    const Vector3* const points = (variable < 3 ? x : X).data() + first;
    for (int p = 0; p < n; ++p) to[p] = points[p][variable % 3];
  };
}

}  // namespace

template <class T>
std::size_t VectorExpression::evaluate(std::size_t count, const PointArrays<T>& at, double t,
                                       const std::array<T*, 3>& result) const {
  if (!formulas_) {
    for (std::size_t c = 0; c < 3; ++c)
      if (result[c]) std::fill_n(result[c], count, static_cast<T>(constant_[c]));
    return count;
  }
  const auto fill = [&](int variable, std::size_t first, int n, T* to) {
    if (const T* const values = variable < 3 ? at.x[variable] : at.X[variable - 3])
      std::copy_n(values + first, n, to);
    else
      std::fill_n(to, n, T(0));
  };
  return run<T>(formulas_->all, formulas_->id, 3, count, t, fill,
                [&](int c, std::size_t first, int n, const formula::Values<T>& values) {
                  if (T* const to = result[c]) for_each(values, n, [&](int p, T value) { to[first + p] = value; });
                });
}

template std::size_t VectorExpression::evaluate(std::size_t, const PointArrays<double>&, double,
                                                const std::array<double*, 3>&) const;
template std::size_t VectorExpression::evaluate(std::size_t, const PointArrays<float>&, double,
                                                const std::array<float*, 3>&) const;

std::size_t VectorExpression::evaluate(std::span<const Vector3> x, std::span<const Vector3> X, double t,
                                       std::span<Vector3> result) const {
  if (!formulas_) {
    std::fill_n(result.begin(), x.size(), constant_);
    return x.size();
  }
  return run<double>(formulas_->all, formulas_->id, 3, x.size(), t, from(x, X),
                     [&](int c, std::size_t first, int n, const formula::Values<double>& values) {
                       for_each(values, n, [&](int p, double value) { result[first + p][c] = value; });
                     });
}

std::size_t VectorExpression::evaluate(int component, std::span<const Vector3> x, std::span<const Vector3> X, double t,
                                       double* result) const {
  if (!formulas_) {
    std::fill_n(result, x.size(), constant_[component]);
    return x.size();
  }
  return run<double>(formulas_->components[component], formulas_->id + 1 + static_cast<std::uint64_t>(component), 1,
                     x.size(), t, from(x, X),
                     [&](int, std::size_t first, int n, const formula::Values<double>& values) {
                       for_each(values, n, [&](int p, double value) { result[first + p] = value; });
                     });
}

const formula::Graph* VectorExpression::graph() const {
  return formulas_ ? &formulas_->graph : nullptr;
}
std::vector<int> VectorExpression::terms() const {
  return formulas_ ? formulas_->terms : std::vector<int>();
}

std::size_t VectorExpression::operations_at_points() const {
  return formulas_ ? formulas_->all.instructions().size() : 0;
}
std::size_t VectorExpression::operations_of_call() const {
  return formulas_ ? formulas_->all.call_instructions().size() : 0;
}

// ---- what is not finite ---------------------------------------------------------------------------------------------

namespace {

/// The term that makes a value not finite, out of finite ones.
int culprit(const formula::Graph& graph, const std::vector<double>& values, int number) {
  const formula::Term& term = graph.terms()[number];
  const int count = formula::operands(term.operation);
  if (term.operation == formula::Operation::choose) {
    if (!std::isfinite(values[term.of[0]])) return culprit(graph, values, term.of[0]);
    return culprit(graph, values, term.of[values[term.of[0]] != 0 ? 1 : 2]);
  }
  for (int i = 0; i < count; ++i)
    if (!std::isfinite(values[term.of[i]])) return culprit(graph, values, term.of[i]);
  return number;
}

/// An operation with the values that it is given: "log(-1)", "1 / 0".
std::string with_values(const formula::Term& term, const std::vector<double>& values) {
  using formula::Operation;
  std::string text;
  for (int i = 0; i < formula::operands(term.operation); ++i)
    text += (i > 0 ? ", " : "") + number_text(values[term.of[i]]);
  const auto operators = {std::pair{Operation::add, "+"},      std::pair{Operation::subtract, "-"},
                          std::pair{Operation::multiply, "*"}, std::pair{Operation::divide, "/"},
                          std::pair{Operation::power, "^"},    std::pair{Operation::whole_power, "^"}};
  for (const auto& [operation, sign] : operators)
    if (operation == term.operation)
      return number_text(values[term.of[0]]) + " " + sign + " " + number_text(values[term.of[1]]);
  for (const formula::Function& function : formula::functions())
    if (function.operation == term.operation) return std::string(function.name) + "(" + text + ")";
  return "";
}

}  // namespace

std::optional<NotFinite> VectorExpression::not_finite(const Vector3& x, const Vector3& X, double t) const {
  if (!formulas_) return std::nullopt;
  const std::array<double, 7> variables{x[0], x[1], x[2], X[0], X[1], X[2], t};
  std::vector<double> values;
  for (const formula::Term& term : formulas_->graph.terms()) {
    std::array<double, 3> of{term.variable < 0 ? term.constant : variables[term.variable], 0, 0};
    for (int i = 0; i < formula::operands(term.operation); ++i) of[i] = values[term.of[i]];
    values.push_back(formula::value_of(term.operation, of[0], of[1], of[2]));
  }
  for (std::size_t c = 0; c < 3; ++c) {
    const double value = values[formulas_->terms[c]];
    if (std::isfinite(value)) continue;
    const formula::Term& term = formulas_->graph.terms()[culprit(formulas_->graph, values, formulas_->terms[c])];
    NotFinite found{static_cast<int>(c), value, ""};
    if (term.end > 0)
      found.why = in_quotes(formulas_->text[term.text].substr(term.first, term.end - term.first)) + " at character " +
                  std::to_string(term.first + 1);
    const std::string numbers = with_values(term, values);
    if (!numbers.empty()) found.why += (found.why.empty() ? "" : " is ") + numbers;
    return found;
  }
  return std::nullopt;
}

}  // namespace mpm
