#pragma once
// Formulas as a list of instructions for many points at once. Every instruction does its work for a batch of points
// before the next one begins, in the lanes of the machine. A program runs in double or, with twice the lanes, in float.

#include <array>
#include <vector>

#include "experiment/formula.hpp"

namespace mpm::formula {

inline constexpr int batch_size = 64;  ///< points of one run of a program
/// Points by which a run grows; no machine has more lanes.
template <class T>
inline constexpr int pack_size = 64 / static_cast<int>(sizeof(T));

template <class T>
struct alignas(64) Register {
  T values[batch_size];
};
/// One number for all points.
template <class T>
struct alignas(64) Pack {
  T values[pack_size<T>];
};

/// Where an instruction finds a value.
struct Source {
  enum class Kind : std::uint8_t { none, in_register, constant, of_call };
  Kind kind = Kind::none;
  int index = 0;
};

/// What an instruction does next with its result a and a third value c: a + c, a - c, c - a or a c, rounded apart.
enum class Then : std::uint8_t { nothing, add, subtract, subtract_from, multiply };

template <class T>
struct Step;
template <class T>
using Work = void (*)(const Step<T>& step, int lanes);

struct Instruction {
  Operation operation;
  Then then = Then::nothing;
  bool and_cosine = false;  ///< with a sine: the cosine of the same value too, which shares most of its work
  std::array<Source, 3> of;
  int to = 0, cosine_to = 0;  ///< registers
  int exponent = 0;           ///< of whole_power
};

/// The function that does an instruction in a precision; which it is depends on what it reads, not on where that stands.
template <class T>
Work<T> work_of(const Instruction& instruction);

/// An operation on numbers that are the same at all points, done once a call.
struct CallInstruction {
  Operation operation;
  std::array<Source, 3> of;
};

/// Values of one component at the points of a batch: value p stands at values[p & mask].
template <class T>
struct Values {
  const T* values = nullptr;
  int mask = 0;

  T operator[](int p) const { return values[p & mask]; }
  bool same_everywhere() const { return mask != ~0; }
};

/// An instruction with its addresses in a space.
template <class T>
struct Step {
  Work<T> work;
  Operation operation;
  int exponent;
  T *to, *cosine_to;
  std::array<Values<T>, 3> of;
};

/// What a run works in; each thread has one of its own.
template <class T>
struct Space {
  std::vector<Register<T>> registers;
  std::vector<double> of_call;  ///< what depends on time alone is found in double and rounded once
  std::vector<Pack<T>> constants, packs_of_call;
  std::vector<Step<T>> steps;
};

class Program {
 public:
  Program() = default;
  /// Compiles terms of a graph; -1 for what is not asked.
  Program(const Graph& graph, const std::vector<int>& outputs);

  /// Finds what depends on time alone. Runs follow in this space until another program begins in it.
  template <class T>
  void begin(double t, Space<T>& space) const;
  /// The place for a variable's values at the points, number 0 to 5; null where no instruction reads it.
  template <class T>
  T* input(int variable, Space<T>& space) const {
    return inputs_[variable] < 0 ? nullptr : space.registers[inputs_[variable]].values;
  }
  /// Runs for the first `lanes` points, a multiple of pack_size.
  template <class T>
  static void run(const Space<T>& space, int lanes) {
    for (const Step<T>& step : space.steps) step.work(step, lanes);
  }
  template <class T>
  Values<T> output(std::size_t number, const Space<T>& space) const {
    return find(outputs_[number], space);
  }

  const std::vector<Instruction>& instructions() const { return instructions_; }
  const std::vector<CallInstruction>& call_instructions() const { return call_instructions_; }
  int registers() const { return registers_; }

 private:
  template <class T>
  static Values<T> find(const Source& source, const Space<T>& space) {
    switch (source.kind) {
      case Source::Kind::in_register:
        return {space.registers[source.index].values, ~0};
      case Source::Kind::constant:
        return {space.constants[source.index].values, pack_size<T> - 1};
      case Source::Kind::of_call:
        return {space.packs_of_call[source.index].values, pack_size<T> - 1};
      default:
        return {};
    }
  }

  std::vector<Instruction> instructions_;
  std::vector<CallInstruction> call_instructions_;
  std::vector<double> constants_;
  std::vector<Source> outputs_;
  std::array<int, 6> inputs_{-1, -1, -1, -1, -1, -1};
  int registers_ = 0;
};

}  // namespace mpm::formula
