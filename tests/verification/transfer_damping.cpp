// The table of what one step does to a wave of 32 / n cells, for every transfer and shape that has a row, on both
// backends. `ctest -V` shows it. Factors of other orders of filters and of FLIP are in lattice.cpp.

#include <array>
#include <complex>
#include <cstdio>
#include <numbers>

#include "lattice.hpp"
#include "support/catch.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr std::array modes{1, 2, 4, 8};

struct Row {
  std::vector<std::string> shapes;     ///< shapes that coincide with the first where particles are boxes of one cell
  std::vector<std::string> transfers;  ///< transfers that coincide with the first on this lattice
  double offset = 0;                   ///< 0: at cell centres, or at 1/4 and 3/4 with two a cell; 1/2: on nodes
  int particles_per_cell = 1;
  std::array<double, 4> factors;  ///< factors of modes 1, 2, 4, 8, as docs/verification.md prints them
  double printed = 1e-10;         ///< one unit of their last digit
  bool is_quotient = false;       ///< one step of the seeded mode, v'Mv / v'v: it is no mode of the lattice
};

/// The weight of a node at distance d, in cells.
double weight(const std::string& shape, double d) {
  d = std::abs(d);
  if (shape == "linear") return std::max(0.0, 1 - d);
  if (shape == "bspline_quadratic") return d <= 0.5 ? 0.75 - d * d : d <= 1.5 ? (1.5 - d) * (1.5 - d) / 2 : 0;
  return d <= 1 ? d * d * d / 2 - d * d + 2.0 / 3 : d <= 2 ? (2 - d) * (2 - d) * (2 - d) / 6 : 0;
}

/// The factor in closed form. A particle at x sees of a grid wave e^(i theta n) the velocity W = sum w_n e^(i theta n)
/// and the affine velocity M / D, M = sum w_n (n - x) e^(i theta n), and gives back the conjugates: a step leaves the
/// mean over the cell's particles of |W|^2 + |M|^2 / D, of PIC that of |W|^2. On nodes of the cubic spline
/// W = (2 + cos theta) / 3, M = i sin(theta) / 3 and D = 1/3: ((2 + cos theta) / 3)^2 + sin^2(theta) / 3.
/// The quotient of the particles' wave e^(i theta x) is that of its grid wave, |mean of conj(W) e^(i theta x)|^2.
double closed_form(const Row& row, int mode) {
  const double theta = 2 * std::numbers::pi * mode / 32, D = row.shapes[0] == "bspline_cubic" ? 1.0 / 3 : 0.25;
  double sum = 0;
  std::complex<double> grid_wave = 0;
  for (int k = 0; k < row.particles_per_cell; ++k) {
    const double x = (k + 0.5) / row.particles_per_cell + row.offset;
    std::complex<double> W = 0, M = 0;
    for (int n = -2; n <= 4; ++n) {
      const std::complex<double> term = weight(row.shapes[0], x - n) * std::polar(1.0, theta * n);
      W += term, M += (n - x) * term;
    }
    sum += std::norm(W) + (row.transfers[0] == "pic" ? 0 : std::norm(M) / D);
    grid_wave += std::conj(W) * std::polar(1.0, theta * x);
  }
  return row.is_quotient ? std::norm(grid_wave / static_cast<double>(row.particles_per_cell))
                         : sum / row.particles_per_cell;
}

/// The factor of one step on the mode; for an affine transfer, once its affine velocities are the mode's own.
double one_step(const Row& row, const Line& line) {
  if (!row.is_quotient) return factor(line);
  LineScene scene(line);
  const double before = scene.amplitude();
  scene.step();
  return scene.amplitude() / before;
}

void check_row(const Row& row) {
  for (std::size_t k = 0; k < modes.size(); ++k) {
    INFO(row.shapes[0] << " " << row.transfers[0] << " mode " << modes[k] << ": "
                       << digits(closed_form(row, modes[k])));
    CHECK(std::abs(closed_form(row, modes[k]) - row.factors[k]) <= 0.51 * row.printed);
  }
  for (const std::string& shape : shapes_present(row.shapes))
    for (const std::string& transfer : row.transfers)
      for (const std::string backend : {"reference", "cpu"}) {
        std::printf("  %-17s %-7s %-10s %s, %d a cell ", shape.c_str(), transfer.c_str(), backend.c_str(),
                    row.offset == 0 ? "centre" : "node  ", row.particles_per_cell);
        for (const int mode : modes) {
          const double found = one_step(row, {.shape = shape,
                                              .transfer = transfer,
                                              .backend = backend,
                                              .particles_per_cell = row.particles_per_cell,
                                              .mode = mode,
                                              .offset = row.offset});
          const double exact = closed_form(row, mode);
          std::printf(" %.10f", found);
          INFO(shape << " " << transfer << " " << backend << " mode " << mode << ": " << digits(found) << ", exact "
                     << digits(exact));
          CHECK(std::abs(found - exact) <= 1e-10);
        }
        std::printf("\n");
      }
}

}  // namespace

TEST_CASE("the table of damping factors", "[damping]") {
  // A wave along the line has no spin for RPIC to keep, and nothing across it for PolyPIC's product x y.
  const std::vector<std::string> quadratic{"bspline_quadratic", "gimp", "gimp_contiguous"},
      cubic{"bspline_cubic", "b2gimp"}, affine{"apic", "mls", "polypic"};
  const std::vector<std::string> centre{"linear", "bspline_quadratic", "gimp", "gimp_contiguous", "cpdi", "cpdi2"};
  std::printf("Damping, factor on the velocity of modes 1, 2, 4, 8 of 32 cells in one step\n");
  for (const Row& row : std::vector<Row>{
           {centre, {"pic", "rpic"}, 0, 1, {.9903926402, .9619397663, .8535533906, .5}},
           {quadratic, {"pic", "rpic"}, .5, 1, {.9904157155, .9623019116, .8589150429, .5625}},
           {cubic, {"pic", "rpic"}, .5, 1, {.9872312098, .9498968356, .8142696805, .4444444444}},
           {quadratic, affine, .5, 1, {.9999307740, .9989135640, .9839150429, .8125}},
           {{"bspline_quadratic"}, affine, 0, 2, {.99996431, .99943981, .99170619, .90332031}, 1e-8},
           {cubic, affine, .5, 1, {.99991795, .99871237, .98093635, .77777778}, 1e-8},
           {{"bspline_cubic"}, affine, 0, 2, {.99993099, .99891967, .98415701, .82108222}, 1e-8},
           {{"linear"}, {"pic"}, 0, 2, {.99279447, .97145394, .89010991, .62185922}, 1e-8, true},
       })
    check_row(row);
}

TEST_CASE("FLIP with a share of PIC damps by that share", "[damping]") {
  for (const double share : {0.01, 0.1, 0.5})
    for (const int mode : modes) {
      const double s2 = std::pow(std::cos(std::numbers::pi * mode / 32), 2);
      const Line line{.transfer = "flip", .mode = mode, .pic_fraction = share};
      INFO("share " << share << " mode " << mode);
      CHECK(factor(line) == Approx(1 - share + share * s2).epsilon(1e-10));
    }
}

TEST_CASE("the order of dissipation: 2 of PIC, 4 of APIC, 2 m of XPIC(m) and FMPM(m)", "[damping]") {
  // The loss of the longest wave over that of half its length is 2^-order as both go to zero.
  std::printf("Damping, order of dissipation from waves of 64 and 32 cells\n");
  const auto check_order = [](const std::string& transfer, const std::string& with_filter, double order) {
    const auto loss = [&](int cells) {
      return 1 - factor({.shape = "bspline_quadratic",
                         .transfer = transfer,
                         .filter = with_filter,
                         .cells = cells,
                         .offset = 0.5});
    };
    const double found = std::log2(loss(32) / loss(64));
    std::printf("  %-7s %-32s %.3f\n", transfer.c_str(), with_filter.c_str(), found);
    INFO(transfer << " " << with_filter << ": " << found);
    CHECK(std::abs(found - order) <= 0.02 * order);
  };
  check_order("pic", "", 2);
  for (const char* transfer : {"apic", "mls", "tpic", "polypic"}) check_order(transfer, "", 4);
  for (const int m : {2, 3})
    for (const char* type : {"xpic", "fmpm"}) check_order("pic", filter(type, m), 2 * m);
}
