// What the columns of a pair of bodies in contact say: area, normal and tangential force, of faces whose size, load and
// friction are known.

#include <cmath>
#include <numbers>

#include "metrics/contact_traction.hpp"
#include "metrics/pair_surfaces.hpp"
#include "support/catch.hpp"
#include "support/scene.hpp"
#include "support/stacked_blocks.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// Two welded blocks of 4.5 cells' height that fill a shaft 0.5 m wide and meet at a height that no node has. Rows of
/// particles go on across the face between them.
std::string shaft(int dimension, double h, const std::string& grid = "") {
  const std::string zero = dimension == 3 ? "0, 0, " : "0, ", wide = dimension == 3 ? "0.5, 0.5, " : "0.5, ";
  const auto body = [&](const char* name, double from) {
    return R"({"name": ")" + std::string(name) + R"(", "material": "m", "seeding": "fitted",
      "geometry": {"type": "box", "lower": [)" +
           zero + digits(from) + R"(], "upper": [)" + wide + digits(from + 4.5 * h) + R"(]}, "velocity": [)" + zero +
           "0.01]}";
  };
  return R"({"dimension": )" + std::to_string(dimension) + R"(, "grid": {"cell_size": )" + digits(h) +
         R"(, "domain": [[)" + zero + "0], [" + wide + R"(1]], "boundaries": {"all": "slip"})" + grid + R"(},
      "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "apic"}, "contact": {"type": "stick"},
      "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e6, "poisson_ratio": 0.3, "density": 1000}},
      "bodies": [)" +
         body("low", 0.16 * h) + ", " + body("high", 4.66 * h) +
         R"(], "solver": {"end_time": 1}, "output": {"ledger": false, "bodies": true, "contact_pairs": true}})";
}

Numbers after(Scene& scene, int steps) {
  scene.run_steps(steps);
  return chosen(scene.metrics);
}

/// A block of 0.4 m by 0.2 m, 80 kg a metre, on a bed, both turned by `angle` against the grid; the weight leans by 30
/// degrees against the face between them and grows over a tenth of a second.
std::string leaning_block(double angle, double friction) {
  const double down = (30 - angle) * std::numbers::pi / 180;
  const auto grows = [](double size) { return "\"" + digits(size) + "*min(1, t/0.1)\""; };
  const auto turned = [&](const std::string& box) {
    return R"({"type": "turned", "about": [0, 0], "angle": "-)" + digits(angle) + R"( deg", "of": {"type": "box", )" +
           box + "}}";
  };
  return R"({"dimension": 2, "grid": {"cell_size": 0.05, "domain": [[-0.8, -1.4], [1.8, 0.8]],
      "boundaries": {"all": "free"}}, "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "apic"},
      "gravity": [)" +
         grows(9.81 * std::sin(down)) + ", " + grows(-9.81 * std::cos(down)) +
         R"(], "contact": {"type": "coulomb", "normal": "widest_gap", "friction": )" + digits(friction) +
         R"(}, "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e6, "poisson_ratio": 0.3, "density": 1000}},
      "bodies": [{"name": "bed", "material": "m", "seeding": "fitted", "geometry": )" +
         turned(R"("lower": [-0.4, -0.3], "upper": [1.6, 0])") +
         R"(}, {"name": "block", "material": "m", "seeding": "fitted", "geometry": )" +
         turned(R"("lower": [0, 0], "upper": [0.4, 0.2])") +
         R"(}], "grips": [{"name": "held", "body": "bed", "velocity": [0, 0], "where": )" +
         turned(R"("lower": [-0.4, -0.3], "upper": [1.6, -0.15])") +
         R"(}], "solver": {"end_time": 0.4}, "output": {"ledger": false, "bodies": true, "contact_pairs": true}})";
}

/// Two soft blocks in free space that meet along y = 0 and begin to move by `velocity`, the upper one a little towards the
/// other, with a contact normal that is given as (sin turn, cos turn).
std::string given_normals(double turn, const std::vector<std::string>& velocity) {
  const int dimension = static_cast<int>(velocity.size());
  const bool flat = dimension == 2;
  const auto block = [&](const std::string& name, double from, double to, double approach) {
    std::string speeds;
    for (int c = 0; c < dimension; ++c)
      speeds += (c > 0 ? ", \"" : "\"") + velocity[static_cast<std::size_t>(c)] +
                (c == 1 ? "-" + digits(approach) : std::string()) + "\"";
    return R"({"name": ")" + name + R"(", "material": "m", "geometry": {"type": "box", "lower": [-0.25, )" +
           digits(from) + (flat ? "" : ", -0.25") + "], \"upper\": [0.25, " + digits(to) + (flat ? "" : ", 0.25") +
           "]}, \"velocity\": [" + speeds + "]}";
  };
  const std::string lower = flat ? "[-1, -1]" : "[-0.6, -0.6, -0.6]", upper = flat ? "[1, 1]" : "[0.6, 0.6, 0.6]";
  return R"({"dimension": )" + std::to_string(dimension) + R"(, "grid": {"cell_size": )" + (flat ? "0.05" : "0.1") +
         R"(, "domain": [)" + lower + ", " + upper + R"(], "boundaries": {"all": "free"}},
      "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "apic"},
      "contact": {"type": "frictionless", "normal": {"type": "given", "x": )" +
         digits(std::sin(turn)) + ", \"y\": " + digits(std::cos(turn)) + R"(}, "detection": "approach"},
      "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e-3, "poisson_ratio": 0.3, "density": 1000}},
      "bodies": [)" +
         block("low", -0.3, 0, 0) + ", " + block("high", 0, 0.3, 0.05) +
         R"(], "solver": {"time_step": 0.001, "end_time": 0.1},
      "output": {"ledger": false, "bodies": true, "contact_pairs": true, "normal_error": true}})";
}

/// Discs of 0.2 m that fly at one another in free space, the first from below; the others rest.
std::string three_discs(const std::string& contact) {
  const auto disc = [](const char* name, double x, double y, const char* velocity) {
    return R"({"name": ")" + std::string(name) + R"(", "material": "m", "geometry": {"type": "ball", "centre": [)" +
           digits(x) + ", " + digits(y) + R"(], "radius": 0.2}, "velocity": )" + velocity + "}";
  };
  return R"({"dimension": 2, "grid": {"cell_size": 0.05, "domain": [[-1.2, -1], [1.2, 1]], "boundaries": {"all": "free"}},
      "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "apic"}, "contact": )" +
         contact +
         R"(, "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e5, "poisson_ratio": 0.3, "density": 1000}},
      "bodies": [)" +
         disc("a", -0.45, -0.05, "[4, 0.3]") + ", " + disc("b", 0, 0, "[0, 0]") + ", " +
         disc("c", 0.42, 0.05, "[0, 0]") +
         R"(], "solver": {"time_step": 2e-4, "end_time": 0.1},
      "output": {"ledger": false, "bodies": true, "contact_pairs": true}})";
}

/// A body that flies along x at 1 m/s at one that rests, both as rigid as can be.
std::string flying(int dimension, const std::string& first, const std::string& second, const std::string& more = "") {
  const bool flat = dimension == 2;
  return R"({"dimension": )" + std::to_string(dimension) + R"(, "grid": {"cell_size": )" + (flat ? "0.05" : "0.1") +
         R"(, "domain": )" + (flat ? "[[-1, -0.6], [1, 0.6]]" : "[[-1, -0.6, -0.6], [1, 0.6, 0.6]]") +
         R"(, "boundaries": {"all": "free"}}, "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "apic"},
      "contact": {"type": "frictionless"},
      "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e6, "poisson_ratio": 0.3, "density": 1000}},
      "bodies": [{"name": "a", "material": "m", "seeding": "fitted", "geometry": )" +
         first + R"(, "velocity": )" + (flat ? "[1, 0]" : "[1, 0, 0]") +
         R"(}, {"name": "b", "material": "m", "seeding": "fitted", "geometry": )" + second +
         R"(}], "solver": {"time_step": 1e-4, "end_time": 1}, "output": {"ledger": false, "bodies": true,
      "contact_pairs": true, "normal_error": true})" +
         more + "}";
}

}  // namespace

TEST_CASE("the area of contact is that of the face, for every shape and wherever it lies in the cell",
          "[pairs][area]") {
  for (const Plugin* shape : plugins().of_kind(MPM_SHAPE))
    for (const char* backend : {"reference", "cpu"}) {
      INFO(shape->id() << ", " << backend);
      Scene scene(shaft(2, 0.05), {set("/shape/type", std::string(shape->id())), set("/backend", backend)});
      const Numbers now = after(scene, 3);
      CHECK(now.at("pair low high nodes") > 0);
      const ContactRecord& all = scene.simulation.backend().contact_record();  // of all pairs, here of one
      CHECK(static_cast<double>(all.nodes) == now.at("pair low high nodes"));
      CHECK(static_cast<double>(all.sticking) == now.at("pair low high sticking nodes"));
      CHECK(now.at("pair low high area") == Approx(0.5).epsilon(1e-4));
    }
  Scene solid(shaft(3, 0.1));
  CHECK(after(solid, 3).at("pair low high area") == Approx(0.25).epsilon(1e-4));
  Scene rings(shaft(2, 0.05, R"(, "symmetry": "axisymmetric")"));
  CHECK(after(rings, 3).at("pair low high area") == Approx(std::numbers::pi * 0.25).epsilon(1e-3));
}

TEST_CASE("the area of a block on a turned bed is that of its face", "[pairs][area]") {
  for (const double angle : {0.0, 17.0, 30.0, 45.0}) {
    INFO(angle << " degrees");
    Scene scene(leaning_block(angle, 0.6), {R"(/contact={"type": "stick"})"});
    // It is 8 cells long; at its ends, where normals lean, half a cell may be off.
    CHECK(after(scene, 3).at("pair bed block area") == Approx(0.4).margin(0.025));
  }
}

TEST_CASE("the parts of a pair's force are the weight that presses and friction", "[pairs][friction]") {
  const double weight = 80 * 9.81, pressing = weight * std::sqrt(0.75);
  for (const double angle : {0.0, 30.0}) {
    INFO(angle << " degrees");
    // The mean over a tenth of a second: a soft block shakes.
    const auto means = [&](double friction) {
      Scene scene(leaning_block(angle, friction));
      while (scene.simulation.time() < 0.3) scene.simulation.step();
      double normal = 0, along = 0, ratio = 0;
      int steps = 0;
      for (; !scene.simulation.finished(); ++steps) {
        scene.simulation.step();
        const Numbers now = chosen(scene.metrics);
        const double size =
            std::hypot(now.at("pair bed block tangential force x"), now.at("pair bed block tangential force y"));
        normal += now.at("pair bed block normal force"), along += size;
        ratio = larger(ratio, std::abs(size / now.at("pair bed block normal force") - friction));
      }
      return std::array{normal / steps, along / steps, ratio};
    };
    const auto [normal, along, ratio] = means(0.3);
    CHECK(normal == Approx(pressing).epsilon(0.01));
    CHECK(along == Approx(0.3 * pressing).epsilon(0.01));
    CHECK(ratio < 0.01);  // each step, as all nodes slip
    const auto [held_normal, held_along, unused] = means(0.6);
    CHECK(held_normal == Approx(pressing).epsilon(0.01));
    CHECK(held_along == Approx(weight / 2).epsilon(0.02));
  }
}

TEST_CASE("the error of a pair's normals is the angle by which given ones lean against the faces, however these move",
          "[pairs][normals]") {
  const double degree = std::numbers::pi / 180;
  const double turn = 10 * degree;
  struct Motion {
    const char* name;
    std::vector<std::string> velocity;
    double angle;  ///< degrees between the given normal and the face's after 40 steps
  };
  // A rotation by 40 steps of the tangent of 2 dt; shear along y by g = 0.2, which leans the normal to (-g, 1); shear along x,
  // which does not; and stretching, which does not either.
  for (const Motion& motion :
       {Motion{"none", {"0", "0"}, 10}, Motion{"rotation", {"-2*y", "2*x"}, 10 + 40 * std::atan(0.002) / degree},
        Motion{"shear along y", {"0", "5*x"}, 10 + std::atan(0.2) / degree}, Motion{"shear along x", {"5*y", "0"}, 10},
        Motion{"stretch", {"4*x", "-3*y"}, 10}, Motion{"in 3-D", {"0", "5*x", "0"}, 10 + std::atan(0.2) / degree}})
    for (const char* backend : {"reference", "cpu"}) {
      INFO(motion.name << ", " << backend);
      Scene scene(given_normals(turn, motion.velocity), {set("/backend", backend)});
      CHECK(std::isnan(chosen(scene.metrics).at("pair low high normal error")));  // before any step
      const Numbers now = after(scene, 40);
      CHECK(now.at("pair low high normal error") == Approx(motion.angle).margin(0.1));
      CHECK(now.at("pair low high largest normal error") == Approx(motion.angle).margin(0.1));
      CHECK(now.at("pair low high surface misfit") < 0.05 * 0.05);
    }
}

TEST_CASE("the nearer of both surfaces is the one that a normal is compared with, and a curved one is followed",
          "[pairs][normals]") {
  // A disc that is pressed on a block: where they touch both surfaces have the given normal, and beside it the block's has.
  const std::string text = R"({"dimension": 2, "grid": {"cell_size": 0.05, "domain": [[-1, -1], [1, 1]],
      "boundaries": {"all": "free"}}, "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "apic"},
      "contact": {"type": "frictionless", "normal": {"type": "given", "x": 0, "y": 1}, "detection": "approach"},
      "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e-3, "poisson_ratio": 0.3, "density": 1000}},
      "bodies": [
        {"name": "block", "material": "m", "geometry": {"type": "box", "lower": [-0.5, -0.3], "upper": [0.5, 0]}},
        {"name": "disc", "material": "m", "geometry": {"type": "ball", "centre": [0, 0.3], "radius": 0.3},
         "velocity": [0, -0.1]}],
      "solver": {"time_step": 0.001, "end_time": 0.1},
      "output": {"ledger": false, "bodies": true, "contact_pairs": true, "normal_error": true}})";
  Scene scene(text);
  const Numbers now = after(scene, 5);
  CHECK(now.at("pair block disc nodes") > 2);
  CHECK(now.at("pair block disc largest normal error") < 1e-3);
  // A normal that leans by 10 degrees is nearer to that of the disc on one side of the point of contact.
  Scene leaning(text, {set("/contact/normal/x", digits(std::sin(10 * std::numbers::pi / 180))),
                       set("/contact/normal/y", digits(std::cos(10 * std::numbers::pi / 180)))});
  const Numbers leans = after(leaning, 5);
  CHECK(leans.at("pair block disc largest normal error") == Approx(10).margin(1e-3));
  CHECK(leans.at("pair block disc normal error") < 9.5);
}

TEST_CASE(
    "the mean error of normals is by the forces of the nodes, and the largest without those of a hundredth of them",
    "[pairs][normals]") {
  const Scene scene(given_normals(0, {"0", "0"}));
  const double degree = std::numbers::pi / 180;
  std::vector<ContactNode> nodes;
  for (const auto& [angle, force] : {std::pair{10.0, 3.0}, {30.0, 1.0}, {50.0, 0.02}, {70.0, 0.0}}) {
    ContactNode& node = nodes.emplace_back();
    node.node = {20 + static_cast<int>(nodes.size()), 20, 0}, node.b = 1;  // at y = 0, right of the middle
    node.normal = {std::sin(angle * degree), std::cos(angle * degree), 0};
    node.force = {0, -force, 0};
  }
  Views views(scene.simulation);
  const std::vector<PairSurfaces> errors = pair_surfaces(views, nodes, 0.001);
  REQUIRE(errors.size() == 1);
  CHECK(errors[0].normal_error == Approx((3 * 10 + 1 * 30 + 0.02 * 50) / 4.02));
  CHECK(errors[0].largest_normal_error == Approx(30));
  nodes.resize(3);
  nodes[2].force = {0, -0.04, 0};
  CHECK(pair_surfaces(views, nodes, 0.001)[0].largest_normal_error == Approx(50));
  for (ContactNode& node : nodes) node.force[1] *= 1e-15;  // the lower block rests, and the upper one has 7.5 kg m/s
  CHECK(std::isnan(pair_surfaces(views, nodes, 0.001)[0].normal_error));
  nodes.clear();
  CHECK(std::isnan(pair_surfaces(views, nodes, 0.001)[0].normal_error));
  CHECK(std::isnan(pair_surfaces(views, nodes, 0.001)[0].largest_normal_error));
  CHECK(pair_surfaces(views, nodes, 0.001)[0].misfit == Approx(0).margin(1e-12));
}

TEST_CASE("the normals of the widest gap under a block on a turned bed are half a degree off at most",
          "[pairs][normals]") {
  for (const double angle : {0.0, 17.0, 30.0}) {
    INFO(angle << " degrees");
    Scene scene(leaning_block(angle, 0.3), {"/output/normal_error=true"});
    while (scene.simulation.time() < 0.3) scene.simulation.step();
    const Numbers now = chosen(scene.metrics);
    CHECK(now.at("pair bed block normal error") < 0.5);
    CHECK(now.at("pair bed block largest normal error") < 3);
  }
}

TEST_CASE("the tractions on a block's face have the weight that presses, and friction, for their mean",
          "[pairs][nodes]") {
  const double pressure = 80 * 9.81 * std::sqrt(0.75) / 0.4, friction = 0.3;
  for (const double angle : {0.0, 30.0}) {
    INFO(angle << " degrees");
    Scene scene(leaning_block(angle, friction), {"/output/frames=2", "/output/contact_nodes=true"});
    while (scene.simulation.time() < 0.3) scene.simulation.step();
    const double turn = angle * std::numbers::pi / 180;
    const std::array<double, 2> up{std::sin(turn), std::cos(turn)}, down_slope{std::cos(turn), -std::sin(turn)};
    const BodyState begin = scene.body(1);
    std::vector<std::size_t> face;  // the block's lowest row of particles, less the two cells at its ends
    double lowest = INFINITY, first = INFINITY;
    const auto along = [&](const BodyState& state, std::size_t p, const std::array<double, 2>& axis) {
      return state.position[2 * p] * axis[0] + state.position[2 * p + 1] * axis[1];
    };
    const std::size_t count = begin.position.size() / 2;
    for (std::size_t p = 0; p < count; ++p) {
      lowest = smaller(lowest, along(begin, p, up)), first = smaller(first, along(begin, p, down_slope));
    }
    for (std::size_t p = 0; p < count; ++p) {
      const double place = along(begin, p, down_slope) - first;
      if (along(begin, p, up) < lowest + 0.0125 && place > 0.07 && place < 0.3) face.push_back(p);
    }
    CHECK(face.size() >= 8);
    // The mean over a tenth of a second: a soft block shakes.
    double pressed = 0, rubbed = 0;
    int steps = 0;
    for (; !scene.simulation.finished(); ++steps) {
      scene.simulation.step();
      const BodyState block = scene.body(1);
      const std::vector<double> traction =
          contact_traction(scene.experiment, 1, block, scene.simulation.backend().contact_nodes());
      REQUIRE(traction.size() == 3 * count);
      for (const std::size_t p : face) {
        pressed += (traction[3 * p] * up[0] + traction[3 * p + 1] * up[1]) / static_cast<double>(face.size());
        rubbed -=
            (traction[3 * p] * down_slope[0] + traction[3 * p + 1] * down_slope[1]) / static_cast<double>(face.size());
      }
    }
    // The area of a turned face is known to half a cell of its eight ("the area of a block on a turned bed").
    CHECK(pressed / steps == Approx(pressure).epsilon(angle > 0 ? 1.0 / 16 : 0.03));
    CHECK(rubbed / pressed == Approx(friction).epsilon(0.01));
  }
}

TEST_CASE("the forces of a pair's nodes add up to its force, for every transfer and filter", "[pairs][nodes]") {
  const std::vector<std::string> filters{
      "", R"({"type": "fmpm", "order": 3})", R"({"type": "fmpm", "order": 4, "constraints": "kept_impulses"})",
      R"({"type": "fmpm", "order": 3, "every_steps": 3})", R"({"type": "xpic", "order": 3})"};
  int tried = 0;
  for (const std::string backend : {"reference", "cpu"})
    for (const Plugin* transfer : plugins().of_kind(MPM_TRANSFER))
      for (const std::string& filter : filters) {
        INFO(backend << " " << transfer->id() << " " << filter);
        std::vector<std::string> settings{set("/backend", backend), set("/transfer/type", std::string(transfer->id())),
                                          "/output/frames=2", "/output/contact_nodes=true"};
        if (!filter.empty()) settings.push_back("/filter=" + filter);
        try {
          Scene scene(leaning_block(30, 0.3), settings);
          scene.run_steps(40);
          const Numbers now = chosen(scene.metrics);
          Vector3 sum{};
          double area = 0;
          for (const ContactNode& node : scene.simulation.backend().contact_nodes()) {
            CHECK(std::hypot(node.normal[0], node.normal[1]) == Approx(1));
            CHECK((node.a == 0 && node.b == 1));
            for (std::size_t c = 0; c < 3; ++c) sum[c] += node.force[c];
            if (node.status != MPM_APART) area += node.area;
          }
          const double size = now.at("pair bed block normal force");
          CHECK(size > 1);
          CHECK(sum[0] == Approx(now.at("pair bed block force x")).margin(1e-9 * size));
          CHECK(sum[1] == Approx(now.at("pair bed block force y")).margin(1e-9 * size));
          CHECK(area == Approx(now.at("pair bed block area")));
          ++tried;
        } catch (const InputError&) {
        }
      }
  CHECK(tried >= 60);
}

TEST_CASE("a pair's impulse is the momentum that it has changed, for every transfer, filter and update order",
          "[pairs][impulse]") {
  const std::vector<std::string> schemes{"",
                                         R"(/filter={"type": "fmpm", "order": 3})",
                                         R"(/filter={"type": "fmpm", "order": 3, "constraints": "kept_impulses"})",
                                         R"(/filter={"type": "fmpm", "order": 3, "every_steps": 7})",
                                         R"(/filter={"type": "xpic", "order": 3})",
                                         R"(/solver/stress_update="first")",
                                         R"(/solver/stress_update="modified_last")",
                                         R"(/solver/stress_update="averaged")"};
  int tried = 0;
  for (const char* backend : {"reference", "cpu"})
    for (const Plugin* transfer : plugins().of_kind(MPM_TRANSFER))
      for (const std::string& scheme : schemes) {
        INFO(backend << " " << transfer->id() << " " << scheme);
        std::vector<std::string> settings{set("/backend", backend), set("/transfer/type", std::string(transfer->id()))};
        if (!scheme.empty()) settings.push_back(scheme);
        try {
          Scene scene(three_discs(R"({"type": "coulomb", "friction": 0.3})"), settings);
          const Numbers before = chosen(scene.metrics), now = after(scene, 400);
          const auto gained = [&](const std::string& body, const std::string& axis) {
            return now.at("body " + body + " momentum " + axis) - before.at("body " + body + " momentum " + axis);
          };
          const double size = now.at("pair a b normal impulse");
          CHECK(size > 50);
          CHECK(now.at("pair b c normal impulse") > 20);  // it goes on from the disc in the middle
          for (const std::string axis : {"x", "y"}) {
            const double ab = now.at("pair a b impulse " + axis), bc = now.at("pair b c impulse " + axis),
                         ac = now.at("pair a c impulse " + axis);
            CHECK(gained("a", axis) == Approx(ab + ac).margin(1e-9 * size));
            CHECK(gained("b", axis) == Approx(bc - ab).margin(1e-9 * size));
            CHECK(gained("c", axis) == Approx(-ac - bc).margin(1e-9 * size));
          }
          CHECK(now.at("pair a b unbalanced impulse") < 1e-12 * size);
          ++tried;
        } catch (const InputError&) {
        }
      }
  CHECK(tried >= 80);
}

TEST_CASE("what normals of each body's own take from momentum is the pair's unbalanced impulse", "[pairs][impulse]") {
  for (const char* backend : {"reference", "cpu"}) {
    INFO(backend);
    Scene scene(three_discs(R"({"type": "coulomb", "friction": 0.3, "normal": "own_gradient"})"),
                {set("/backend", backend)});
    const Numbers before = chosen(scene.metrics), now = after(scene, 80);  // the third is still far away
    double lost = 0;
    for (const std::string axis : {"x", "y"}) {
      double sum = 0;
      for (const std::string body : {"a", "b"})
        sum += now.at("body " + body + " momentum " + axis) - before.at("body " + body + " momentum " + axis);
      lost = std::hypot(lost, sum);
    }
    REQUIRE(now.at("pair b c normal impulse") == 0);
    CHECK(lost > 1e-4 * now.at("pair a b normal impulse"));
    CHECK(now.at("pair a b unbalanced impulse") == Approx(lost).epsilon(1e-6));
  }
}

TEST_CASE("the impulses of a block that slides are its weight and its friction over time", "[pairs][impulse]") {
  // The weight grows over a tenth of a second, so that half of that is missing.
  const double pressed = 80 * 9.81 * std::sqrt(0.75) * (0.4 - 0.05);
  for (const char* backend : {"reference", "cpu"}) {
    INFO(backend);
    Scene scene(leaning_block(0, 0.3), {set("/backend", backend)});
    while (!scene.simulation.finished()) scene.simulation.step();
    const Numbers now = chosen(scene.metrics);
    CHECK(now.at("pair bed block normal impulse") == Approx(pressed).epsilon(0.01));
    CHECK(now.at("pair bed block tangential impulse x") == Approx(0.3 * pressed).epsilon(0.01));
    CHECK(std::abs(now.at("pair bed block tangential impulse y")) < 0.01 * pressed);
    CHECK(now.at("pair bed block impulse y") == Approx(-pressed).epsilon(0.01));
  }
}

TEST_CASE("the gap of a pair is that of its surfaces, wherever they are nearest", "[pairs][gap]") {
  struct Pair {
    const char* name;
    int dimension;
    std::string first, second;
    double gap;   ///< m, at the start
    double rate;  ///< of it, at the start, 1
  };
  const std::string turned_square = R"({"type": "turned", "about": [0.3, 0], "angle": "45 deg", "of":
      {"type": "box", "lower": [0.2, -0.1], "upper": [0.4, 0.1]}})";
  const double corner = 0.3 - 0.1 * std::sqrt(2);
  // A disc before a corner, off its axis; a square before a face that is turned by 45 degrees, which its corner is nearest to;
  // discs; and in 3-D a ball before the edge of a box, which points at it along a diagonal.
  const double off = std::hypot(corner + 0.1, 0.07);
  for (const Pair& pair : {Pair{"corner", 2, R"({"type": "ball", "centre": [-0.1, 0.07], "radius": 0.12})",
                                turned_square, off - 0.12, -(corner + 0.1) / off},
                           Pair{"face", 2, R"({"type": "box", "lower": [-0.06, 0.12], "upper": [0.1, 0.28]})",
                                turned_square, (corner + 0.02) / std::sqrt(2), -1 / std::sqrt(2)},
                           Pair{"discs", 2, R"({"type": "ball", "centre": [-0.3, 0.1], "radius": 0.2})",
                                R"({"type": "ball", "centre": [0.2, -0.1], "radius": 0.15})",
                                std::hypot(0.5, 0.2) - 0.35, -0.5 / std::hypot(0.5, 0.2)},
                           Pair{"edge", 3, R"({"type": "ball", "centre": [-0.4, -0.4, 0], "radius": 0.2})",
                                R"({"type": "box", "lower": [0, 0, -0.3], "upper": [0.4, 0.4, 0.3]})",
                                0.4 * std::sqrt(2) - 0.2, -1 / std::sqrt(2)}})
    for (const char* backend : {"reference", "cpu"}) {
      INFO(pair.name << ", " << backend);
      Scene scene(flying(pair.dimension, pair.first, pair.second), {set("/backend", backend)});
      CHECK(chosen(scene.metrics).at("pair a b gap") == Approx(pair.gap).epsilon(1e-6));
      const Numbers now = after(scene, 10);  // a thousandth of a second, before they touch
      CHECK(now.at("pair a b gap") == Approx(pair.gap + 0.001 * pair.rate).margin(1e-4 * 0.001 + 1e-6 * pair.gap));
      CHECK(now.at("pair a b early force") == 0);
    }
  // The tip of a wedge between two half spaces, whose distances meet there, before a disc beside its axis.
  for (const double half_angle : {10.0, 20.0, 30.0}) {
    INFO("a wedge of " << half_angle << " degrees on each side");
    const double turn = half_angle * std::numbers::pi / 180;
    const std::string side = digits(std::sin(turn)), up = digits(std::cos(turn));
    const std::string wedge =
        R"({"type": "intersection", "of": [{"type": "half_space", "point": [0.1, 0], "normal": [-)" + side + ", " + up +
        R"(]}, {"type": "half_space", "point": [0.1, 0], "normal": [-)" + side + ", -" + up +
        R"(]}, {"type": "box", "lower": [-0.5, -0.5], "upper": [0.6, 0.5]}]})";
    Scene scene(flying(2, R"({"type": "ball", "centre": [-0.2, 0.04], "radius": 0.2})", wedge));
    CHECK(chosen(scene.metrics).at("pair a b gap") == Approx(std::hypot(0.3, 0.04) - 0.2).epsilon(1e-4));
  }
  Scene inside(flying(2, R"({"type": "ball", "centre": [0, 0], "radius": 0.2})",
                      R"({"type": "box", "lower": [0.17, -0.3], "upper": [0.5, 0.3]})"));
  CHECK(chosen(inside.metrics).at("pair a b gap") ==
        Approx(-0.03).margin(0.001));  // of pieces a quarter of a cell long
}

TEST_CASE("the gap of a body that has been stretched is that of its ellipse", "[pairs][gap]") {
  Scene scene(flying(2, R"({"type": "ball", "centre": [0, 0], "radius": 0.2})",
                     R"({"type": "ball", "centre": [0.6, 0.25], "radius": 0.15})"),
              {R"(/bodies/0/velocity=["4*x", "-3*y"])", "/materials/m/youngs_modulus=1e-3", "/solver/time_step=0.001"});
  const Numbers now = after(scene, 100);
  double truth = INFINITY;  // to the ellipse with the semi-axes 0.28 and 0.14
  for (double turn = 0; turn < 2 * std::numbers::pi; turn += 1e-4)
    truth = smaller(truth, std::hypot(0.6 - 0.28 * std::cos(turn), 0.25 - 0.14 * std::sin(turn)) - 0.15);
  CHECK(now.at("pair a b surface misfit") < 5e-4);
  CHECK(now.at("pair a b gap") == Approx(truth).margin(0.02 * 0.05));
}

TEST_CASE("a corner that reaches into a face leaves no gap open", "[pairs][gap]") {
  for (const double depth : {0.0005, 0.001, 0.002, 0.004, 0.02}) {
    INFO(depth << " m deep");
    const std::string corner = R"({"type": "turned", "about": [)" + digits(-0.1 * std::sqrt(2) + depth) +
                               R"(, 0], "angle": "45 deg", "of": {"type": "box", "lower": [)" +
                               digits(-0.1 * std::sqrt(2) + depth - 0.1) + R"(, -0.1], "upper": [)" +
                               digits(-0.1 * std::sqrt(2) + depth + 0.1) + ", 0.1]}}";
    Scene scene(flying(2, corner, R"({"type": "box", "lower": [0, -0.3], "upper": [0.3, 0.3]})"),
                {R"(/contact/detection="approach")"});
    CHECK(chosen(scene.metrics).at("pair a b gap") <= 0);
    const Numbers now = after(scene, 1);
    CHECK(now.at("pair a b normal force") > 1);
    CHECK(now.at("pair a b early force") == 0);
  }
}

TEST_CASE("a force across an open gap is early, and a gap where the law acts is told", "[pairs][gap]") {
  // Blocks 0.6 cells apart: without regard to their distance they feel one another at once, by surfaces not at all.
  const std::string first = R"({"type": "box", "lower": [-0.3, -0.15], "upper": [0, 0.15]})",
                    second = R"({"type": "box", "lower": [0.03, -0.15], "upper": [0.4, 0.15]})";
  for (const char* backend : {"reference", "cpu"}) {
    INFO(backend);
    const auto push = [&](const char* detection) {
      Scene scene(flying(2, first, second),
                  {set("/backend", backend), set("/contact/detection", detection), R"(/contact/normal="widest_gap")"});
      return after(scene, 5);
    };
    const Numbers by_approach = push("approach"), by_surfaces = push("particle_surfaces");
    CHECK(by_approach.at("pair a b gap") == Approx(0.03 - 5e-4).margin(1e-4));
    CHECK(by_approach.at("pair a b early force") ==
          Approx(std::hypot(by_approach.at("pair a b force x"), by_approach.at("pair a b force y"))));
    CHECK(by_approach.at("pair a b early force") > 1);
    CHECK(by_surfaces.at("pair a b gap") == Approx(0.03 - 5e-4).margin(1e-7));
    CHECK(by_surfaces.at("pair a b early force") == 0);
    CHECK(by_surfaces.at("pair a b largest gap") == 0);

    // Blocks a fifth of a cell apart that adhesion holds together.
    Scene held(flying(2, first, R"({"type": "box", "lower": [0.01, -0.15], "upper": [0.4, 0.15]})"),
               {set("/backend", backend), R"(/contact={"type": "adhesion", "normal_strength": 1e9,
                   "shear_strength": 1e9, "normal": "widest_gap", "detection": "particle_surfaces"})"});
    CHECK(after(held, 3).at("pair a b largest gap") == Approx(0.01).margin(4e-4));
  }
}
