// The largest stable step C_max = c dt / h of a periodic elastic line with one particle a cell, found by bisection
// through runs, for every order of the stress update, transfer and filter that the table of docs/verification.md has a
// column for. `ctest -V` shows the table.
//
// That table is of 16 cells, not of a long line. With s2 the squared symbol of the shape, z = dt times that of its
// gradient, q = 1 - (1 - s2)^k and K = q / s2, the trace and determinant of one step of a wave are
//   USL-FLIP      2 - z^2           1 - z^2 (1 - s2)
//   MUSL, USF     a + 1 - s2 z^2    a                          a = 1 of FLIP, s2 of PIC
//   USL-XPIC(k)   q + 1 - z^2       q (1 - z^2) + s2 z^2       k = 1: PIC
//   USL-FMPM(k)   q + 1 - K z^2     q
// and the wave is bounded where |trace| <= 1 + det and det <= 1. C_max is the least over the waves that fit the line.
// USF-PIC, linear: z = 2 C sin(theta / 2), s2 = cos^2(theta / 2) = x give C^2 <= (1 + x) / (2 x (1 - x)), least at
// x = sqrt(2) - 1 with C = 1 + 1 / sqrt(2) = 1.7071; of 16 cells theta = pi / 2 comes closest: C = sqrt(3) = 1.732, the
// value of the table, beyond the +-0.005 that it is meant to hold with. Row 1 of FMPM(k) has its limit at theta = pi,
// where s2 = 0 and K = k: C = 1 / sqrt(2 k) for every even number of cells. The tests therefore find the table on 16
// cells, and on 32 cells the limits of these formulas.

#include <array>
#include <cstdio>

#include "lattice.hpp"
#include "support/catch.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

enum class Scheme { flip_last, pic_last, flip_other, pic_other, xpic, fmpm };

struct Column {
  const char* name;
  Scheme scheme;
  int order;  ///< order of the filter
  const char *transfer, *update;
};

constexpr std::array columns{
    Column{"USL-FLIP", Scheme::flip_last, 1, "flip", "last"},
    Column{"USL-PIC", Scheme::pic_last, 1, "pic", "last"},
    Column{"MUSL-FLIP", Scheme::flip_other, 1, "flip", "modified_last"},
    Column{"USF-FLIP", Scheme::flip_other, 1, "flip", "first"},
    Column{"MUSL-PIC", Scheme::pic_other, 1, "pic", "modified_last"},
    Column{"USF-PIC", Scheme::pic_other, 1, "pic", "first"},
    Column{"XPIC2", Scheme::xpic, 2, "pic", "last"},
    Column{"FMPM2", Scheme::fmpm, 2, "pic", "last"},
    Column{"FMPM4", Scheme::fmpm, 4, "pic", "last"},
};

struct Row {
  const char* name;
  std::vector<std::string> shapes;  ///< shapes that are the same where particles are boxes of one cell
  double offset;                    ///< 0: particles at cell centres, 1/2: on nodes
  std::array<double, columns.size()> table;
};

const double root_half = std::sqrt(0.5);

const std::vector<Row>& rows() {
  static const std::vector<Row> all{
      {"centre, linear",
       {"linear", "bspline_quadratic", "gimp", "gimp_contiguous", "cpdi"},
       0,
       {root_half, root_half, 2.0, 2.0, 1.732, 1.732, root_half, 0.5, std::sqrt(0.125)}},
      {"centre, cubic",
       {"bspline_cubic", "b2gimp"},
       0,
       {1.373, 1.405, 2.699, 2.699, 2.430, 2.430, 1.399, 1.000, 0.7071}},
      {"node, quadratic",
       {"bspline_quadratic", "gimp", "gimp_contiguous"},
       0.5,
       {1.668, 1.768, 2.560, 2.560, 2.357, 2.357, 1.704, 1.579, 1.458}},
      {"node, cubic",
       {"bspline_cubic", "b2gimp"},
       0.5,
       {1.604, 1.700, 2.726, 2.726, 2.461, 2.461, 1.647, 1.432, 1.262}},
  };
  return all;
}

struct Symbol {
  double weight, gradient;  ///< moduli of the shape's symbol and of its derivative's, in units of 1 / h
};

Symbol symbol_of(std::size_t row, double theta) {
  switch (row) {
    case 0:
      return {std::cos(theta / 2), 2 * std::sin(theta / 2)};
    case 1:
      return {(23 * std::cos(theta / 2) + std::cos(1.5 * theta)) / 24,
              (5 * std::sin(theta / 2) + std::sin(1.5 * theta)) / 4};
    case 2:
      return {(3 + std::cos(theta)) / 4, std::sin(theta)};
    default:
      return {(2 + std::cos(theta)) / 3, std::sin(theta)};
  }
}

bool is_bounded(const Column& column, double s2, double z2) {
  const double kept = 1 - std::pow(1 - s2, column.order);
  // In the limit of s2 = 0 the K of FMPM is the order.
  const double K = s2 > 1e-12 ? kept / s2 : column.order;
  double trace = 0, det = 0;
  switch (column.scheme) {
    case Scheme::flip_last:
      trace = 2 - z2, det = 1 - z2 * (1 - s2);
      break;
    case Scheme::flip_other:
      trace = 2 - s2 * z2, det = 1;
      break;
    case Scheme::pic_other:
      trace = s2 + 1 - s2 * z2, det = s2;
      break;
    case Scheme::fmpm:
      trace = kept + 1 - K * z2, det = kept;
      break;
    case Scheme::pic_last:
    case Scheme::xpic:
      trace = kept + 1 - z2, det = kept * (1 - z2) + s2 * z2;
      break;
  }
  return std::abs(trace) <= 1 + det + 1e-12 && det <= 1 + 1e-12;
}

/// The limit C_max by the formulas above.
double exact_limit(std::size_t row, const Column& column, int cells) {
  const auto all_bounded = [&](double courant) {
    for (int n = 1; 2 * n <= cells; ++n) {
      const Symbol s = symbol_of(row, 2 * std::numbers::pi * n / cells);
      const double z = courant * s.gradient;
      if (!is_bounded(column, s.weight * s.weight, z * z)) return false;
    }
    return true;
  };
  double low = 0, high = 4;
  for (int k = 0; k < 50; ++k) {
    const double middle = 0.5 * (low + high);
    (all_bounded(middle) ? low : high) = middle;
  }
  return low;
}

/// Whether random velocities of 1e-8 stay bounded for 2000 steps; growth in proportion to time is allowed (a wave of
/// theta = pi strains cells without a force under MUSL and USF), exponential growth is not.
bool stable(const Line& line) {
  const auto noise = [](double x) { return 1e-8 * std::sin(1e4 * std::sin(12.9898 * x + 1)); };
  LineScene scene(line, noise);
  double middle = 0, last = 0;
  try {
    for (int part = 0; part < 100; ++part) {
      scene.step(20);
      last = scene.largest_disturbance();
      if (last > 1e-5) return false;  // a thousand times the noise; beyond, it moves the particles and levels off
      if (part == 49) middle = last;
    }
  } catch (const RunFailure&) {
    return false;
  }
  return last < 4 * middle;
}

/// The line of a run. The shortest wave does not show in the velocities of particles at cell centres: jitter brings it
/// in.
Line line_of(const std::string& shape, const Row& row, const Column& column, int cells) {
  const bool is_filtered = column.scheme == Scheme::xpic || column.scheme == Scheme::fmpm;
  return {.shape = shape,
          .transfer = column.transfer,
          .filter = is_filtered ? filter(column.scheme == Scheme::xpic ? "xpic" : "fmpm", column.order) : "",
          .stress_update = column.update,
          .backend = "cpu",
          .cells = cells,
          .offset = row.offset,
          .jitter = 1e-5};
}

bool stable_at(Line line, double courant) {
  line.time_step = courant;
  return stable(line);
}

/// The limit C_max to within 0.001 by runs, from 3 % below to 3 % above `expected`, both of which are run.
double found_limit(const Line& line, double expected) {
  double low = 0.97 * expected, high = 1.03 * expected;
  if (!stable_at(line, low)) return 0;
  if (stable_at(line, high)) return INFINITY;
  while (high - low > 0.002) {
    const double middle = 0.5 * (low + high);
    (stable_at(line, middle) ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

void print_heading(const char* title) {
  std::printf("%s\n  %-34s", title, "");
  for (const Column& column : columns) std::printf("%10s", column.name);
  std::printf("\n");
}

}  // namespace

TEST_CASE("the table of the largest stable steps, found by runs", "[critical_step]") {
  print_heading("Critical step, C_max of a line of 16 cells");
  for (std::size_t r = 0; r < rows().size(); ++r) {
    const Row& row = rows()[r];
    const auto shapes = shapes_present(row.shapes);
    if (shapes.empty()) continue;
    std::array<double, columns.size()> exact, found;
    for (std::size_t c = 0; c < columns.size(); ++c) {
      exact[c] = exact_limit(r, columns[c], 16);
      found[c] = found_limit(line_of(shapes[0], row, columns[c], 16), exact[c]);
      INFO(row.name << ", " << columns[c].name << ": found " << found[c] << ", formula " << exact[c] << ", table "
                    << row.table[c]);
      CHECK(std::abs(exact[c] - row.table[c]) <= 0.001);
      CHECK(std::abs(found[c] - row.table[c]) <= 0.005);
    }
    for (const auto& [name, values] : {std::pair{"runs", found}, std::pair{"formula", exact}}) {
      std::printf("  %-18s%-16s", row.name, name);
      for (const double value : values) std::printf("%10.4f", value);
      std::printf("\n");
    }
  }
}

TEST_CASE("FMPM at cell centres is stable to 1 / sqrt(2 k)", "[critical_step]") {
  std::printf("Critical step, C_max of FMPM(k), linear functions, particles at cell centres: k, runs, 1 / sqrt(2 k)\n");
  for (const int k : {1, 2, 3, 4, 6, 8, 16}) {
    const Column column{"", Scheme::fmpm, k, "pic", "last"};
    const double expected = 1 / std::sqrt(2.0 * k),
                 found = found_limit(line_of("linear", rows()[0], column, 16), expected);
    std::printf("  %3d %8.4f %8.4f\n", k, found, expected);
    INFO("order " << k << ": found " << found << ", exact " << expected);
    CHECK(exact_limit(0, column, 16) == Approx(expected).epsilon(1e-9));
    CHECK(std::abs(found - expected) <= 0.005 * expected + 0.001);
  }
}

// Here z is 2 C sin(theta / 2) at cell centres and C sin(theta) on nodes (stress_update.cpp).
TEST_CASE("averaged stress updates are stable to z = 2", "[critical_step]") {
  for (const auto& [row, expected] : {std::pair{0, 1.0}, std::pair{2, 2.0}})
    for (const char* transfer : {"flip", "pic"}) {
      const Column column{"", Scheme::flip_other, 1, transfer, "averaged"};
      const double found = found_limit(line_of(rows()[row].shapes[0], rows()[row], column, 16), expected);
      INFO(rows()[row].name << ", " << transfer << ": found " << found << ", exact " << expected);
      CHECK(std::abs(found - expected) <= 0.005);
    }
}

TEST_CASE("shapes that coincide have one limit, and so have both backends", "[critical_step]") {
  for (std::size_t r = 0; r < rows().size(); ++r)
    for (const std::string& shape : shapes_present(rows()[r].shapes))
      for (const Column& column : columns) {
        Line line = line_of(shape, rows()[r], column, 16);
        // The table has been bisected for the first shape of each row on `cpu`.
        if (shape == shapes_present(rows()[r].shapes)[0]) line.backend = "reference";
        const double exact = exact_limit(r, column, 16);
        INFO(shape << ", " << rows()[r].name << ", " << column.name << ", " << line.backend << ", limit " << exact);
        CHECK(stable_at(line, 0.97 * exact));
        CHECK_FALSE(stable_at(line, 1.03 * exact));
      }
}

TEST_CASE("a line of 32 cells has the limits of its own waves", "[critical_step]") {
  print_heading("Critical step, C_max of a line of 32 cells: formula, runs at 1 % below and above");
  for (std::size_t r = 0; r < rows().size(); ++r) {
    const auto shapes = shapes_present(rows()[r].shapes);
    if (shapes.empty()) continue;
    std::printf("  %-34s", rows()[r].name);
    for (const Column& column : columns) {
      const double exact = exact_limit(r, column, 32);
      std::printf("%10.4f", exact);
      const Line line = line_of(shapes[0], rows()[r], column, 32);
      INFO(rows()[r].name << ", " << column.name << ", limit " << exact);
      CHECK(stable_at(line, 0.99 * exact));
      CHECK_FALSE(stable_at(line, 1.01 * exact));
    }
    std::printf("\n");
  }
  // The case's table would miss the limit of USF-PIC on a long line, 1 + 1 / sqrt(2).
  CHECK(exact_limit(0, columns[5], 4096) == Approx(1 + root_half).epsilon(1e-5));
}

TEST_CASE("an unstable line ends as a failed run on both backends", "[critical_step]") {
  const auto noise = [](double x) { return 1e-8 * std::sin(1e4 * std::sin(12.9898 * x + 1)); };
  for (const std::string backend : {"reference", "cpu"}) {
    INFO(backend);
    LineScene scene({.transfer = "flip",
                     .stress_update = "first",
                     .backend = backend,
                     .cells = 32,
                     .jitter = 1e-5,
                     .time_step = 2.02},
                    noise);
    CHECK_THROWS_AS(scene.step(2000), RunFailure);
  }
}
