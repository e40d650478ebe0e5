#pragma once
// Machine instructions of a piece of a program, counted one by one.

#include <functional>
#include <optional>

namespace mpm::counting {

struct Instructions {
  long all = 0;
  /// Instructions without those of the C library and the clock: the heap takes other paths for other histories.
  long own = 0;
};

/// Instructions of `counted`, executed after `prepare` in a forked process that is single-stepped (ptrace). Both run in
/// that process only. The result is empty where the machine refuses, or when the process fails; kernel instructions do
/// not count.
std::optional<Instructions> count_instructions(const std::function<void()>& prepare,
                                               const std::function<void()>& counted);

}  // namespace mpm::counting
