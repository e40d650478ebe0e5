#pragma once
// Bisection between a stable and an unstable value, one question at a time.

#include <optional>
#include <vector>

namespace mpm::study {

/// A search that asks for the ends first, then for values between them, geometric means, until the bracket is narrow. A
/// stable value beyond an unstable one is not looked for.
class BisectionSearch {
 public:
  /// Begins a search. `from` and `to` differ, have one sign and are not 0.
  BisectionSearch(double from, double to, double relative_tolerance);

  /// The value to try; none when the search is over.
  std::optional<double> next() const;
  /// Takes the answer for the value that `next()` gave.
  void answer(bool is_stable);

  /// The last stable value; none when `from` already is not.
  std::optional<double> stable() const { return stable_; }
  /// The nearest unstable value; none when `to` is stable.
  std::optional<double> unstable() const { return unstable_; }

 private:
  double from_, to_, tolerance_;
  std::optional<double> stable_, unstable_;
  bool over_ = false;
};

}  // namespace mpm::study
