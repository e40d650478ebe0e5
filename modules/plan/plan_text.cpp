// A plan as a person and as a program reads it.
#include <ostream>
#include <sstream>

#include "plan/plan.hpp"

namespace mpm {
namespace {

std::string padded(std::string text, std::size_t width) {
  if (text.size() < width) text.resize(width, ' ');
  return text + "  ";
}

}  // namespace

std::string Pass::name() const {
  switch (kind) {
    case PassKind::estimate_time_step:
      return "estimate time step";
    case PassKind::sort:
      return "sort";
    case PassKind::reset_grid:
      return "reset grid";
    case PassKind::scatter:
      return remap ? "scatter again" : momentum && force ? "scatter" : momentum ? "scatter momentum" : "scatter force";
    case PassKind::momentum_to_velocity:
      return remap ? "momentum to velocity again" : "momentum to velocity";
    case PassKind::apply_forces:
      return "apply forces";
    case PassKind::gather:
      return !strain ? "gather" : strain_share < 1 ? "gather and half strain" : "gather and strain";
    case PassKind::strain:
      return strain_share < 1 ? "half strain" : "strain";
    case PassKind::move:
      return "move";
    case PassKind::gather_scatter:
      return "gather, strain and scatter";
    case PassKind::begin_filter:
      return "begin filter";
    case PassKind::project:
      return "project";
    case PassKind::update_filter:
      return "update filter";
    case PassKind::end_filter:
      return "end filter";
    case PassKind::restore_velocity:
      return "restore velocity";
    case PassKind::add_correction:
      return "add correction";
    case PassKind::group:
      return condition == PassCondition::unless_scattered ? "unless scattered"
             : condition == PassCondition::when_filtered  ? "when filtered"
                                                          : "group";
    case PassKind::repeat:
      return "repeat";
  }
  return "";
}

namespace {

nlohmann::ordered_json to_json(const std::vector<Pass>& passes) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Pass& p : passes) {
    nlohmann::ordered_json json{{"name", p.name()}, {"every_steps", p.every_steps}, {"because", p.because}};
    if (p.kind == PassKind::repeat) json["times"] = p.times;
    if (!p.children.empty()) json["passes"] = to_json(p.children);
    list.push_back(std::move(json));
  }
  return list;
}

void print(std::ostream& out, const std::vector<Pass>& passes, int depth) {
  for (const Pass& p : passes) {
    std::string cadence = p.every_steps > 1 ? "every " + std::to_string(p.every_steps) + " steps" : "";
    if (p.kind == PassKind::repeat) cadence = "up to " + std::to_string(p.times) + (p.times > 1 ? " times" : " time");
    out << "    " << padded(std::string(2 * static_cast<std::size_t>(depth), ' ') + p.name(), 30) << padded(cadence, 17)
        << p.because << "\n";
    print(out, p.children, depth + 1);
  }
}

}  // namespace

const Field* Plan::node_field(std::string_view id) const {
  for (const Field& field : fields)
    if (field.owner == Owner::node && field.id == id) return &field;
  return nullptr;
}

const Field* Plan::particle_field(int body, std::string_view id, Origin origin) const {
  for (const Field& field : fields)
    if (field.of_particles_of(body) && field.origin == origin && field.id == id) return &field;
  return nullptr;
}

std::uint64_t Plan::bytes_per_particle(int body) const {
  std::uint64_t sum = 0;
  for (const Field& field : fields) sum += field.of_particles_of(body) ? field.bytes : 0;
  return sum;
}

std::uint64_t Plan::bytes_per_node() const {
  std::uint64_t sum = 0;
  for (const Field& field : fields) sum += field.owner == Owner::node ? field.bytes : 0;
  return sum;
}

nlohmann::ordered_json Plan::to_json() const {
  nlohmann::ordered_json json;
  for (const Field& field : fields) {
    nlohmann::ordered_json row;
    if (field.owner == Owner::particle) row["body"] = field.body;
    row.update({{"name", field.id}, {"unit", field.unit}, {"components", field.components}});
    row[field.owner == Owner::particle ? "bytes_per_particle" : "bytes_per_node"] = field.bytes;
    if (!field.beside.empty()) row["beside"] = field.beside;
    if (!field.in_place_of.empty()) row["in_place_of"] = field.in_place_of;
    row["because"] = field.because;
    json[field.owner == Owner::particle ? "attributes" : "fields"].push_back(std::move(row));
  }
  json["velocity_fields"] = velocity_fields;
  json["passes"] = mpm::to_json(passes);
  json["weight_gradients"] = weight_gradients;
  json["affine_moment"] = affine_moment;
  json["separate_force"] = separate_force;
  json["velocity_increment"] = velocity_increment;
  json["ledger"] = ledger;
  if (ledger_every > 1) json["ledger_every"] = ledger_every;
  json["fused"] = fused;
  if (!fused) json["why_not_fused"] = why_not_fused;
  json["estimate"] = {
      {"particles", particles}, {"nodes", nodes}, {"particle_bytes", particle_bytes}, {"grid_bytes", grid_bytes}};
  return json;
}

std::string Plan::to_text() const {
  std::ostringstream out;
  const auto print_field = [&](const Field& field) {
    const std::string count = std::to_string(field.components) + (field.components > 1 ? " components" : " component");
    const std::string bytes = !field.beside.empty()        ? "beside " + field.beside
                              : !field.in_place_of.empty() ? "in place of " + field.in_place_of
                                                           : std::to_string(field.bytes) + " B";
    out << "    " << padded(field.name + (field.unit.empty() ? "" : " (" + field.unit + ")"), 32) << padded(count, 13)
        << padded(bytes, 6) << field.because << "\n";
  };
  out << "Fields of a particle\n";
  int body = -1;
  for (const Field& field : fields) {
    if (field.owner != Owner::particle) continue;
    if (field.body != body) {
      body = field.body;
      out << "  body " << body << ": " << bytes_per_particle(body) << " bytes a particle\n";
    }
    print_field(field);
  }
  out << "Fields of a node: " << bytes_per_node() << " bytes"
      << (velocity_fields > 1 ? " for " + std::to_string(velocity_fields) + " velocity fields" : "") << "\n";
  for (const Field& field : fields)
    if (field.owner == Owner::node) print_field(field);
  out << "Passes of a step\n";
  print(out, passes, 0);
  out << "Gather and scatter: " << (fused ? "fused, one visit of a particle a step" : "two passes, " + why_not_fused)
      << "\n";
  out << "Stencil: weights" << (weight_gradients ? " and gradients" : " only, no gradients") << "; force "
      << (separate_force ? "in a field of its own" : "merged into momentum") << "\n";
  out << "Estimate: " << particles << " particles, " << nodes << " nodes, " << (particle_bytes + 524288) / 1048576
      << " MiB of particles (copies and scratch included), " << (grid_bytes + 524288) / 1048576 << " MiB of grid\n";
  return out.str();
}

}  // namespace mpm
