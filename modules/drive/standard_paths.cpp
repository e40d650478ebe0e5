#include "drive/standard_paths.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <vector>

#include "drive/read_drive.hpp"

namespace mpm::drive {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<StandardPath, 5> paths{
    {{"uniaxial", "stretched along x and back, the other sides free", "E"},
     {"simple_shear", "sheared in the plane x, y and back, the volume kept", "G"},
     {"isotropic", "pressed along all axes and back", "K"},
     {"cyclic", "stretched, pressed, stretched and back along x, the other sides free", "E"},
     {"oedometer", "pressed along x and back, the other sides held", "M"}}};

/// The formula that goes from one value to another over a stage.
std::string ramp(double from, double to, double duration) {
  const auto text = [](double value) { return Json(value).dump(); };
  return text(from) + " + (" + text(to - from) + ")*t/" + text(duration);
}

}  // namespace

std::span<const StandardPath> standard_paths() {
  return paths;
}

Json standard_path(const std::string& name, const PathSize& size, const Json& material) {
  const auto path = std::find_if(paths.begin(), paths.end(), [&](const StandardPath& p) { return name == p.name; });
  if (path == paths.end()) throw std::invalid_argument("no standard path is called " + name);
  const bool flat = size.dimension == 2, is_free = name == "uniaxial" || name == "cyclic";
  const double turn = name == "isotropic" || name == "oedometer" ? -size.strain : size.strain;
  std::vector<double> turns{0, turn, 0};
  if (name == "cyclic") turns = {0, turn, -turn, turn, 0};
  std::vector<std::string> driven{"xx"};
  if (name == "simple_shear") driven = {"xy"};
  if (name == "isotropic")
    driven = flat ? std::vector<std::string>{"xx", "yy"} : std::vector<std::string>{"xx", "yy", "zz"};
  const double rest = name == "simple_shear" ? 0 : 1;

  Json stages = Json::array();
  for (std::size_t k = 1; k < turns.size(); ++k) {
    const double ways = turns[k] * turns[k - 1] < 0 ? 2 : 1;  // from one side to the other at the same rate
    Json stage{{"name", "way_" + std::to_string(k)},
               {"duration", ways * size.duration},
               {"steps", static_cast<int>(ways) * size.steps}};
    for (const std::string& component : driven)
      stage["deformation_gradient"][component] = ramp(rest + turns[k - 1], rest + turns[k], ways * size.duration);
    if (is_free) stage["stress"] = flat ? Json{{"yy", 0}} : Json{{"yy", 0}, {"zz", 0}};
    stages.push_back(std::move(stage));
  }
  const std::string id = material.at("type");
  return {{"title", id + ", " + name},
          {"description", std::string("A standard path: ") + path->doc + "."},
          {"dimension", size.dimension},
          {"materials", {{"m", material}}},
          {"solver", {{"type", solver_name}, {"stages", std::move(stages)}}}};
}

}  // namespace mpm::drive
