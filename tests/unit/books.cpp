// The warning of books of the ledger that do not agree.

#include "run/books.hpp"

#include <cmath>
#include <limits>

#include "support/catch.hpp"

using namespace mpm;

namespace {

constexpr double eps = std::numeric_limits<float>::epsilon();
/// 10,000 steps in float: rounding is 64 eps times 100 of energies, times 10,000 of mass and momentum.
constexpr app::BookScales scales{eps, 1e4, 5, 3, 7};

bool warns_of(double Ledger::*book, double value, const std::string& words) {
  Ledger ledger;
  ledger.*book = value;
  const std::string warning = app::warning_of_books(ledger, scales);
  return warning.find(words) != std::string::npos;
}

}  // namespace

TEST_CASE("books that are off by more than rounding are warned of, each by its own words", "[ledger]") {
  CHECK(app::warning_of_books({}, scales).empty());
  struct Row {
    double Ledger::*book;
    double bound;
    const char* words;
  };
  for (const Row& row : {Row{&Ledger::grid_book, 6400 * eps * 5, "kinetic energy"},
                         {&Ledger::filter_book, 6400 * eps * 5, "kinetic energy"},
                         {&Ledger::mass_book, 640000 * eps * 3, "kg less than the particles"},
                         {&Ledger::momentum_book, 640000 * eps * 7, "kg m/s beside"}}) {
    INFO(row.words);
    CHECK(warns_of(row.book, 1.001 * row.bound, row.words));
    CHECK(warns_of(row.book, std::nan(""), row.words));
    CHECK(!warns_of(row.book, 0.999 * row.bound, row.words));
  }
  Ledger both;  // books of energies add up, whatever their signs
  both.grid_book = 0.6 * 6400 * eps * 5, both.filter_book = -both.grid_book;
  CHECK(!app::warning_of_books(both, scales).empty());
  CHECK(!warns_of(&Ledger::material_book, 1, "fault"));  // it falls with the step, and is no rounding
}

TEST_CASE("works larger than the energy are what books are compared with", "[ledger]") {
  Ledger ledger;
  ledger.grid_book = 6400 * eps * 50;
  CHECK(!app::warning_of_books(ledger, scales).empty());
  ledger.scatter = -60;
  CHECK(app::warning_of_books(ledger, scales).empty());
}
