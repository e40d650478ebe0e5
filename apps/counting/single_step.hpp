#pragma once
// Machine instructions of a piece of a program, counted one by one.

#include <functional>
#include <optional>

namespace mpm::counting {

/// Instructions of `counted`, executed after `prepare` in a forked process that is single-stepped (ptrace). Both run in
/// that process only. None where the machine refuses, or when the process fails; kernel instructions do not count.
std::optional<long> count_instructions(const std::function<void()>& prepare, const std::function<void()>& counted);

}  // namespace mpm::counting
