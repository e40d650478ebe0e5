#include "study/bisection.hpp"

#include <cmath>

namespace mpm::study {

BisectionSearch::BisectionSearch(double from, double to, double relative_tolerance)
    : from_(from), to_(to), tolerance_(relative_tolerance) {}

std::optional<double> BisectionSearch::next() const {
  if (over_) return std::nullopt;
  if (!stable_) return from_;
  if (!unstable_) return to_;
  return std::copysign(std::sqrt(*stable_ * *unstable_), from_);
}

void BisectionSearch::answer(bool is_stable) {
  const std::optional<double> value = next();
  if (!value) return;
  const bool first = !stable_, second = !first && !unstable_;
  (is_stable ? stable_ : unstable_) = value;
  if (first && !is_stable) over_ = true;  // there is no stable value to begin from
  if (second && is_stable) over_ = true;  // there is no unstable value to end at
  if (stable_ && unstable_) over_ = over_ || std::abs(*unstable_ - *stable_) <= tolerance_ * std::abs(*stable_);
}

}  // namespace mpm::study
