#pragma once
// What a backend may offer beside Backend where its particles lie far from the host.

#include <optional>

#include "metrics/totals.hpp"

namespace mpm {

class OffersTotals {
 public:
  virtual ~OffersTotals() = default;

  /// Sums and extremes of a body's particles now, as Metrics makes them of its state, but for times and errors, and with
  /// sums of m x and m x × v in place of the centre of mass and what refers to it; nothing for a body without particles.
  virtual std::optional<Totals> totals_of(int body) const = 0;
};

}  // namespace mpm
