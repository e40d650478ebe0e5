// Fields of particles as files hold them, their domains, and the nodes that they are mapped to, against closed forms.

#include "metrics/particle_values.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "metrics/mapped_grid.hpp"
#include "support/catch.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::test;
using Json = nlohmann::ordered_json;

namespace {

/// A block that is stretched and sheared as it begins, far from all walls.
std::string block(const std::string& shape, const std::string& transfer, const std::string& material, int dimension) {
  const std::string space = dimension == 3 ? ", 0" : "", far = dimension == 3 ? ", 2" : "",
                    low = dimension == 3 ? ", 0.5" : "", high = dimension == 3 ? ", 1" : "";
  return R"J({"dimension": )J" + std::to_string(dimension) + R"J(, "grid": {"cell_size": 0.25, "domain": [[0, 0)J" +
         space + R"J(], [2, 2)J" + far + R"J(]], "boundaries": {"all": "free"}}, "shape": {"type": ")J" + shape +
         R"J("}, "transfer": {"type": ")J" + transfer + R"J("}, "materials": {"m": )J" + material +
         R"J(}, "bodies": [{"name": "b", "material": "m", "geometry": {"type": "box", "lower": [0.5, 0.5)J" + low +
         R"J(], "upper": [1, 1)J" + high + R"J(]}, "velocity": ["0.2*y", "0.1*y+1")J" +
         std::string(dimension == 3 ? ", \"0.3*z\"" : "") +
         R"J(]}], "solver": {"time_step": 0.001, "end_time": 0.01}, "output": {"particles": {"fields": "all", "count": 2}}})J";
}

const std::string rubber =
    R"J({"type": "neo_hookean", "youngs_modulus": 1000, "poisson_ratio": 0.3, "density": 1000})J";
const std::string metal =
    R"J({"type": "von_mises", "youngs_modulus": 1e6, "poisson_ratio": 0.3, "yield_stress": 1, "density": 1000})J";

std::vector<double> field(Scene& scene, const std::string& name) {
  return particle_values(scene.experiment, {scene.body()}, {name})[0].values;
}

/// The area of a quadrilateral whose corners go around it.
double area(const double* x) {
  double twice = 0;
  for (int k = 0; k < 4; ++k) {
    const double *a = x + 3 * k, *b = x + 3 * ((k + 1) % 4);
    twice += a[0] * b[1] - b[0] * a[1];
  }
  return twice / 2;
}

}  // namespace

TEST_CASE("fields of particles agree with one another and with the state", "[metrics]") {
  for (const int D : {2, 3}) {
    INFO(D);
    Scene scene(block("bspline_quadratic", "apic", rubber, D));
    scene.run();
    const BodyState state = scene.body();
    const auto n = state.position.size() / static_cast<std::size_t>(D);
    const auto names = scene.experiment.particle_output->fields;
    CHECK(std::find(names.begin(), names.end(), "affine_velocity") != names.end());
    CHECK(std::find(names.begin(), names.end(), "temperature") == names.end());
    const auto all = particle_values(scene.experiment, {state}, names);
    REQUIRE(all.size() == names.size());
    for (const ParticleValues& one : all) {
      INFO(one.field.name);
      CHECK(one.values.size() == n * static_cast<std::size_t>(one.field.shape));
      CHECK(std::all_of(one.values.begin(), one.values.end(), [](double x) { return std::isfinite(x); }));
    }
    const auto F = field(scene, "deformation_gradient"), J = field(scene, "volume_ratio"),
               sigma = field(scene, "cauchy_stress"), tau = field(scene, "kirchhoff_stress"),
               p = field(scene, "pressure"), mises = field(scene, "von_mises_stress"), v = field(scene, "velocity"),
               u = field(scene, "displacement"), X = field(scene, "initial_position"), volume = field(scene, "volume"),
               mass = field(scene, "mass"), C = field(scene, "affine_velocity");
    const auto x = particle_positions(scene.experiment, {state});
    for (std::size_t k = 0; k < n; ++k) {
      const double* f = &F[9 * k];
      const double det =
          f[0] * (f[4] * f[8] - f[5] * f[7]) - f[1] * (f[3] * f[8] - f[5] * f[6]) + f[2] * (f[3] * f[7] - f[4] * f[6]);
      CHECK(det == Approx(J[k]));
      if (D == 2) CHECK(f[8] == 1);
      CHECK(volume[k] == Approx(J[k] * std::pow(0.125, D)));
      CHECK(mass[k] == Approx(1000 * std::pow(0.125, D)));
      for (std::size_t c = 0; c < 9; ++c) CHECK(tau[9 * k + c] == Approx(J[k] * sigma[9 * k + c]));
      CHECK(sigma[9 * k + 1] == sigma[9 * k + 3]);
      const double* s = &sigma[9 * k];
      CHECK(p[k] == Approx(-(s[0] + s[4] + s[8]) / 3));
      const double j2 = (std::pow(s[0] - s[4], 2) + std::pow(s[4] - s[8], 2) + std::pow(s[8] - s[0], 2)) / 6 +
                        s[1] * s[1] + s[2] * s[2] + s[5] * s[5];
      CHECK(mises[k] == Approx(std::sqrt(3 * j2)));
      for (std::size_t c = 0; c < 3; ++c) CHECK(u[3 * k + c] == Approx(x[3 * k + c] - X[3 * k + c]).margin(1e-14));
      CHECK(v[3 * k] == state.velocity[k * static_cast<std::size_t>(D)]);
      if (D == 2) CHECK((v[3 * k + 2] == 0 && C[9 * k + 8] == 0 && x[3 * k + 2] == 0));
    }
    // Away from the block's rim nothing has disturbed the first steps: u = t v0(X), F = 1 + t grad v0.
    const double t = 0.01;
    const auto largest = [&](std::size_t c, double wanted) {
      double away = 0;
      for (std::size_t k = 0; k < n; ++k) away = larger(away, std::abs(F[9 * k + c] - wanted));
      return away;
    };
    CHECK(largest(1, 0.2 * t) < 2e-4);
    CHECK(largest(4, 1 + 0.1 * t) < 2e-4);
  }
}

TEST_CASE("every state of every material and transfer is a field of particles by its name", "[metrics]") {
  for (const int D : {2, 3})
    for (const std::string transfer : {"pic", "flip", "apic", "mls", "rpic", "tpic", "aflip", "asflip", "polypic"})
      for (const std::string& material : {rubber, metal}) {
        INFO(D << " " << transfer << " " << material);
        Scene scene(block("bspline_quadratic", transfer, material, D));
        scene.run();
        const BodyState state = scene.body();
        const auto names = scene.experiment.particle_output->fields;
        const auto n = state.position.size() / static_cast<std::size_t>(D);
        const auto has = [&](const std::string& name) {
          return std::find(names.begin(), names.end(), name) != names.end();
        };
        for (const auto* states : {&state.material_state, &state.transfer_state})
          for (const auto& [name, values] : *states) {
            INFO(name);
            if (name == "polynomial_coefficients") continue;  // a field each, below
            CHECK(has(name));
            CHECK(field(scene, name).size() >= n);
          }
        CHECK(has("affine_velocity") == (state.transfer_state.count("affine_velocity") > 0));
        const bool polynomials = transfer == "polypic";
        CHECK(state.transfer_state.count("polynomial_coefficients") == polynomials);
        for (const char* name :
             {"polynomial_11", "polynomial_110", "polynomial_101", "polynomial_011", "polynomial_111"})
          CHECK(has(name) == (polynomials && (std::string(name).size() == 13) == (D == 2)));
      }
}

TEST_CASE("the coefficient of d_x d_y is the one of a velocity field that has it", "[metrics]") {
  // Of v = (3 x y, 0, 0) about a particle at x_p the coefficient of d_x d_y is 3 / s, whatever x_p is: in 3-D too.
  for (const int D : {2, 3})
    for (const std::string backend : {"cpu", "reference"}) {
      INFO(D << " " << backend);
      Json scene = Json::parse(block("bspline_quadratic", "polypic", rubber, D));
      scene["backend"] = backend;
      scene["bodies"][0]["velocity"] = D == 2 ? Json{"3*x*y", 0} : Json{"3*x*y", 0, 0};
      scene["bodies"][0]["geometry"]["upper"] = D == 2 ? Json{1.75, 1.75} : Json{1.75, 1.75, 1.75};
      scene["bodies"][0]["geometry"]["lower"] = D == 2 ? Json{0.25, 0.25} : Json{0.25, 0.25, 0.25};
      scene["materials"]["m"]["youngs_modulus"] = 1e-6;
      scene["solver"]["time_step"] = 1e-6;
      scene["solver"]["end_time"] = 40e-6;
      Scene built(scene.dump());
      built.run();
      const auto x = particle_positions(built.experiment, {built.body()});
      const auto c = field(built, D == 2 ? "polynomial_11" : "polynomial_110");
      REQUIRE(c.size() == x.size());
      std::size_t inside = 0;
      for (std::size_t p = 0; p < c.size(); p += 3) {
        bool whole = true;  // no rim within the stencils
        for (int a = 0; a < D; ++a) whole = whole && std::abs(x[p + static_cast<std::size_t>(a)] - 1) < 0.3;
        if (!whole) continue;
        ++inside;
        CHECK(c[p] == Approx(3 * 0.25 * 0.25).epsilon(0.02));  // the field is in lengths of cells
        CHECK(std::abs(c[p + 1]) < 1e-3);
        CHECK(std::abs(c[p + 2]) < 1e-3);
      }
      CHECK(inside >= 16);
      if (D == 3)
        for (const char* other : {"polynomial_101", "polynomial_011", "polynomial_111"})
          for (const double value : {field(built, other)[3 * (c.size() / 6)]}) CHECK(std::abs(value) < 1e-3);
    }
}

TEST_CASE("particles of another material have no number where a field is not theirs", "[metrics]") {
  Json scene = Json::parse(block("bspline_quadratic", "flip", rubber, 2));
  scene["materials"]["metal"] = Json::parse(metal);
  Json other = scene["bodies"][0];
  other["name"] = "other", other["material"] = "metal";
  other["geometry"] = {{"type", "box"}, {"lower", {1.25, 1.25}}, {"upper", {1.5, 1.5}}};
  scene["bodies"].push_back(other);
  Scene built(scene.dump());
  std::vector<BodyState> states;
  for (const int body : {0, 1}) states.push_back(built.simulation.backend().body_state(body));
  const auto F = particle_values(built.experiment, states, {"deformation_gradient"})[0].values;
  const auto strain = particle_values(built.experiment, states, {"equivalent_plastic_strain"})[0].values;
  const auto body = particle_values(built.experiment, states, {"body"})[0].values;
  REQUIRE(body.size() == 20);
  for (std::size_t p = 0; p < 20; ++p) {
    CHECK(body[p] == (p < 16 ? 0 : 1));
    CHECK(std::isnan(F[9 * p]) == (p >= 16));
    CHECK(std::isnan(strain[p]) == (p < 16));
  }
}

TEST_CASE("domains are what the shape carries, else the box that F deforms, else that box", "[metrics]") {
  const double box = 0.125 * 0.125;
  for (const auto& [shape, material, deforms] :
       {std::tuple{"cpdi", rubber, true}, std::tuple{"cpdi2", rubber, true},
        std::tuple{"bspline_quadratic", rubber, true}, std::tuple{"bspline_quadratic", metal, false}}) {
    INFO(shape << " " << material);
    Scene scene(block(shape, "flip", material, 2));
    const auto start = particle_domains(scene.experiment, {scene.body()});
    const std::size_t n = scene.body().position.size() / 2;
    REQUIRE(start.size() == n * 12);
    // Around the first particle, whose box begins at the body's lower corner.
    const double corners[4][2] = {{0.5, 0.5}, {0.625, 0.5}, {0.625, 0.625}, {0.5, 0.625}};
    for (std::size_t k = 0; k < 4; ++k)
      for (std::size_t c = 0; c < 2; ++c) CHECK(start[3 * k + c] == Approx(corners[k][c]));
    scene.run();
    const auto domains = particle_domains(scene.experiment, {scene.body()});
    const auto J = field(scene, "volume_ratio");
    const auto F =
        deforms && std::string(shape) != "cpdi2" ? field(scene, "deformation_gradient") : std::vector<double>();
    for (std::size_t p = 0; p < n; ++p) {
      double middle[2] = {0, 0};
      for (std::size_t k = 0; k < 4; ++k)
        for (std::size_t c = 0; c < 2; ++c) middle[c] += domains[12 * p + 3 * k + c] / 4;
      for (std::size_t c = 0; c < 2; ++c) CHECK(middle[c] == Approx(scene.body().position[2 * p + c]));
      // The side along x is F times a box's.
      const double* corner = &domains[12 * p];
      for (std::size_t c = 0; c < 2 && !F.empty(); ++c)
        CHECK(corner[3 + c] - corner[c] == Approx(0.125 * F[9 * p + 3 * c]).margin(1e-14));
      CHECK(area(&domains[12 * p]) ==
            Approx(deforms ? box * J[p] : box).epsilon(std::string(shape) == "cpdi2" ? 1e-3 : 1e-9));
    }
  }
}

TEST_CASE("a box in space is a hexahedron of the particle's volume in VTK's order", "[metrics]") {
  Scene scene(block("bspline_quadratic", "flip", rubber, 3));
  const auto domains = particle_domains(scene.experiment, {scene.body()});
  const double h = 0.125;
  const double wanted[8][3] = {{0, 0, 0}, {h, 0, 0}, {h, h, 0}, {0, h, 0}, {0, 0, h}, {h, 0, h}, {h, h, h}, {0, h, h}};
  for (std::size_t k = 0; k < 8; ++k)
    for (std::size_t c = 0; c < 3; ++c) CHECK(domains[3 * k + c] == Approx(0.5 + wanted[k][c]));
}

TEST_CASE("nodes carry the mass and momentum of the particles, in every shape", "[metrics]") {
  for (const char* shape : {"linear", "gimp", "gimp_contiguous", "bspline_quadratic", "bspline_cubic", "cpdi", "cpdi2"})
    for (const int D : {2, 3}) {
      INFO(shape << " " << D);
      if (std::string(shape) == "gimp_contiguous" && D == 3) continue;
      const std::string many = D == 3 ? "8" : "2";  // in space more particles than are mapped at a time
      Scene scene(block(shape, "flip", rubber, D), {"/bodies/0/particles_per_cell_axis=" + many});
      const BodyState state = scene.body();
      const MappedGrid grid = mapped_grid(scene.experiment, {state}, 0);
      CHECK(grid.nodes == (D == 2 ? std::array{9, 9, 1} : std::array{9, 9, 9}));
      REQUIRE(grid.fields.size() == 1);
      const auto& [mass, velocity] = grid.fields[0];
      // A box of half a metre, its density 1000; its mean velocity is that at its centre, y = 0.75.
      const double total = 1000 * std::pow(0.5, D);
      double sum = 0, px = 0, py = 0, pz = 0, moment = 0;
      for (std::size_t k = 0; k < mass.size(); ++k) {
        sum += mass[k];
        px += mass[k] * velocity[3 * k];
        py += mass[k] * velocity[3 * k + 1];
        pz += mass[k] * velocity[3 * k + 2];
        moment += mass[k] * 0.25 * static_cast<double>(k % 9);
      }
      CHECK(sum == Approx(total));
      CHECK(px == Approx(total * 0.2 * 0.75));
      CHECK(py == Approx(total * (0.1 * 0.75 + 1)));
      CHECK(pz == Approx(D == 3 ? total * 0.3 * 0.75 : 0));
      CHECK(moment == Approx(total * 0.75));  // the weights reproduce linear functions
    }
}

TEST_CASE("images behind walls are folded, and walls hold what they hold", "[metrics]") {
  // A box that fills the domain and moves as one: inside every node has a whole cell's mass; on a wall half of one.
  Json scene = Json::parse(block("bspline_quadratic", "flip", rubber, 2));
  scene["bodies"][0]["geometry"] = {{"type", "box"}, {"lower", {0, 0}}, {"upper", {2, 2}}};
  scene["bodies"][0]["velocity"] = {3, 4};
  scene["grid"]["boundaries"] = {{"all", "slip"}, {"y_min", "stick"}};
  {
    Scene built(scene.dump());
    const MappedGrid grid = mapped_grid(built.experiment, {built.body()}, 0);
    const auto& [mass, velocity] = grid.fields[0];
    const double total = std::accumulate(mass.begin(), mass.end(), 0.0);
    CHECK(total == Approx(4000));
    const auto at = [](std::size_t i, std::size_t j) { return i + 9 * j; };
    CHECK(mass[at(4, 4)] == Approx(1000 * 0.0625));
    CHECK(velocity[3 * at(4, 4)] == Approx(3));
    CHECK(velocity[3 * at(4, 4) + 1] == Approx(4));
    CHECK(velocity[3 * at(0, 4)] == 0);
    CHECK(velocity[3 * at(0, 4) + 1] == Approx(4));
    CHECK(velocity[3 * at(4, 0)] == 0);
    CHECK(velocity[3 * at(4, 0) + 1] == 0);
    // The first particles stand a quarter of a cell behind a wall: their images reach the first node inside with a
    // weight of (3/2 - 5/4)^2 / 2, and are half of the particles there, so that they are a 64th of its mass.
    const double left = 1 - 2.0 / 64;
    CHECK(velocity[3 * at(1, 4)] == Approx(3 * left));
    CHECK(velocity[3 * at(1, 4) + 1] == Approx(4));
    CHECK(velocity[3 * at(4, 1)] == Approx(3 * left));
    CHECK(velocity[3 * at(4, 1) + 1] == Approx(4 * left));
    CHECK(velocity[3 * at(4, 8)] == Approx(3));
    CHECK(velocity[3 * at(4, 8) + 1] == 0);
  }
  scene["grid"]["boundaries"] = {{"all", "periodic"}};
  Scene built(scene.dump());
  const MappedGrid grid = mapped_grid(built.experiment, {built.body()}, 0);
  for (std::size_t k = 0; k < 81; ++k) {
    CHECK(grid.fields[0].mass[k] == Approx(62.5));
    CHECK(grid.fields[0].velocity[3 * k] == Approx(3));
  }
}
