// A plan as a person and as a program reads it.
#include <algorithm>
#include <ostream>
#include <sstream>
#include <stdexcept>

#include "plan/plan.hpp"

namespace mpm {
namespace {

std::string padded(std::string text, std::size_t width) {
  if (text.size() < width) text.resize(width, ' ');
  return text + "  ";
}

}  // namespace

std::string Pass::name() const {
  const bool half = share < 1;
  if (fused()) return "gather, strain and scatter";
  if (has(Act::gather)) return !has(Act::strain) ? "gather" : half ? "gather and half strain" : "gather and strain";
  if (has(Act::scatter_momentum))
    return remap() ? "scatter again" : has(Act::scatter_force) ? "scatter" : "scatter momentum";
  switch (operators.front().act) {
    case Act::estimate_time_step:
      return "estimate time step";
    case Act::sort:
    case Act::sort_ahead:
      return "sort";
    case Act::clear:
      return "reset grid";
    case Act::scatter_force:
      return "scatter force";
    case Act::divide:
      return remap() ? "momentum to velocity again" : "momentum to velocity";
    case Act::accelerate:
      return "apply forces";
    case Act::scatter_heat:
      return "scatter heat";
    case Act::divide_heat:
      return "heat to temperature";
    case Act::conduct:
      return "conduct";
    case Act::heat:
      return "heat";
    case Act::change_phase:
      return "change phase";
    case Act::keep_contact_state:
      return "keep contact state";
    case Act::scatter_mean_stress:
      return "scatter mean stress";
    case Act::average_mean_stress:
      return "average mean stress";
    case Act::scatter_dilation:
      return "scatter dilation";
    case Act::average_dilation:
      return "average dilation";
    case Act::strain:
      return half ? "half strain" : "strain";
    case Act::move:
      return "move";
    case Act::begin_filter:
      return "begin filter";
    case Act::project:
      return "project";
    case Act::update_filter:
      return "update filter";
    case Act::end_filter:
      return "end filter";
    case Act::restore_velocity:
      return "restore velocity";
    case Act::add_correction:
      return "add correction";
    case Act::scatter_contact:
      return "scatter contact";
    case Act::gather_heat:
      return "gather heat";
    case Act::keep_velocity:
      return "keep velocity";
    case Act::keep_correction:
      return "keep correction";
    case Act::gather:
    case Act::scatter_momentum:
      break;  // these have their names above
  }
  throw std::logic_error("operator " + std::to_string(static_cast<int>(operators.front().act)) + " has no name");
}

std::string Step::name() const {
  switch (kind) {
    case Kind::pass:
      return pass.name();
    case Kind::repeat_until:
      return "repeat";
    case Kind::when:
      return condition == Condition::unless_scattered ? "unless scattered"
             : condition == Condition::when_filtered  ? "when filtered"
                                                      : "when the next dt is known";
    default:
      return "sequence";
  }
}

namespace {

/// A gather that may scatter ahead is told as the fused pass that it is as a rule.
const Step& as_a_rule(const Step& step) {
  return step.kind == Step::Kind::when && step.condition == Condition::may_scatter_ahead ? step.children.front() : step;
}

const std::string& because_of(const Step& step) {
  return step.kind == Step::Kind::pass ? step.pass.operators.front().because : step.because;
}

nlohmann::ordered_json to_json(const std::vector<Step>& steps) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Step& child : steps) {
    const Step& step = as_a_rule(child);
    nlohmann::ordered_json json{
        {"name", step.name()}, {"every_steps", step.pass.every_steps}, {"because", because_of(step)}};
    if (step.kind == Step::Kind::repeat_until) json["times"] = step.times;
    for (const Operator& operation : step.pass.operators) {
      const char* const visited = operation.where == Where::particles ? "particles" : "nodes";
      if (auto& visits = json["visits"]; std::find(visits.begin(), visits.end(), visited) == visits.end())
        visits.push_back(visited);
      for (const auto& [key, names] : {std::pair{"reads", &operation.reads}, std::pair{"writes", &operation.writes},
                                       std::pair{"adds", &operation.adds}})
        for (const std::string& name : *names)
          if (auto& known = json[key]; std::find(known.begin(), known.end(), name) == known.end())
            known.push_back(name);
    }
    if (!step.children.empty()) json["passes"] = to_json(step.children);
    list.push_back(std::move(json));
  }
  return list;
}

void print(std::ostream& out, const std::vector<Step>& steps, int depth) {
  for (const Step& child : steps) {
    const Step& step = as_a_rule(child);
    std::string cadence = step.pass.every_steps > 1 ? "every " + std::to_string(step.pass.every_steps) + " steps" : "";
    if (step.kind == Step::Kind::repeat_until)
      cadence = "up to " + std::to_string(step.times) + (step.times > 1 ? " times" : " time");
    out << "    " << padded(std::string(2 * static_cast<std::size_t>(depth), ' ') + step.name(), 30)
        << padded(cadence, 17) << because_of(step) << "\n";
    print(out, step.children, depth + 1);
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

const Pass* Plan::pass_of(Act act) const {
  const Pass* found = nullptr;
  for_each_pass(step, [&](const Pass& pass) {
    if (!found && pass.has(act)) found = &pass;
  });
  return found;
}

const Operator* Plan::find(Act act) const {
  if (const Pass* pass = pass_of(act))
    for (const Operator& operation : pass->operators)
      if (operation.act == act) return &operation;
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
  json["passes"] = mpm::to_json(step.children);
  json["weight_gradients"] = stencil.gradients;
  json["affine_moment"] = stencil.affine_moment;
  json["separate_force"] = node_field("force") != nullptr;
  json["velocity_increment"] = node_field("velocity_before") && !node_field("velocity_before")->for_ledger;
  json["ledger"] = has_ledger();
  if (ledger_every > 1) json["ledger_every"] = ledger_every;
  json["fused"] = fused();
  if (!fused()) json["why_not_fused"] = why_not_fused;
  if (advance != Advance::apart) json["advance"] = advance == Advance::at_once ? "at_once" : "unless_accounted";
  json["estimate"] = {
      {"particles", particles}, {"nodes", nodes}, {"particle_bytes", particle_bytes}, {"grid_bytes", grid_bytes}};
  return json;
}

namespace {

const char* where_forces_go(const Field* force) {
  if (!force) return "merged into momentum";
  return force->for_contact ? "in a field of its own where bodies are near each other, else merged into momentum"
                            : "in a field of its own";
}

}  // namespace

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
  print(out, step.children, 0);
  out << "Gather and scatter: " << (fused() ? "fused, one visit of a particle a step" : "two passes, " + why_not_fused)
      << "\n";
  if (advance != Advance::apart)
    out << "From one scatter to the next: particles advance in one launch"
        << (advance == Advance::at_once ? "" : ", but in steps that the ledger takes") << "\n";
  out << "Stencil: weights" << (stencil.gradients ? " and gradients" : " only, no gradients") << "; force "
      << where_forces_go(node_field("force")) << "\n";
  out << "Estimate: " << particles << " particles, " << nodes << " nodes, " << (particle_bytes + 524288) / 1048576
      << " MiB of particles (copies and scratch included), " << (grid_bytes + 524288) / 1048576 << " MiB of grid\n";
  return out.str();
}

}  // namespace mpm
