#pragma once
// The formulas that kernels evaluate at particles. The composer writes each as a function of the scene, a line an
// operation. What does not differ from particle to particle, numbers in the file and what follows from the time alone,
// is found by the host in double precision and handed over as an array: so a graph may be launched at another time, and
// another number in the file asks for no other program, unless it is an exponent, a one, or becomes equal to another.

#include <map>
#include <string>
#include <vector>

#include "experiment/experiment.hpp"

namespace mpm::device {

class ParticleFormulas {
 public:
  explicit ParticleFormulas(const Experiment& experiment);

  bool any() const { return !calls_.empty(); }
  /// Whether any of them asks where a particle began, or a spring does.
  bool use_initial_position() const { return use_initial_position_; }
  bool use_time() const { return use_time_; }
  /// Static functions of the scene: acceleration(body, x, X, numbers), velocity_of_grip(grip, x, X, numbers) and
  /// load_value(load, x, X, numbers) of a load at points; empty where there are neither formulas nor loads at points.
  std::string text() const;
  /// How many numbers the functions take.
  std::size_t count() const;
  /// The numbers for a step between two times, s: forces are those of its begin, grips move as they do at its end.
  std::vector<double> numbers(double begin, double end) const;

 private:
  /// A formula in use: its function, and the numbers that this takes. Formulas that differ in numbers alone share one.
  struct Call {
    const VectorExpression* formula;
    int function;
    bool at_end;             ///< of the step
    std::size_t first;       ///< of the numbers
    std::vector<int> terms;  ///< [number] its term; of formulas without variables its component
  };
  /// An acceleration of a body, or of all.
  struct Acceleration {
    std::size_t call;
    int body;
  };
  /// The value of a load at points.
  struct Value {
    std::size_t call, load;
  };
  static constexpr int all_bodies = -1;

  /// Returns the number of the call.
  std::size_t add(const VectorExpression& formula, bool at_end);
  std::string call_text(std::size_t call) const;

  int dimension_;
  bool use_initial_position_ = false, use_time_ = false, loads_at_points_ = false;
  std::map<std::string, int> known_;    ///< number of a function by its text
  std::vector<std::string> functions_;  ///< their texts from the parameters on
  std::vector<Call> calls_;
  std::vector<Acceleration> accelerations_;
  std::vector<std::size_t> velocities_;  ///< calls, of each grip
  std::vector<Value> values_;
};

}  // namespace mpm::device
