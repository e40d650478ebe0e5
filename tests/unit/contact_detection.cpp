// The one-dimensional edge model behind contact detection: the check values of docs/verification.md, and its inverse.

#include "simulation/contact_detection.hpp"

#include <cmath>

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

TEST_CASE("the edge model inverts itself", "[contact]") {
  for (const char* id : {"linear", "bspline_quadratic", "bspline_cubic"})
    for (const int rows : {1, 2, 3, 4}) {
      const EdgeModel model(shape(id), rows);
      for (double edge = -0.9; edge < 0.45; edge += 0.05) {
        INFO(id << " " << rows << " rows a cell, edge " << edge);
        const double mean = model.mean_position(edge);
        if (std::isfinite(mean)) CHECK(model.edge(mean) == Approx(edge).margin(2e-2));
      }
    }
}

TEST_CASE("normal, separation and area of a flat interface", "[contact]") {
  // For two half spaces that touch at a node the means are at -27/64 and 27/64 cell, the gradients opposite, and each
  // has half a cell of volume.
  const EdgeModel model(shape("bspline_quadratic"), 2);
  const double h = 0.1;
  ContactFieldNode a, b;
  a.mass = 2, b.mass = 3, a.volume = b.volume = 0.5 * h * h;
  a.volume_gradient[1] = h, b.volume_gradient[1] = -h;
  a.mass_position[1] = -27.0 / 64 * h * a.mass, b.mass_position[1] = 27.0 / 64 * h * b.mass;
  const ContactGeometry touching = contact_geometry(a, b, model, model, h, 2);
  REQUIRE(touching.valid);
  CHECK(touching.normal[0] == 0);
  CHECK(touching.normal[1] == Approx(1));
  CHECK(std::abs(touching.separation) < 1e-3 * h);
  CHECK(touching.area == Approx(h));

  b.mass_position[1] += 0.2 * h * b.mass;
  CHECK(contact_geometry(a, b, model, model, h, 2).separation > 0.1 * h);
  a.volume_gradient[1] = b.volume_gradient[1] = h;
  CHECK_FALSE(contact_geometry(a, b, model, model, h, 2).valid);
}
