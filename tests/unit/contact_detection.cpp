// The one-dimensional edge model behind contact detection: the check values of docs/verification.md, and its inverse.

#include "simulation/contact_detection.hpp"

#include <cmath>
#include <string>

#include "simulation/contact_pair.hpp"
#include "support/catch.hpp"
#include "support/scene.hpp"

using namespace mpm;

namespace {

Component shape(const char* id) {
  Component component;
  component.plugin = test::plugins().find(MPM_SHAPE, id);
  return component;
}

/// How far a shape's kernel reaches, in cells.
double reach_of(const std::string& id) {
  return id == "linear" ? 1 : id == "bspline_quadratic" ? 1.5 : 2;
}

/// The kernels of the catalogue, written here once more.
double kernel(const std::string& id, double x) {
  const double d = std::abs(x);
  if (d >= reach_of(id)) return 0;
  if (id == "linear") return 1 - d;
  if (id == "bspline_quadratic") return d < 0.5 ? 0.75 - d * d : 0.5 * (1.5 - d) * (1.5 - d);
  return d < 1 ? d * d * d / 2 - d * d + 2.0 / 3 : std::pow(2 - d, 3) / 6;
}

/// The mean of rows 1/(2n), 3/(2n), ... cells inside an edge at `edge`, weighted as a node at 0 sees them.
double mean_of_rows(const std::string& id, int n, double edge) {
  double sum = 0, moment = 0;
  for (int k = 0; k < 6 * n; ++k) {
    const double row = edge - (k + 0.5) / n, weight = kernel(id, row);
    sum += weight, moment += weight * row;
  }
  return moment / sum;
}

/// Two blocks that touch face to face, one above the other.
Experiment two_blocks(const std::string& contact) {
  return test::experiment_from(R"({"title": "touch", "dimension": 2,
    "grid": {"cell_size": 0.1, "domain": [[0, 0], [1, 1]]}, "shape": {"type": "bspline_quadratic"},
    "transfer": {"type": "apic"}, "contact": )" +
                               contact + R"(,
    "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1, "poisson_ratio": 0.3, "density": 1}},
    "bodies": [{"name": "a", "material": "m", "geometry": {"type": "box", "lower": [0.2, 0.2], "upper": [0.5, 0.5]}},
               {"name": "b", "material": "m", "geometry": {"type": "box", "lower": [0.2, 0.5], "upper": [0.5, 0.8]}}],
    "solver": {"end_time": 1}})");
}

}  // namespace

TEST_CASE("contact offset of the quadratic spline with the edge on a node", "[contact]") {
  const Component quadratic = shape("bspline_quadratic");
  CHECK(EdgeModel(quadratic, 2).contact_offset(0) == Approx(27.0 / 32).epsilon(1e-14));
  CHECK(EdgeModel(quadratic, 1).contact_offset(0) == Approx(1.0).epsilon(1e-14));
  CHECK(EdgeModel(quadratic, 3).contact_offset(0) == Approx(0.827160).margin(1e-6));
  CHECK(EdgeModel(quadratic, 2).mean_position(0) == Approx(-27.0 / 64).epsilon(1e-14));
}

TEST_CASE("the offset depends on where the edge lies in the cell", "[contact]") {
  const EdgeModel model(shape("bspline_quadratic"), 2);
  CHECK(model.contact_offset(0.5) == Approx(0.948).margin(5e-4));
}

// The model tabulates the mean at steps of d = 1/256 cell. Linear interpolation errs by d^2/8 times the ratio of the
// mean's second derivative to its first, at most 1.6e-4 cells here; in the first step of the table, where the outermost row
// has just come into the node's reach, it has no table to look in.
TEST_CASE("the edge model gives the mean of its rows, and finds the edge back", "[contact]") {
  for (const char* id : {"linear", "bspline_quadratic", "bspline_cubic"})
    for (const int rows : {1, 2, 3, 4}) {
      const EdgeModel model(shape(id), rows);
      for (int k = 0; k < 80; ++k) {
        const double edge = -1.201 + 0.02 * k, seen = edge - 0.5 / rows + reach_of(id);
        if (edge > 0.45 || (seen > 0 && seen < 1.0 / 256)) continue;
        INFO(id << " " << rows << " rows a cell, edge " << edge);
        const double mean = model.mean_position(edge);
        REQUIRE(std::isfinite(mean) == (seen > 0));
        if (seen < 0) continue;
        CHECK(mean == Approx(mean_of_rows(id, rows, edge)).margin(1e-12));
        CHECK(model.edge(mean_of_rows(id, rows, edge)) == Approx(edge).margin(2e-4));
      }
    }
}

TEST_CASE("normal, separation and area of a flat interface", "[contact]") {
  // For two half spaces that touch at a node the means are at -27/64 and 27/64 cell, the gradients opposite, and each
  // has half a cell of volume.
  const double h = 0.1;
  const Experiment experiment = two_blocks(R"({"type": "coulomb"})");
  const ContactPoints points(experiment);
  REQUIRE_FALSE(points.needed());
  const auto contact_geometry = [&, geometry = PairGeometry(experiment, MPM_SCALAR_DOUBLE)](const ContactFieldNode& a,
                                                                                            const ContactFieldNode& b) {
    MetPair met{{5, 5, 0}, a, b, {}};
    geometry.find(points, 0, 1, {&met, 1});
    return met.geometry;
  };
  ContactFieldNode a, b;
  a.mass = 2, b.mass = 3;
  a.volume_gradient[1] = h, b.volume_gradient[1] = -h;
  a.mass_position[1] = -27.0 / 64 * h * a.mass, b.mass_position[1] = 27.0 / 64 * h * b.mass;
  const ContactGeometry touching = contact_geometry(a, b);
  REQUIRE(touching.valid);
  CHECK(touching.normal[0] == 0);
  CHECK(touching.normal[1] == Approx(1));
  CHECK(std::abs(touching.separation) < 1e-12 * h);
  CHECK(touching.area == Approx(h));

  // Edges anywhere about the node: their distance is what the means give away.
  for (const double gap : {-0.3, -0.05, 0.02, 0.1, 0.4}) {
    const double edge_a = -0.1, edge_b = edge_a + gap;
    a.mass_position[1] = mean_of_rows("bspline_quadratic", 2, edge_a) * h * a.mass;
    b.mass_position[1] = -mean_of_rows("bspline_quadratic", 2, -edge_b) * h * b.mass;
    CHECK(contact_geometry(a, b).separation == Approx(gap * h).margin(1e-4 * h));
  }
  a.volume_gradient[1] = b.volume_gradient[1] = h;
  CHECK_FALSE(contact_geometry(a, b).valid);
}

TEST_CASE("the gap of a pair is what the detection makes of its means, at every node of a call", "[contact]") {
  const double h = 0.1;
  const auto gaps = [&](const std::string& detection, mpm_precision entry) {
    const Experiment experiment = two_blocks(R"({"type": "coulomb", "detection": )" + detection + "}");
    const ContactPoints points(experiment);
    std::vector<MetPair> pairs(20);  // more than a pack, and one without a normal among them
    for (int k = 0; k < 20; ++k) {
      ContactFieldNode a, b;
      a.mass = 2, b.mass = 3;
      a.volume_gradient[1] = h, b.volume_gradient[1] = k == 7 ? h : -h;
      a.mass_position[1] = -0.3 * h * a.mass, b.mass_position[1] = (0.4 + 0.01 * k) * h * b.mass;
      pairs[static_cast<std::size_t>(k)] = {{5, 5, 0}, a, b, {}};
    }
    PairGeometry(experiment, entry).find(points, 0, 1, pairs);
    return pairs;
  };
  for (const mpm_precision entry : {MPM_LANES_DOUBLE, MPM_SCALAR_DOUBLE})
    for (const double offset : {0.8, 0.5}) {
      const auto fixed = gaps(R"({"type": "fixed_offset", "offset": )" + std::to_string(offset) + "}", entry);
      const auto approach = gaps(R"("approach")", entry);
      for (int k = 0; k < 20; ++k) {
        const ContactGeometry &of_fixed = fixed[static_cast<std::size_t>(k)].geometry,
                              &of_approach = approach[static_cast<std::size_t>(k)].geometry;
        INFO(k << " " << offset);
        CHECK((of_fixed.valid == (k != 7) && of_approach.valid == (k != 7)));
        if (k == 7) continue;
        CHECK(of_fixed.separation == Approx((0.7 + 0.01 * k - offset) * h).margin(1e-13));
        CHECK(of_approach.separation == 0);
        CHECK((of_fixed.area == Approx(h) && of_approach.area == Approx(h)));
      }
    }
}
