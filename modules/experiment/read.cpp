#include "experiment/read.hpp"

#include <algorithm>
#include <cctype>

#include "experiment/device_settings.hpp"
#include "experiment/particle_output.hpp"
#include "experiment/reader.hpp"
#include "experiment/thermal.hpp"

namespace mpm {

bool is_name(const std::string& text) {
  const auto word = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; };
  return !text.empty() && !std::isdigit(static_cast<unsigned char>(text[0])) &&
         std::all_of(text.begin(), text.end(), word);
}

namespace {

/// The members of `object` in the order of a table.
OrderedJson in_table_order(const OrderedJson& object, const Section& section) {
  OrderedJson ordered = OrderedJson::object();
  for (const ParameterSpec& spec : section.parameters) {
    if (object.contains(spec.name) && !object[spec.name].is_null()) ordered[spec.name] = object[spec.name];
  }
  return ordered;
}

}  // namespace

ComponentLookup::ComponentLookup(const Registry& registry) : not_built_(registry.not_built()) {
  for (const Plugin& plugin : registry.plugins()) plugins_.push_back(&plugin);
}

const Plugin* ComponentLookup::find(mpm_kind kind, std::string_view id) const {
  for (const Plugin* plugin : plugins_) {
    if (plugin->descriptor->kind == static_cast<std::uint32_t>(kind) && plugin->id() == id) return plugin;
  }
  return nullptr;
}

std::vector<const Plugin*> ComponentLookup::of_kind(mpm_kind kind) const {
  std::vector<const Plugin*> found;
  for (const Plugin* plugin : plugins_) {
    if (plugin->descriptor->kind == static_cast<std::uint32_t>(kind)) found.push_back(plugin);
  }
  return found;
}

std::vector<std::string> ComponentLookup::not_built(mpm_kind kind) const {
  std::vector<std::string> ids;
  for (const PluginTarget& plugin : not_built_)
    if (plugin.kind == kind) ids.push_back(plugin.id);
  return ids;
}

OrderedJson read_constants(const Node& root, ReadContext& context) {
  const Node* node = root.find("constants");
  if (!node || node->type == Node::Type::null) return nullptr;
  if (node->type != Node::Type::object) {
    context.problem(*node, "expected an object of named numbers, got " + describe_value(*node));
    return nullptr;
  }
  OrderedJson resolved = OrderedJson::object();
  for (const Member& member : node->members) {
    double value = 0;
    if (!is_name(member.key)) {
      context.problem(member.at, member.value.pointer,
                      in_quotes(member.key) + " is no name: letters, digits and _, not beginning with a digit");
    } else if (!is_free_in_formulas(member.key)) {
      context.problem(member.at, member.value.pointer, in_quotes(member.key) + " already has a meaning in expressions");
    } else {
      // A name whose value is wrong stays known, so that its uses are not reported as well.
      read_si(member.value, "any", "a number", value, context);
      context.constants.emplace_back(member.key, value);
      resolved[member.key] = value;
    }
  }
  return resolved;
}

Expectation read_expectation(const Node& node, ReadContext& context, OrderedJson& resolved) {
  const Fields fields(&node, expectation_section(), context);
  Expectation expectation;
  expectation.metric = fields.text("metric");
  expectation.pointer = node.pointer;
  if (fields.given("at_least")) expectation.at_least = fields.number("at_least");
  if (fields.given("at_most")) expectation.at_most = fields.number("at_most");
  if (fields.given("equals")) expectation.equals = fields.number("equals");
  expectation.tolerance = fields.number("tolerance");
  resolved = fields.resolved;
  if (node.type != Node::Type::object) return expectation;
  if (!expectation.at_least && !expectation.at_most && !expectation.equals) {
    context.problem(node, "expects nothing: give \"at_least\", \"at_most\" or \"equals\"");
  }
  if (fields.given("tolerance") && !expectation.equals) {
    context.problem(*fields.node("tolerance"), "a tolerance belongs to \"equals\", which is not given");
  }
  const bool both = expectation.at_least && expectation.at_most && fields.valid("at_least") && fields.valid("at_most");
  if (both && *expectation.at_least > *expectation.at_most) {
    context.problem(node, "nothing is both at least " + number_text(*expectation.at_least) + " and at most " +
                              number_text(*expectation.at_most));
  }
  return expectation;
}

ExperimentReader::ExperimentReader(Node root, const std::filesystem::path& file, const ComponentLookup& components,
                                   const ReadOptions& options)
    : root_(std::move(root)), components_(components), options_(options) {
  context_.file = file.string();
  experiment_.file = file;
  apply_overrides(root_, options.overrides, context_.problems);
  if (options.backend) set_from_option(root_, "backend", *options.backend, "--backend");
}

Experiment ExperimentReader::read() {
  // Lengths of vectors and the meaning of formulas depend on these two: they come first, wherever they stand.
  const Node* dimension = root_.find("dimension");
  if (dimension && dimension->type == Node::Type::number && (dimension->number == 2 || dimension->number == 3)) {
    context_.dimension = static_cast<int>(dimension->number);
  }
  const OrderedJson constants = read_constants(root_, context_);

  const Section section = experiment_section(options_);
  const Fields fields(&root_, section, context_);
  resolved_ = fields.resolved;
  if (!constants.is_null()) resolved_["constants"] = constants;
  read_header(fields);
  read_device(fields.node("device"), experiment_, context_, resolved_);
  read_grid(fields.node("grid"));
  read_node_conditions(fields.node("node_conditions"));
  read_components(fields);
  read_materials(fields.node("materials"));
  read_bodies(fields.node("bodies"));
  read_grips(fields.node("grips"));
  read_rigid_bodies(fields.node("rigid_bodies"));
  find_becoming_bodies();
  read_emitters(fields.node("emitters"));
  read_sinks(fields.node("sinks"));
  read_loads(fields.node("loads"));
  read_damping(fields.node("damping"));
  read_solver(fields.node("solver"));
  read_output(fields.node("output"));
  read_compare(fields.node("compare"));
  read_limits(fields.node("limits"));
  check_axisymmetric();
  check_frozen();
  check_free_fall();
  check_particle_changes();
  check_temperature(root_, experiment_, context_);

  if (!context_.problems.empty()) throw InputError(std::move(context_.problems));
  experiment_.resolved = in_table_order(resolved_, section);
  experiment_.positions = all_positions(root_);
  experiment_.inputs = std::move(context_.inputs);
  return std::move(experiment_);
}

void ExperimentReader::read_header(const Fields& fields) {
  experiment_.title = fields.text("title");
  experiment_.description = fields.text("description");
  experiment_.dimension = context_.dimension;
  experiment_.precision = fields.text("precision") == "float" ? Precision::single : Precision::double_;
  experiment_.backend = fields.text("backend");
  experiment_.seed = static_cast<unsigned>(fields.number("seed"));
  read_gravity(fields);
  experiment_.figures = fields.names("figures");
  read_column_figures(fields.node("figures"));
  if (fields.given("body_force")) {
    experiment_.body_force = fields.expression("body_force");
    experiment_.body_force_pointer = "/body_force";
  }
  capability_known_ = fields.valid("precision") && fields.valid("backend");
  if (experiment_.backend == "reference" && experiment_.precision == Precision::single) {
    capability_known_ = false;
    const bool file_says_float = fields.place("precision").at.option.empty();
    problem(fields.place(file_says_float && !fields.place("backend").at.option.empty() ? "backend" : "precision"),
            "precision \"float\" is not available on backend \"reference\", which computes in double only; "
            "set precision to \"double\" or backend to \"cpu\"");
  }
}

void ExperimentReader::read_solver(const Node* node) {
  if (!node) return;
  const std::vector<Section> kinds = solver_kinds(options_);
  const Section* kind = choose_kind(*node, kinds, "solver", false, context_, kinds.empty() ? nullptr : &kinds.front());
  if (!kind) return;
  const Fields fields(node, *kind, context_);
  SolverSpecification& solver = experiment_.solver;
  solver.type = kind->name;
  solver.end_time = fields.number("end_time");
  solver.max_steps = static_cast<long>(fields.number("max_steps"));
  options_.solvers[static_cast<std::size_t>(kind - kinds.data())].read(fields, solver);
  resolved_["solver"] = fields.resolved;
}

void ExperimentReader::read_output(const Node* node) {
  const Fields fields(node, output_section(options_), context_);
  OutputSpecification& output = experiment_.output;
  output.metrics_every = fields.integer("metrics_every");
  output.frames = fields.integer("frames");
  output.colour_by = fields.text("colour_by");
  output.vtk = fields.boolean("vtk");
  output.film = fields.text("film");
  if (output.film.empty() && fields.boolean("film")) output.film = "mp4";
  output.ledger = fields.boolean("ledger");
  output.ledger_every = fields.integer("ledger_every");
  output.checkpoint_seconds = fields.number("checkpoint_every");
  output.checkpoint_steps = static_cast<long>(fields.number("checkpoint_steps"));
  resolved_["output"] = fields.resolved;
  if (fields.given("particles")) {
    OrderedJson resolved;
    experiment_.particle_output = read_particle_output(fields.nested("particles"), experiment_, context_, resolved);
    resolved_["output"]["particles"] = std::move(resolved);
  }
  read_records(fields);
  if (fields.valid("ledger_every") && output.ledger_every > 1 && !output.ledger)
    problem(fields.place("ledger_every"), "there is no ledger to make entries in: set \"ledger\" to true");
  read_reactions(fields);
  if (!fields.valid("frames")) return;
  if (!output.film.empty() && output.frames < 2) problem(fields.place("film"), "a film needs \"frames\" of at least 2");
  if (output.vtk && output.frames < 1) problem(fields.place("vtk"), "VTK files are written at frames: set \"frames\"");
}

void ExperimentReader::read_compare(const Node* node) {
  if (!node) return;
  const Fields fields(node, compare_section(), context_);
  OrderedJson& resolved = resolved_["compare"] = OrderedJson::object();
  if (fields.given("exact")) resolved["exact"] = read_exact(*fields.node("exact"));
  if (!fields.given("expect") || !is_list(*fields.node("expect"), "expectations", true)) return;
  resolved["expect"] = OrderedJson::array();
  for (const Node& item : fields.node("expect")->items)
    experiment_.expectations.push_back(read_expectation(item, context_, resolved["expect"].emplace_back()));
}

void ExperimentReader::read_limits(const Node* node) {
  const Fields fields(node, limits_section(), context_);
  experiment_.limits = limits_of(fields, context_);
  resolved_["limits"] = fields.resolved;
}

OrderedJson ExperimentReader::read_exact(const Node& node) {
  const std::vector<Section> kinds = exact_kinds(options_);
  const Section* kind = choose_kind(node, kinds, "exact solution", false, context_);
  if (!kind) return {};
  const Fields fields(&node, *kind, context_);
  ExactChoice choice{kind->name, {}, node.pointer};
  for (const ParameterSpec& spec : kind->parameters) {
    if (fields.valid(spec.name)) choice.values.emplace_back(spec.name, fields.number(spec.name));
  }
  experiment_.exact = std::move(choice);
  return fields.resolved;
}

bool ExperimentReader::is_list(const Node& node, const char* what, bool may_be_empty) {
  if (node.type != Node::Type::array) {
    problem(node, std::string("expected a list of ") + what + ", got " + describe_value(node));
    return false;
  }
  if (node.items.empty() && !may_be_empty) problem(node, std::string("the list of ") + what + " is empty");
  return true;
}

namespace {
Experiment read_tree(Node root, const std::filesystem::path& file, const ComponentLookup& components,
                     const ReadOptions& options) {
  return ExperimentReader(std::move(root), file, components, options).read();
}
}  // namespace

Experiment read_experiment(const std::filesystem::path& file, const ComponentLookup& components,
                           const ReadOptions& options) {
  return read_tree(read_located(file), file, components, options);
}

Experiment read_experiment(const std::filesystem::path& file, const Registry& registry, const ReadOptions& options) {
  return read_experiment(file, ComponentLookup(registry), options);
}

Experiment read_experiment_text(std::string_view text, const std::filesystem::path& file,
                                const ComponentLookup& components, const ReadOptions& options) {
  return read_tree(parse_located(text, file.string()), file, components, options);
}

}  // namespace mpm
