#pragma once
// Whether the books of a run's energy ledger agree, which those of a right program do to rounding.

#include <string>

#include "simulation/backend.hpp"

namespace mpm::app {

/// The sizes beside which the books of a run are rounding.
struct BookScales {
  double epsilon = 0;   ///< of the backend's floating-point numbers
  double steps = 0;     ///< how many there were
  double energy = 0;    ///< J, largest total energy of the run
  double mass = 0;      ///< kg, of all particles
  double momentum = 0;  ///< kg m/s, sum of the sizes of all particles' momenta
};

/// What a book is off by beyond rounding; "" where all agree. One that is no number does not agree. Rounding of
/// energies goes up and down from step to step, so that it adds up as the root of their number; that of mass keeps its sign,
/// and the book of momentum adds up sizes. The bounds are 64 epsilon, which tests/verification/ledger_books.cpp holds. The
/// book of the materials is left out: in a right program it falls with the square of the step and is far above rounding, so
/// that a run alone has no bound for it; two runs with different steps have (tests/faults/ledger.cpp plants such a fault).
std::string warning_of_books(const Ledger& ledger, const BookScales& scales);

}  // namespace mpm::app
