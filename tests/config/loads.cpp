// Loads in experiment files: what is read, and the texts of mistakes.
#include "config/config_support.hpp"
#include "support/catch.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// The two discs with loads on them.
std::string with_loads(const std::string& loads) {
  return replaced(two_discs, "  \"solver\": {", "  \"loads\": [" + loads + "],\n  \"solver\": {");
}

const std::string left_half = R"("where": {"type": "half_space", "point": [0.2, 0.2], "normal": [1, 0]})";

}  // namespace

TEST_CASE("loads of every type are read", "[config][loads]") {
  const Experiment e =
      read_text(with_loads(R"({"type": "traction", "body": "left", )" + left_half + R"(, "traction": ["A*t", "2 kPa"]},
         {"type": "pressure", "body": "left", )" +
                           left_half + R"(, "pressure": "3 kPa"},
         {"type": "pressure", "body": "left", )" +
                           left_half + R"(, "pressure": "X*t", "follower": false},
         {"type": "force", "body": "right", "at": [0.75, 0.7], "force": [1, "2 N"]},
         {"type": "body_force", "body": "right", "acceleration": [1, 0]},
         {"type": "spring", "body": "left", )" +
                           left_half + R"(, "damping": [0, 5]})"));
  REQUIRE(e.loads.size() == 6);
  const LoadType types[] = {LoadType::traction, LoadType::pressure,   LoadType::pressure,
                            LoadType::force,    LoadType::body_force, LoadType::spring};
  for (int k = 0; k < 6; ++k) {
    CHECK(e.loads[k].type == types[k]);
    CHECK(e.loads[k].body == (k == 3 || k == 4));
    CHECK(e.loads[k].pointer == "/loads/" + std::to_string(k));
  }
  CHECK(e.loads[0].value({}, {}, 2)[0] == 0.1);
  CHECK(e.loads[0].value({}, {}, 2)[1] == 2000);
  CHECK(e.loads[1].follower);
  CHECK_FALSE(e.loads[2].follower);
  CHECK(e.loads[3].from[0] == 0.75);
  CHECK(e.loads[5].stiffness[1] == 0);
  CHECK(e.loads[5].damping[1] == 5);
  CHECK(e.loads[5].gives(ExternalForce::dashpot));
  CHECK_FALSE(e.loads[5].gives(ExternalForce::spring));
  CHECK(e.giver_of(ExternalForce::surface_load, 1).empty());
  CHECK(e.giver_of(ExternalForce::body_force) == "/body_force");
  CHECK(read_text(e.resolved.dump()).resolved == e.resolved);
}

TEST_CASE("mistakes in loads are named with their place", "[config][loads]") {
  const auto check = [](const std::string& load, const std::string& text) {
    const std::string found = errors(with_loads(load));
    INFO(found);
    CHECK(found.find(text) != std::string::npos);
    CHECK(found.find("FILE:32:") == 0);
  };
  check(R"({"type": "tracton", "body": "left"})",
        "/loads/0/type: unknown load \"tracton\"; did you mean \"traction\"?");
  check(R"({"type": "force", "body": "lift", "at": [0.2, 0.2], "force": [1, 0]})",
        "/loads/0/body: there is no body \"lift\"; did you mean \"left\"? (bodies: \"left\", \"right\")");
  check(
      R"({"type": "traction", "body": "left", "where": {"type": "ball", "centre": [0.2, 0.2], "radius": 0.1}, "traction": [1, 0]})",
      "/loads/0/where: none of the surface of body \"left\" lies in this region");
  check(R"({"type": "force", "body": "left", "at": [0.5, 0.2], "force": [1, 0]})",
        "/loads/0/at: the point (0.5, 0.2) is not in body \"left\"");
  check(R"({"type": "pressure", "body": "left", )" + left_half + R"(, "pressure": [1, 0]})",
        "/loads/0/pressure: expected");
  check(R"({"type": "spring", "body": "left", )" + left_half + "}", "/loads/0: does nothing");
  check(R"({"type": "spring", "body": "left", )" + left_half + R"(, "stiffness": [-1, 0]})",
        "/loads/0/stiffness: expected at least 0 along x, got -1");
  check(R"({"type": "line_force", "body": "left", "from": [0.2, 0.2], "to": [0.3, 0.2], "force": [1, 0]})",
        "load \"line_force\" works in 3-D only");
  CHECK(errors(with_loads(R"({"type": "spring", "body": "left", )" + left_half + R"(, "stiffness": [1, 0]})"),
               {R"(/grid/boundaries={"all": "slip", "x_min": "periodic", "x_max": "periodic"})"})
            .find("/loads/0/stiffness: a spring cannot pull along the periodic axis x") != std::string::npos);
}
