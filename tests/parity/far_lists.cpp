// Lists of nodes that are long from the start: across a periodic face, and over both walls of a narrow domain.

#include "parity/parity.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

const std::string soft =
    R"({"m": {"type": "neo_hookean", "youngs_modulus": 1e-3, "poisson_ratio": 0.3, "density": 1000}})";

/// Two by two particles (two by two by one in 3-D) drawn out along y, which the first step finds that way.
struct Drawn {
  int dimension = 2;
  std::string shape = "cpdi", boundaries = R"({"all": "periodic"})";
  std::string domain = "[[0, 0], [1.6, 1.6]]", lower = "[0.9, 0.1]", upper = "[1, 0.2]";
  std::string deformation = R"({"yy": 31.6})", velocity = R"J(["0.3*(y-0.15)", -1.2])J", transfer = "apic";

  std::string text() const {
    return R"({"title": "drawn", "dimension": )" + std::to_string(dimension) +
           R"(, "grid": {"cell_size": 0.1, "domain": )" + domain + R"(, "boundaries": )" + boundaries +
           R"(}, "shape": {"type": ")" + shape + R"("}, "transfer": {"type": ")" + transfer + R"("}, "materials": )" +
           soft + R"(, "bodies": [{"name": "a", "material": "m", "geometry": {"type": "box", "lower": )" + lower +
           R"(, "upper": )" + upper + R"(}, "initial_deformation_gradient": )" + deformation + R"(, "velocity": )" +
           velocity + R"(}], "solver": {"time_step": 0.01, "end_time": 0.3}})";
  }
};

/// Runs it on the reference, and on the cpu in both precisions, whose results must be the reference's; returns what the
/// reference ends with. Where it stops, the others must stop by the same cause.
Totals check(const Drawn& drawn) {
  const std::string text = drawn.text();
  INFO(text);
  Scene reference(text, {"/backend=reference"});
  const Totals end = reference.run();
  CHECK(std::abs(reference.simulation.ledger().mass_book) < 1e-12 * end.mass);
  for (const std::string precision : {"double", "float"}) {
    INFO(precision);
    const double epsilon =
        precision == "double" ? std::numeric_limits<double>::epsilon() : std::numeric_limits<float>::epsilon();
    Scene cpu(text, {"/backend=cpu", set("/precision", precision)});
    cpu.run();
    Tolerance allowed = parity_tolerance;  // domains are ten times as wide as in the other scenes
    allowed.position *= 10, allowed.material *= 10;
    compare_states(reference, cpu, epsilon, allowed);
    CHECK(ledger_difference(ledger_values(reference), ledger_values(cpu), reference.metrics.initial().kinetic) <=
          allowed.ledger * epsilon);
  }
  return end;
}

}  // namespace

// The domains reach 7.9 cells to each side, where 8 beyond the domain's edge are allowed, and their ends meet behind the 16
// cells of a period. Between sorts, which wrap particles, they lie up to a cell beyond the face.
TEST_CASE("parity of long lists that cross a periodic face", "[parity]") {
  for (const std::string shape : {"cpdi", "cpdi2"})
    for (const bool along_x : {false, true}) {
      Drawn drawn;
      drawn.shape = shape;
      if (along_x) {
        drawn.lower = "[0.1, 0.9]", drawn.upper = "[0.2, 1]", drawn.deformation = R"({"xx": 31.6})";
        drawn.velocity = R"J([-1.2, "0.3*(x-0.15)"])J";
      }
      check(drawn);
    }
  Drawn solid;
  solid.dimension = 3, solid.domain = "[[0, 0, 0], [1.6, 1.6, 0.8]]";
  solid.lower = "[0.9, 0.1, 0.4]", solid.upper = "[1, 0.2, 0.5]";
  solid.velocity = R"J(["0.3*(y-0.15)", -1.2, 0.1])J";
  check(solid);
}

// In a domain of one cell or two a list reaches ghosts whose mirrors are ghosts of the other wall. What lies beyond slipping
// walls is mirrored with its velocity along them, so that this momentum stays.
TEST_CASE("parity of long lists in narrow domains", "[parity]") {
  for (const std::string wall : {"slip", "stick", "separate"})
    for (const int cells : {1, 2})
      for (const std::string transfer : {"flip", "apic"}) {
        Drawn drawn;
        drawn.boundaries = R"({"all": ")" + wall + "\"}", drawn.transfer = transfer;
        drawn.domain = "[[0, 0], [" + std::string(cells == 1 ? "0.1" : "0.2") + ", 2]]";
        drawn.lower = "[0, 0.9]", drawn.upper = "[0.1, 1]";
        drawn.deformation = R"({"xx": )" + std::to_string(cells == 1 ? 10 : 20) + "}";
        drawn.velocity = R"J(["0.2*sin(9*y)", "0.5+3*x"])J";
        const Scene start(drawn.text());
        const Totals end = check(drawn);
        if (wall == "slip") CHECK(end.momentum[1] == Approx(start.metrics.initial().momentum[1]).epsilon(1e-9));
      }
}
