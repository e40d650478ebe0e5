// Bodies: geometry, material, velocity field.
#include <algorithm>
#include <cmath>

#include "experiment/axis_names.hpp"
#include "experiment/places.hpp"
#include "experiment/reader.hpp"

namespace mpm {
namespace {

constexpr double most_places = 1e4;   ///< the same of particles placed, for seedings beside the lattice
constexpr double most_samples = 4e6;  ///< bound on points tried, so that looking for a body's first one stays quick

}  // namespace

void ExperimentReader::read_bodies(const Node* node) {
  if (!node || !is_list(*node, "bodies", false)) return;
  OrderedJson& resolved = resolved_["bodies"] = OrderedJson::array();
  for (const Node& item : node->items) resolved.push_back(read_body(item));
  assign_fields(*node);
}

int ExperimentReader::material_index(const Fields& fields) {
  if (!fields.valid("material")) return 0;
  std::vector<std::string> names;
  for (const MaterialSpecification& material : experiment_.materials) names.push_back(material.name);
  const auto found = std::find(names.begin(), names.end(), fields.text("material"));
  if (found != names.end()) return static_cast<int>(found - names.begin());
  const std::string& name = fields.text("material");
  const std::string list = "materials: " + (names.empty() ? "none" : quoted_list(names));
  problem(fields.place("material"), "there is no material " + in_quotes(name) + suggestion(name, names, list));
  return 0;
}

OrderedJson ExperimentReader::read_body(const Node& node) {
  const Fields fields(&node, body_section(), context_);
  OrderedJson resolved = fields.resolved;
  BodySpecification body;
  body.name = fields.text("name");
  body.pointer = node.pointer;
  body.particles_per_cell_axis = fields.integer("particles_per_cell_axis");
  body.jitter = fields.number("jitter");
  body.frozen = fields.boolean("frozen");
  body.velocity = fields.expression("velocity");
  if (fields.given("temperature")) body.temperature = fields.scalar_expression("temperature");
  body.material = material_index(fields);
  if (fields.valid("name")) check_word(fields, "name");
  for (const BodySpecification& other : experiment_.bodies) {
    if (fields.valid("name") && other.name == body.name) {
      problem(fields.place("name"), "there are two bodies named " + in_quotes(body.name));
      break;
    }
  }
  resolved["seeding"] = read_seeding(fields.node("seeding"), body);
  read_initial_state(fields, body, resolved);
  if (body.jitter > 0 && body.seeding.kind >= SeedingKind::random)
    problem(*fields.node("jitter"), "jitter moves particles off a lattice, and these lie on none; remove it");
  const bool from_points = body.seeding.kind == SeedingKind::points;
  const Node* const geometry = fields.node("geometry");
  const bool given_later = !geometry && !from_points && may_start_empty(body.name);
  if (given_later) {
    body.starts_empty = true;
    body.geometry = make_nothing(experiment_.grid.lower);
  } else if (!geometry && !from_points)
    context_.problem(node.at, child_pointer(node.pointer, "geometry"), "missing key; expected a geometry");
  if (geometry && from_points)
    problem(*geometry, "the points of the file are the body; remove \"geometry\"");
  else if (geometry) {
    body.geometry = read_geometry(*geometry, context_, resolved["geometry"]);
    if (body.geometry && grid_good_ && fields.valid("particles_per_cell_axis")) check_inside(body, *geometry);
  }
  if (fields.given("field") && !experiment_.contact) {
    problem(fields.place("field"), "without \"contact\" all bodies share one velocity field; remove \"field\"");
  }
  if (fields.given("field") && fields.valid("field")) check_word(fields, "field");
  read_becoming(fields, body, resolved);
  field_choices_.push_back(fields.given("field") ? fields.text("field") : "");
  experiment_.bodies.push_back(std::move(body));
  return resolved;
}

void ExperimentReader::check_inside(const BodySpecification& body, const Node& place) {
  const auto [lower, upper] = body.geometry->bounds();
  const GridSpecification& grid = experiment_.grid;
  bool inside = true;
  for (int axis = 0; axis < context_.dimension; ++axis) {
    const double slack = 1e-9 * (grid.upper[axis] - grid.lower[axis]);
    const bool below = std::isfinite(lower[axis]) && lower[axis] < grid.lower[axis] - slack;
    const bool above = std::isfinite(upper[axis]) && upper[axis] > grid.upper[axis] + slack;
    if (!below && !above) continue;
    inside = false;
    const double low = std::isfinite(lower[axis]) ? lower[axis] : grid.lower[axis];
    const double high = std::isfinite(upper[axis]) ? upper[axis] : grid.upper[axis];
    problem(place, "the body reaches outside the domain: " + std::string(axis_names[axis]) + " from " +
                       number_text(low) + " to " + number_text(high) + " m, where the domain spans " +
                       number_text(grid.lower[axis]) + " to " + number_text(grid.upper[axis]) + " m");
  }
  if (inside && !holds_a_particle(body)) {
    problem(place, "no particle lies in the body: it is empty, or thinner than the particle spacing of " +
                       number_text(grid.cell_size / body.particles_per_cell_axis) + " m");
  }
}

bool ExperimentReader::holds_a_particle(const BodySpecification& body) const {
  const GridSpecification& grid = experiment_.grid;
  const auto [lower, upper] = body.geometry->bounds();
  const double spacing = grid.cell_size / body.particles_per_cell_axis;
  if (body.seeding.kind != SeedingKind::lattice) {
    double cells = 1;
    for (int axis = 0; axis < context_.dimension; ++axis) {
      const double inside = std::min(upper[axis], grid.upper[axis]) - std::max(lower[axis], grid.lower[axis]);
      if (!(inside > 0)) return false;
      cells *= inside / spacing;
    }
    return cells > most_places || !place_particles({grid, context_.dimension, 0}, body).points.empty();
  }
  std::array<long, 3> first{0, 0, 0}, last{0, 0, 0};
  double samples = 1;
  for (int axis = 0; axis < context_.dimension; ++axis) {
    const double most = static_cast<double>(grid.cells[axis]) * body.particles_per_cell_axis - 1;
    const double low = std::floor((lower[axis] - grid.lower[axis]) / spacing - 0.5);
    const double high = std::ceil((upper[axis] - grid.lower[axis]) / spacing - 0.5);
    first[axis] = static_cast<long>(std::clamp(low, 0.0, most));
    last[axis] = static_cast<long>(std::clamp(high, 0.0, most));
    samples *= std::max(0.0, static_cast<double>(last[axis] - first[axis] + 1));
  }
  if (samples > most_samples) return true;  // placing the particles will tell
  const auto centre = [&](int axis, long i) {
    return axis < context_.dimension ? grid.lower[axis] + (static_cast<double>(i) + 0.5) * spacing : 0.0;
  };
  for (long k = first[2]; k <= last[2]; ++k) {
    for (long j = first[1]; j <= last[1]; ++j) {
      for (long i = first[0]; i <= last[0]; ++i) {
        if (body.geometry->contains({centre(0, i), centre(1, j), centre(2, k)})) return true;
      }
    }
  }
  return false;
}

void ExperimentReader::assign_fields(const Node& bodies) {
  if (!experiment_.contact || experiment_.bodies.empty()) return;
  std::vector<std::string>& names = experiment_.field_names;
  for (std::size_t i = 0; i < experiment_.bodies.size(); ++i) {
    BodySpecification& body = experiment_.bodies[i];
    const std::string& name = field_choices_[i].empty() ? body.name : field_choices_[i];
    auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) found = names.insert(names.end(), name);
    body.field = static_cast<int>(found - names.begin());
    resolved_["bodies"][i]["field"] = name;
  }
  experiment_.field_count = static_cast<int>(names.size());
  const Node& contact = *root_.find("contact");
  const bool one_body = experiment_.bodies.size() == 1;
  const bool same_names = std::all_of(field_choices_.begin(), field_choices_.end(), [](auto& f) { return f.empty(); });
  if (names.size() < 2 && (one_body || !same_names)) {  // equal body names are a problem reported already
    const std::string which = one_body ? "there is one body, " + in_quotes(experiment_.bodies[0].name)
                                       : "all bodies name the field " + in_quotes(names[0]);
    problem(contact, "contact needs two velocity fields or more, but " + which +
                         (one_body ? "; remove \"contact\" or add a body" : ""));
  }
  if (names.size() > most_fields) {
    problem(bodies, "at most " + std::to_string(most_fields) + " velocity fields, got " + std::to_string(names.size()) +
                        "; give bodies that need no contact between them one \"field\"");
  }
}

}  // namespace mpm
