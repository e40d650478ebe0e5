// Phases over nodes visit those that particles have reached (kernels/active_nodes.hpp): the others cost nothing, and nothing
// of what a body leaves behind counts any more.

#include "backends/device/traffic.hpp"
#include "device/covering.hpp"
#include "support/temporary_folder.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// Sixty steps, in which bodies cross seven cells and the grid is forgotten four times.
Mix long_way(Mix mix) {
  mix.overrides.push_back(set("/solver/end_time", "0.54"));
  return mix;
}

struct Counted {
  double bytes, launches;  ///< of one step
  double nodes;
};

Counted count(int dimension, double more_cells) {
  Mix mix;
  mix.dimension = dimension;
  const char* const lower = dimension == 2 ? "[0, -0.1]" : "[0, -0.1, 0]";
  const double top = 0.9 + 0.1 * more_cells;
  mix.overrides = {set("/grid/domain",
                       "[" + std::string(lower) + (dimension == 2 ? ", [1.3, " : ", [1.1, 0.5, ") + digits(top) + "]]"),
                   R"(/output={"ledger": false})"};
  device_setup();  // so that the usual devices are not set later
  const TemporaryFolder folder;
  setenv("MPM_CACHE", folder.path().c_str(), 1);
  const Experiment experiment = device_experiment(mix.text(), "double", mix.overrides);
  const device::StepTraffic traffic = device::count_traffic(experiment, 2);
  unsetenv("MPM_CACHE");
  use_usual_devices();
  double nodes = 1;
  for (int c = 0; c < dimension; ++c) nodes *= experiment.grid.cells[static_cast<std::size_t>(c)] + 3;
  return {traffic.bytes_per_particle_step() * static_cast<double>(traffic.particles), traffic.launches_per_step(),
          nodes};
}

}  // namespace

TEST_CASE("a larger domain costs a step a byte for each sixteen nodes and launch", "[device][active_nodes]") {
  for (const int dimension : {2, 3}) {
    INFO(dimension << "-D");
    const Counted small = count(dimension, 0), large = count(dimension, 400);
    REQUIRE(large.nodes > 10 * small.nodes);
    // Beside that the table of blocks, of 4 cells an axis, of which a sort looks at a few numbers.
    const double of_blocks = 24 / std::pow(4, dimension);
    CHECK(large.bytes - small.bytes < (large.nodes - small.nodes) * (small.launches / 16 + of_blocks));
  }
}

TEST_CASE("nothing that a body leaves behind on the grid counts any more", "[device][active_nodes]") {
  Mix around;  // and back to where it came from
  around.boundaries = R"({"all": "slip", "x_min": "periodic", "x_max": "periodic"})";
  check_on_device(long_way(around));
  Mix in_space = around;
  in_space.dimension = 3;
  check_on_device(long_way(in_space), {"double"});
  Mix lists = around;
  lists.shape = R"({"type": "cpdi"})", lists.transfer = R"({"type": "flip"})";
  check_on_device(long_way(lists), {"double"});
  // Far from one another in wide rows, a column drawn out to three and a half cells on each side of its particles.
  lists.boundaries = R"({"all": "slip"})";
  lists.overrides = {set("/grid/domain", "[[0, -2], [6, 3]]"), set("/bodies/1/geometry/lower", "[4.52, 0.2]"),
                     set("/bodies/1/geometry/upper", "[4.81, 0.6]"),
                     set("/bodies/1/initial_deformation_gradient", R"({"yy": 14})"),
                     set("/materials/m/youngs_modulus", "1e-3")};
  check_on_device(long_way(lists), {"double"});
  // Ghosts are folded while particles approach a wall, and no longer.
  Mix parting;
  parting.close = true, parting.boundaries = R"({"all": "separate"})", parting.stress_update = "first";
  parting.overrides = {
      set("/solver/end_time", "0.27")};  // later a wall lets go of a particle by the sign of a rounding
  check_on_device(parting, {"double"});
  Mix averaged = around;
  averaged.filter = R"({"type": "fmpm", "order": 3})";
  averaged.overrides = {set("/solver/dilation", "averaged")};
  check_on_device(long_way(averaged), {"double"});
  Mix exact = around;
  exact.contact = R"({"type": "coulomb", "friction": 0.2})", exact.overrides = {deterministic_sums};
  check_on_device(long_way(exact), {"double"});
}
