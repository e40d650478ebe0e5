// Independent pieces of work, done by several threads.
#pragma once

#include <cstddef>
#include <functional>

namespace mpm::support {

/// Calls work(k) for k = 0 ... count - 1, each once, by at most `threads` threads, this one among them. What is done by
/// whom and in which order is not fixed, so that pieces must not share what they change. When pieces throw, no new ones
/// begin, and the exception of the first of them by number is thrown.
void for_each_piece(std::size_t count, int threads, const std::function<void(std::size_t)>& work);

}  // namespace mpm::support
