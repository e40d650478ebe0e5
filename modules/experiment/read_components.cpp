// The plugins an experiment chooses, and whether they can do what it asks.
#include <algorithm>
#include <cmath>

#include "experiment/artificial_viscosity.hpp"
#include "experiment/contact_settings.hpp"
#include "experiment/reader.hpp"
#include "experiment/thermal.hpp"
#include "plugin/extension_of.hpp"

namespace mpm {
namespace {

std::string offered_precisions(std::uint32_t bits) {
  const bool single = bits & (1u << MPM_LANES_FLOAT);
  const bool lanes = bits & (1u << MPM_LANES_DOUBLE), scalar = bits & (1u << MPM_SCALAR_DOUBLE);
  std::vector<std::string> offered;
  if (single) offered.push_back("float on the cpu");
  if (lanes) offered.push_back("double on the cpu");
  if (scalar) offered.push_back("double on the reference backend");
  std::string text;
  for (const std::string& one : offered) text += (text.empty() ? "" : ", ") + one;
  return text.empty() ? "nothing" : text;
}

}  // namespace

Component component_of(const Plugin& plugin, const Fields& fields, const std::string& pointer) {
  Component component;
  component.plugin = &plugin;
  component.pointer = pointer;
  component.parameters.resize(plugin.descriptor->parameter_bytes / sizeof(double));
  for (const mpm_parameter& declared : plugin.parameters()) {
    const std::size_t slot = declared.offset / sizeof(double);
    if (slot >= component.parameters.size()) continue;  // the registry refuses such a plugin
    component.parameters[slot] = fields.number(declared.name);
  }
  return component;
}

void refuse_parameters(const Component& component, const Fields& fields, mpm_refusal_case scene,
                       const Node& component_node, const Node& cell_size, ReadContext& context) {
  const Plugin& plugin = *component.plugin;
  const auto* table = extension_of<mpm_refusals>(plugin);
  if (!table || scene.dimension == 0) return;
  for (const mpm_parameter& declared : plugin.parameters())
    if ((fields.given(declared.name) || (declared.flags & MPM_REQUIRED)) && !fields.valid(declared.name))
      return;  // what is wrong with it has been said
  const auto* cells = extension_of<mpm_material_cell_size>(plugin);
  if (cells && !(component.parameters[cells->offset / sizeof(double)] > 0)) return;
  mpm_refusal refusal{nullptr, nullptr, 0};
  table->ask(component.parameters.data(), &scene, &refusal);
  if (!refusal.parameter) return;
  const std::string_view name = refusal.parameter;
  const auto parameters = plugin.parameters();
  const auto declared = std::find_if(parameters.begin(), parameters.end(),
                                     [&](const mpm_parameter& parameter) { return name == parameter.name; });
  const bool own = declared != parameters.end();
  const std::string unit = own ? declared->unit : "m";
  const double value = component.parameters[(own ? declared->offset : cells ? cells->offset : 0) / sizeof(double)];
  const auto quantity = [&](double number) { return number_text(number) + (unit.empty() ? "" : " " + unit); };
  std::string text = std::string(kind_name(static_cast<mpm_kind>(plugin.descriptor->kind))) + " " +
                     in_quotes(plugin.id()) + " cannot have " + in_quotes(name) + " " + quantity(value);
  if (value == refusal.limit)
    text += ", which is the limit itself";
  else if (std::isfinite(refusal.limit))
    text += std::string(", ") + (value > refusal.limit ? "at most " : "at least ") + quantity(refusal.limit);
  const Node* in_component = own ? component_node.find(declared->name) : nullptr;
  const Node& place = !own ? cell_size : in_component ? *in_component : component_node;
  context.problem(place, text + ": " + (refusal.why ? refusal.why : ""));
}

void ExperimentReader::check_capability(const Plugin& plugin, mpm_kind kind, const Node& place) {
  const mpm_descriptor& descriptor = *plugin.descriptor;
  const std::string name = std::string(kind_name(kind)) + " " + in_quotes(plugin.id());
  const int dimension = context_.dimension;
  if (dimension && !(descriptor.dimensions & (dimension == 2 ? MPM_2D : MPM_3D))) {
    problem(place, name + " works in " + (dimension == 2 ? "3-D" : "2-D") + " only, but this experiment is " +
                       std::to_string(dimension) + "-D");
  }
  if (!capability_known_) return;
  if (experiment_.backend == "cuda") {  // a device compiles the functor's text
    if (!descriptor.source || !*descriptor.source)
      problem(place, name +
                         " carries no text of its functor, which backend \"cuda\" compiles; build it with "
                         "mpm_add_plugin(... HEADER file)");
    return;
  }
  const bool reference = experiment_.backend == "reference", single = experiment_.precision == Precision::single;
  const bool always_double = kind == MPM_NORMAL || kind == MPM_DETECTION;  // sums of two bodies nearly cancel
  const bool in_float = single && !always_double;
  const int wanted = reference ? MPM_SCALAR_DOUBLE : in_float ? MPM_LANES_FLOAT : MPM_LANES_DOUBLE;
  if (!(descriptor.precisions & (1u << wanted))) {
    problem(place, name + " does not offer " + (wanted == MPM_LANES_FLOAT ? "float" : "double") + " on backend " +
                       in_quotes(experiment_.backend) + "; it offers " + offered_precisions(descriptor.precisions));
  }
}

ExperimentReader::Chosen ExperimentReader::read_component(const Node& node, mpm_kind kind) {
  return read_component(node, kind, component_kinds(components_, kind));
}

ExperimentReader::Chosen ExperimentReader::read_component(const Node& node, mpm_kind kind,
                                                          const std::vector<Section>& kinds) {
  Chosen chosen;
  const bool by_word = kind == MPM_NORMAL || kind == MPM_DETECTION;
  const std::string what =
      kind == MPM_CONTACT ? "contact law" : (by_word ? "contact " : "") + std::string(kind_name(kind));
  const Section* section = choose_kind(node, kinds, what, by_word, context_, nullptr, components_.not_built(kind));
  if (!section) return chosen;
  const Plugin* plugin = components_.find(kind, section->name);
  const bool is_word = node.type == Node::Type::string;
  check_capability(*plugin, kind, is_word ? node : *node.find("type"));
  chosen.fields.emplace(is_word ? nullptr : &node, *section, context_);
  chosen.component = component_of(*plugin, *chosen.fields, node.pointer);
  if (const auto* cell_size = extension_of<mpm_material_cell_size>(*plugin))
    chosen.component.parameters[cell_size->offset / sizeof(double)] = experiment_.grid.cell_size;
  refuse_parameters(chosen.component, *chosen.fields,
                    {static_cast<std::uint32_t>(context_.dimension), experiment_.axisymmetric()}, node,
                    nearest_node(root_, "/grid/cell_size"), context_);
  chosen.resolved = chosen.fields->resolved;
  return chosen;
}

void ExperimentReader::read_filter_schedule(const Fields& fields) {
  FilterSchedule& schedule = experiment_.filter_schedule;
  int intervals = 0;
  for (const char* key : {"every_steps", "every_time", "every_courant"}) {
    if (!fields.given(key)) continue;
    if (++intervals > 1)
      problem(fields.place(key), "a filter has one interval: every_steps, every_time or every_courant");
  }
  if (fields.given("every_steps")) schedule.every_steps = fields.integer("every_steps");
  if (fields.given("every_time")) schedule.every_time = fields.number("every_time");
  if (fields.given("every_courant")) schedule.every_courant = fields.number("every_courant");
  schedule.constrain_always = fields.choice("constraints") != 2;
  schedule.takes_back = fields.choice("constraints") == 0;
  schedule.moves_by_mean = fields.choice("position_update") == 1;
  schedule.tolerance = fields.number("tolerance");
}

void ExperimentReader::read_components(const Fields& fields) {
  const auto choose = [&](const char* key, mpm_kind kind) {
    Chosen chosen = read_component(*fields.node(key), kind);
    resolved_[key] = chosen.resolved;
    return chosen;
  };
  if (fields.given("shape")) experiment_.shape = choose("shape", MPM_SHAPE).component;
  if (fields.given("transfer")) experiment_.transfer = choose("transfer", MPM_TRANSFER).component;
  if (fields.given("filter")) {
    const Chosen filter = choose("filter", MPM_FILTER);
    experiment_.filter = filter.component;
    if (filter.fields) read_filter_schedule(*filter.fields);
  }
  if (!fields.given("contact")) return;
  const Chosen contact = choose("contact", MPM_CONTACT);
  experiment_.contact = contact.component;
  if (!contact.fields) return;
  experiment_.contact_normal = read_part_of_contact(*contact.fields, MPM_NORMAL, standard_normal);
  experiment_.contact_detection = read_part_of_contact(*contact.fields, MPM_DETECTION, standard_detection);
  check_contact(*contact.fields);
}

/// Reads the normal or the detection, which a word chooses unless it needs parameters; a word stays one in the resolved
/// experiment.
std::optional<Component> ExperimentReader::read_part_of_contact(const Fields& contact, mpm_kind kind,
                                                                const char* word) {
  const std::string key(kind_name(kind));
  Node standard;
  standard.type = Node::Type::string, standard.text = word;
  standard.at = contact.place(key).at, standard.pointer = experiment_.contact->pointer + "/" + key;
  const Node& node = contact.given(key) ? *contact.node(key) : standard;
  const Chosen chosen = read_component(node, kind);
  if (!chosen.component.plugin) return {};
  const bool is_word = node.type == Node::Type::string;
  resolved_["contact"][key] = is_word ? OrderedJson(node.text) : chosen.resolved;
  for (const mpm_parameter& declared : chosen.component.plugin->parameters())
    if (is_word && (declared.flags & MPM_REQUIRED))
      problem(node, "contact " + key + " " + in_quotes(node.text) + " needs " + in_quotes(declared.name) +
                        ": {\"type\": " + in_quotes(node.text) + ", " + in_quotes(declared.name) + ": …}");
  return chosen.component;
}

/// Refuses a choice of normal or detection that nobody would look at, and a cap that the law or its normal cannot take.
void ExperimentReader::check_contact(const Fields& fields) {
  const auto refuse_unread = [&](const std::optional<Component>& chosen, const char* key, const char* standard) {
    if (!chosen || !fields.given(key) || chosen->plugin->id() == standard) return;  // what is wrong has been said
    if (experiment_.contact->plugin->contact().traits & MPM_BYPASSES_DETECTION)
      problem(fields.place(key), in_quotes(experiment_.contact->plugin->id()) +
                                     " joins bodies at every node that they share and looks at no " + key +
                                     "; remove it");
  };
  refuse_unread(experiment_.contact_normal, "normal", standard_normal);
  refuse_unread(experiment_.contact_detection, "detection", standard_detection);
  if (!fields.given("strain_cap") || !experiment_.contact_normal) return;
  const std::string why = refuses_strain_cap(*experiment_.contact, *experiment_.contact_normal);
  if (!why.empty()) problem(fields.place("strain_cap"), why + "; remove it");
}

void ExperimentReader::read_materials(const Node* node) {
  if (!node) return;
  if (node->type != Node::Type::object) {
    return problem(*node, "expected an object of materials by name, got " + describe_value(*node));
  }
  if (node->members.empty()) problem(*node, "there is no material in it");
  OrderedJson& resolved = resolved_["materials"] = OrderedJson::object();
  for (const Member& member : node->members) {
    if (member.key.empty()) context_.problem(member.at, member.value.pointer, "a material needs a name");
    Chosen chosen = read_component(member.value, MPM_MATERIAL);
    std::optional<Thermal> thermal;
    std::optional<ArtificialViscositySpecification> viscosity;
    if (chosen.fields) {
      thermal = read_thermal(*chosen.fields, chosen.component, context_, chosen.resolved);
      viscosity = read_artificial_viscosity(*chosen.fields, chosen.component, context_, chosen.resolved);
    }
    if (thermal && thermal->phase_change && thermal->phase_change->melted_parameters != chosen.component.parameters) {
      Component melted = chosen.component;
      melted.parameters = thermal->phase_change->melted_parameters;
      refuse_parameters(melted, *chosen.fields,
                        {static_cast<std::uint32_t>(context_.dimension), experiment_.axisymmetric()},
                        nearest_node(root_, thermal->phase_change->pointer + "/melted"),
                        nearest_node(root_, "/grid/cell_size"), context_);
    }
    experiment_.materials.push_back(
        {member.key, std::move(chosen.component), std::move(thermal), std::move(viscosity)});
    resolved[member.key] = std::move(chosen.resolved);
  }
}

}  // namespace mpm
