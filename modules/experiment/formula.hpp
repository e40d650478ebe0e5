#pragma once
// The operations of formulas as a graph in which equal terms stand once, whichever formula they come from.

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

namespace mpm::formula {

enum class Operation : std::uint8_t {
  constant,
  variable,
  negate,  // functions of one value from here
  sin,
  cos,
  tan,
  asin,
  acos,
  atan,
  sinh,
  cosh,
  tanh,
  exp,
  log,
  sqrt,
  abs,
  floor,
  add,  // functions of two values from here
  subtract,
  multiply,
  divide,
  power,
  whole_power,  ///< the second value is a whole number, known when the formula is read
  atan2,
  min,
  max,
  less,
  greater,
  less_or_equal,
  greater_or_equal,
  equal,
  unequal,
  both,
  either,
  choose  ///< the second value where the first is not zero, else the third
};

/// The number of values an operation takes, 0 to 3.
int operands(Operation operation);

/// The value of an operation for numbers, by the C library. Unused values are ignored.
double value_of(Operation operation, double a, double b, double c);

/// What a function of formulas takes and does.
struct Function {
  const char* name;
  Operation operation;
  int least, most;  ///< number of arguments
};
const std::vector<Function>& functions();

/// Numbers of the variables x y z X Y Z t in a node.
inline constexpr std::string_view variable_letters = "xyzXYZt";
inline constexpr int time_variable = 6;

struct Term {
  Operation operation = Operation::constant;
  std::array<int, 3> of{-1, -1, -1};  ///< numbers of the terms that it takes, all below its own
  double constant = 0;
  int variable = -1;
  bool at_points = false;                    ///< differs from point to point; the others are found once a call
  std::size_t text = 0, first = 0, end = 0;  ///< the first formula that has it, and its characters there
};

/// Terms of formulas, each once. A term stands behind those that it takes. Terms of constants are constants.
class Graph {
 public:
  int constant(double value);
  int variable(int number);
  int apply(Operation operation, int a, int b = -1, int c = -1);

  const std::vector<Term>& terms() const { return terms_; }
  /// Notes where a term is written, unless an earlier place is known.
  void written(int term, std::size_t text, std::size_t first, std::size_t end);

 private:
  int add(const Term& term);
  int power(int base, int exponent);
  int unchanged(Operation operation, const std::array<int, 3>& of) const;

  std::vector<Term> terms_;
  std::map<std::tuple<Operation, std::array<int, 3>, std::uint64_t, int>, int> known_;
};

/// Adds a formula that muParser accepts, and returns the number of its term. Throws std::invalid_argument where the
/// text is none. `constants` are names with values, `text_number` is kept in its terms.
int parse(const std::string& text, const std::vector<std::pair<std::string, double>>& constants,
          std::size_t text_number, Graph& graph);

}  // namespace mpm::formula
