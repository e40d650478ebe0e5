#include "drive/read_drive.hpp"

#include <algorithm>

#include "drive/sections.hpp"
#include "experiment/located_json.hpp"
#include "experiment/reader.hpp"
#include "experiment/sections.hpp"
#include "plugin/extension_of.hpp"

namespace mpm::drive {
namespace {

/// Whether the tree's solver is a material point.
bool names_material_point(const Node& root) {
  const Node* solver = root.find("solver");
  const Node* type = solver && solver->type == Node::Type::object ? solver->find("type") : nullptr;
  return type && type->type == Node::Type::string && type->text == solver_name;
}

/// Why a key of other experiments does not belong here.
std::string why_not(const std::string& key) {
  if (key == "backend" || key == "precision" || key == "device")
    return "the material's plain entry in double computes it, whatever the backend";
  if (key == "output" || key == "figures") return "all steps are recorded and all figures drawn";
  if (key == "limits") return "its energies stand in summary.json, for \"compare\"";
  return "it is one particle by itself, without grid, bodies and time steps";
}

class DriveReader {
 public:
  DriveReader(Node root, const std::filesystem::path& file, const ComponentLookup& components,
              const std::vector<std::string>& overrides)
      : root_(std::move(root)), components_(components) {
    context_.file = file.string();
    drive_.experiment.file = file;
    apply_overrides(root_, overrides, context_.problems);
  }

  DriveExperiment read() {
    Experiment& experiment = drive_.experiment;
    const Node* dimension = root_.find("dimension");
    const bool flat = dimension && dimension->type == Node::Type::number && dimension->number == 2;
    context_.dimension = experiment.dimension = flat ? 2 : 3;
    const OrderedJson constants = read_constants(root_, context_);
    refuse_foreign_keys();
    const Fields fields(&root_, drive_section(), context_);
    experiment.resolved = fields.resolved;
    if (!constants.is_null()) experiment.resolved["constants"] = constants;
    experiment.title = fields.text("title");
    experiment.description = fields.text("description");
    experiment.backend = "reference";
    read_material(fields.node("materials"));
    read_solver(fields.node("solver"));
    read_expectations(fields);
    if (!context_.problems.empty()) throw InputError(std::move(context_.problems));
    for (auto item = experiment.resolved.begin(); item != experiment.resolved.end();)
      item = item->is_null() ? experiment.resolved.erase(item) : std::next(item);
    experiment.positions = all_positions(root_);
    return std::move(drive_);
  }

 private:
  /// Names what other experiments have and this one has not, and takes it out, so that it is one mistake.
  void refuse_foreign_keys() {
    const auto known = [](const Section& section, const std::string& key) {
      return std::any_of(section.parameters.begin(), section.parameters.end(),
                         [&](const ParameterSpec& spec) { return spec.name == key; });
    };
    const Section own = drive_section(), others = experiment_section({});
    std::erase_if(root_.members, [&](const Member& member) {
      if (known(own, member.key) || !known(others, member.key)) return false;
      context_.problem(member.at, member.value.pointer,
                       in_quotes(member.key) + " does not belong to a material point: " + why_not(member.key) +
                           "; remove it, or choose another solver");
      return true;
    });
  }

  void read_material(const Node* node) {
    if (!node) return;
    if (node->type != Node::Type::object || node->members.size() != 1)
      return context_.problem(*node,
                              "a material point is of one material: expected an object with one, got " +
                                  (node->type == Node::Type::object ? "one with " + std::to_string(node->members.size())
                                                                    : describe_value(*node)));
    const Member& member = node->members.front();
    const std::vector<Section> kinds = component_kinds(components_, MPM_MATERIAL);
    const Section* kind = choose_kind(member.value, kinds, "material", false, context_);
    if (!kind) return;
    const Plugin& plugin = *components_.find(MPM_MATERIAL, kind->name);
    const Fields fields(&member.value, *kind, context_);
    check_plugin(plugin, *member.value.find("type"));
    material_node_ = &member.value;
    material_fields_.emplace(fields);
    if (fields.given("thermal"))
      context_.problem(*fields.node("thermal"),
                       "a material point does not conduct: it has the material's reference temperature; remove it");
    if (fields.given("artificial_viscosity"))
      context_.problem(*fields.node("artificial_viscosity"),
                       "a material point has no cells over which to spread a shock, and its law is driven by itself; "
                       "remove it");
    drive_.experiment.materials.push_back({member.key, component_of(plugin, fields, member.value.pointer), {}, {}});
    drive_.experiment.resolved["materials"] = {{member.key, fields.resolved}};
  }

  void check_plugin(const Plugin& plugin, const Node& place) {
    const int dimension = context_.dimension;
    if (!(plugin.descriptor->dimensions & (dimension == 2 ? MPM_2D : MPM_3D)))
      context_.problem(place, "material " + in_quotes(plugin.id()) + " works in " + (dimension == 2 ? "3" : "2") +
                                  "-D only: set \"dimension\" to " + (dimension == 2 ? "3" : "2"));
    if (!(plugin.descriptor->precisions >> MPM_SCALAR_DOUBLE & 1))
      context_.problem(place, "material " + in_quotes(plugin.id()) +
                                  " does not offer its plain entry in double, which drives a material point");
  }

  void read_solver(const Node* node) {
    if (!node) return;
    const std::vector<Section> kinds{solver_section()};
    const Section* kind = choose_kind(*node, kinds, "solver", false, context_);
    if (!kind) return;
    const Fields fields(node, *kind, context_);
    OrderedJson& resolved = drive_.experiment.resolved["solver"] = fields.resolved;
    take_cell_size(fields);
    const Node* stages = fields.node("stages");
    if (!stages) return;
    if (stages->type != Node::Type::array || stages->items.empty())
      return context_.problem(*stages, "expected a list of stages, got " +
                                           (stages->type == Node::Type::array ? "none" : describe_value(*stages)));
    resolved["stages"] = OrderedJson::array();
    for (const Node& item : stages->items) resolved["stages"].push_back(read_stage(item));
  }

  void take_cell_size(const Fields& fields) {
    if (drive_.experiment.materials.empty()) return;
    Component& material = drive_.experiment.materials.front().component;
    const auto* extension = extension_of<mpm_material_cell_size>(*material.plugin);
    if (extension && !fields.given("cell_size"))
      context_.problem(fields.place("cell_size"), "material " + in_quotes(material.plugin->id()) +
                                                      " reads the cell size of a grid: give \"cell_size\", m");
    if (!extension && fields.given("cell_size"))
      context_.problem(fields.place("cell_size"),
                       "material " + in_quotes(material.plugin->id()) + " does not read a cell size: remove it");
    if (extension) material.parameters[extension->offset / sizeof(double)] = fields.number("cell_size");
    if (material_fields_)
      refuse_parameters(material, *material_fields_, {static_cast<std::uint32_t>(context_.dimension), 0},
                        *material_node_, fields.place("cell_size"), context_);
  }

  OrderedJson read_stage(const Node& node) {
    const int D = context_.dimension;
    const Fields fields(&node, stage_section(D), context_);
    Stage stage;
    stage.pointer = node.pointer;
    stage.name = fields.given("name") ? fields.text("name") : "stage_" + std::to_string(drive_.stages.size() + 1);
    check_name(stage.name, fields.place("name"));
    stage.duration = fields.number("duration");
    stage.steps = fields.integer("steps");
    OrderedJson resolved{{"name", stage.name}};
    for (const auto& [key, value] : fields.resolved.items()) resolved[key] = value;
    const bool by_rate = fields.given("velocity_gradient");
    if (by_rate && fields.given("deformation_gradient"))
      context_.problem(fields.place("velocity_gradient"),
                       "a stage imposes \"deformation_gradient\" or \"velocity_gradient\", not both: the other one "
                       "belongs to a stage of its own");
    if (by_rate) stage.motion = Motion::velocity_gradient;
    const char* key = by_rate ? "velocity_gradient" : "deformation_gradient";
    const std::vector<std::string> motions = components_of_matrix(D), stresses = components_of_stress(D);
    if (fields.given(key)) stage.imposed = read_components(fields.nested(key), motions, resolved[key]);
    if (fields.given("stress")) stage.stresses = read_components(fields.nested("stress"), stresses, resolved["stress"]);
    for (const Prescribed& stress : stage.stresses)
      for (const Prescribed& motion : stage.imposed)
        if (stress.i == motion.i && stress.j == motion.j)
          context_.problem(nearest_node(root_, stress.pointer),
                           "the stage imposes this component under \"" + std::string(key) +
                               "\" too, and one of the two follows from the other: remove one");
    drive_.stages.push_back(std::move(stage));
    return resolved;
  }

  void check_name(const std::string& name, const Node& place) {
    if (!is_name(name))
      context_.problem(place, in_quotes(name) + " is no name: letters, digits and _, not beginning with a digit");
    for (const Stage& stage : drive_.stages)
      if (stage.name == name) context_.problem(place, "another stage is called " + in_quotes(name));
  }

  std::vector<Prescribed> read_components(const Fields& fields, const std::vector<std::string>& names,
                                          OrderedJson& resolved) {
    std::vector<Prescribed> components;
    resolved = fields.resolved;
    for (const std::string& name : names)
      if (fields.given(name))
        components.push_back(
            {name[0] - 'x', name[1] - 'x', fields.scalar_expression(name), fields.node(name)->pointer});
    return components;
  }

  void read_expectations(const Fields& fields) {
    if (!fields.given("compare")) return;
    const Fields compare = fields.nested("compare");
    OrderedJson& resolved = drive_.experiment.resolved["compare"] = OrderedJson::object();
    const Node* list = compare.node("expect");
    if (!list) return;
    if (list->type != Node::Type::array)
      return context_.problem(*list, "expected a list of expectations, got " + describe_value(*list));
    resolved["expect"] = OrderedJson::array();
    for (const Node& item : list->items)
      drive_.experiment.expectations.push_back(read_expectation(item, context_, resolved["expect"].emplace_back()));
  }

  Node root_;
  const ComponentLookup& components_;
  ReadContext context_;
  const Node* material_node_ = nullptr;
  std::optional<Fields> material_fields_;
  DriveExperiment drive_;
};

}  // namespace

bool is_material_point(const std::filesystem::path& file, const std::vector<std::string>& overrides) {
  Node root = read_located(file);
  std::vector<Problem> ignored;  // the reader that follows finds them again
  apply_overrides(root, overrides, ignored);
  return names_material_point(root);
}

DriveExperiment read_drive(const std::filesystem::path& file, const ComponentLookup& components,
                           const std::vector<std::string>& overrides) {
  return DriveReader(read_located(file), file, components, overrides).read();
}

DriveExperiment read_drive_text(std::string_view text, const std::filesystem::path& file,
                                const ComponentLookup& components, const std::vector<std::string>& overrides) {
  return DriveReader(parse_located(text, file.string()), file, components, overrides).read();
}

}  // namespace mpm::drive
