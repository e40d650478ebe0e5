#include "run/books.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string_view>

namespace mpm::app {

std::string warning_of_books(const Ledger& ledger, const BookScales& scales) {
  const double rounding = 64 * scales.epsilon * std::sqrt(scales.steps);
  double energy = scales.energy;
  for (const auto& [name, value, sign, turn, unit] : ledger_entries)
    if (std::string_view(unit) == "J" && !std::string_view(name).ends_with(" book"))
      energy = std::max(energy, std::abs(ledger.*value));
  const auto exceeds = [&](double off, double whole) { return !(std::abs(off) <= rounding * whole); };  // so does NaN
  std::ostringstream warning;
  if (const double off = std::abs(ledger.grid_book) + std::abs(ledger.filter_book); exceeds(off, energy))
    warning << "the grid's kinetic energy changed by " << off << " J more than the recorded impulses explain";
  else if (exceeds(ledger.mass_book, std::sqrt(scales.steps) * scales.mass))
    warning << "the nodes were given " << ledger.mass_book << " kg less than the particles have, summed over the steps";
  else if (exceeds(ledger.momentum_book, std::sqrt(scales.steps) * scales.momentum))
    warning << "the nodes were given a momentum that is " << ledger.momentum_book
            << " kg m/s beside that of the particles, summed over the steps";
  else
    return "";
  return warning.str() + ": a fault of the program or of a plugin; report it with this experiment";
}

}  // namespace mpm::app
