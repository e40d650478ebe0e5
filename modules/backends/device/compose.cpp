#include "backends/device/compose.hpp"

#include <algorithm>
#include <set>
#include <sstream>

#include "backends/device/kernels/fields.hpp"
#include "backends/device/particle_formulas.hpp"
#include "experiment/device_settings.hpp"
#include "kernel/polynomial_basis.hpp"
#include "plugin/extension_of.hpp"
#include "simulation/contact_impulse.hpp"
#include "simulation/contact_points.hpp"
#include "support/hash.hpp"

namespace mpm::device {
namespace {

static_assert(never_folded == static_cast<int>(Folded::never) &&
              folded_with_mass == static_cast<int>(Folded::with_mass) &&
              folded_with_force == static_cast<int>(Folded::with_force));

struct Header {
  const char* path;
  const char* text;
};
/// The build writes this table from modules/kernel, modules/operators and modules/backends/device/kernels.
constexpr Header headers[] = {
#include MPM_KERNEL_HEADERS
};

/// The file of an #include directive with quotes or angle brackets, empty for any other line.
std::string included_file(const std::string& line) {
  std::istringstream words(line);
  std::string first, second;
  words >> first >> second;
  if (first == "#" && second == "include")
    words >> second;
  else if (first != "#include")
    return "";
  return second;
}

bool opens_group(const std::string& line) {
  return line.rfind("#if", line.find_first_not_of(' ')) == line.find_first_not_of(' ') &&
         line.find("#if") != std::string::npos;
}

std::string name_in_messages(const Plugin& plugin) {
  return std::string(kind_name(static_cast<mpm_kind>(plugin.descriptor->kind))) + " plugin " + std::string(plugin.id());
}

/// Puts texts one after another, each header once and before the first text that includes it.
class Text {
 public:
  void add_header(const std::string& path, const std::string& wanted_by) {
    if (!done_.insert(path).second) return;
    const char* text = embedded_header(path);
    if (!text)
      throw ComposeError(wanted_by + " includes \"" + path +
                         "\", which a device cannot see; include headers of modules/kernel only");
    add_lines(text, path, /*functor=*/false);
  }
  void add_functor(const Plugin& plugin) {
    const std::string name = name_in_messages(plugin);
    if (!done_.insert(name).second) return;
    if (!plugin.descriptor->source || !*plugin.descriptor->source)
      throw ComposeError(name + " carries no text of its functor; build it with mpm_add_plugin(... HEADER file)");
    add_lines(plugin.descriptor->source, name, /*functor=*/true);
  }
  void add(const std::string& text) { out_ << text; }
  std::string str() const { return out_.str(); }

 private:
  /// Replaces includes of kernel headers by their text, and drops those inside #if MPM_HOST, where only the host looks.
  void add_lines(const char* text, const std::string& name, bool functor) {
    std::istringstream lines(text);
    std::string line;
    int number = 0, depth = 0, host_depth = 0;  // depth at which #if MPM_HOST began, 0 outside
    std::ostringstream body;
    for (; std::getline(lines, line); body << line << "\n") {
      ++number;
      if (opens_group(line) && ++depth && !host_depth && line.find("#if MPM_HOST") != line.npos) host_depth = depth;
      if (host_depth == depth && (line.rfind("#else", 0) == 0 || line.rfind("#elif", 0) == 0)) host_depth = 0;
      if (line.rfind("#endif", 0) == 0 && depth-- == host_depth) host_depth = 0;
      if (line.rfind("#pragma once", 0) == 0) line.clear();
      const std::string file = included_file(line);
      if (file.empty()) continue;
      if (host_depth) {
        line.clear();
        continue;
      }
      const std::string where = name + ", line " + std::to_string(number);
      if (file.front() != '"' || file.size() < 3 || (functor && file.rfind("\"kernel/", 0) != 0))
        throw ComposeError(where + " includes " + file +
                           ", which a device cannot see; a functor includes \"kernel/...\" headers only, and others "
                           "inside #if MPM_HOST");
      add_header(file.substr(1, file.size() - 2), where);
      line.clear();
    }
    out_ << "#line 1 \"" << name << "\"\n" << body.str();
  }

  std::ostringstream out_;
  std::set<std::string> done_;
};

std::string yes(bool value) {
  return value ? "true" : "false";
}

bool reads_traction(const Choice& choice) {
  return choice.contact && (choice.contact->contact().traits & MPM_READS_TRACTION);
}

std::size_t contact_states(const Choice& choice) {
  return choice.contact ? choice.contact->state().size() : 0;
}

/// Whether the scatter itself sums particles into a field. The weight follows from the masses, and loads and heat have
/// kernels of their own, as shared memory has no room for everything at once.
bool is_scattered(const Field& field) {
  for (const char* other : {"weight", "body_force", "surface_load", "point_load", "spring", "dashpot", "heat",
                            "heat_capacity", "heat_rate", "heated_volume", "volume_conductivity", "capacity_position"})
    if (field.id == other) return false;
  if (field.id.rfind("grip_", 0) == 0) return false;  // they have a scatter of their own
  return field.cleared && field.folded != Folded::never;
}

bool has_grips(const Choice& choice) {
  return number_of(choice.particle_fields, "grip") >= 0;
}
bool has_temperature(const Choice& choice) {
  return number_of(choice.particle_fields, "temperature") >= 0;
}
bool melts(const Choice& choice) {
  return number_of(choice.particle_fields, "melted_fraction") >= 0;
}

/// Whether the ledger asks what artificial viscosity dissipates.
bool books_viscosity(const Choice& choice) {
  return number_of(choice.particle_fields, "artificial_work") >= 0;
}

bool averages_dilation(const Choice& choice) {
  return number_of(choice.node_fields, "dilation") >= 0;
}

/// Writes where the transfer's state for the temperature stands in its State: a matrix's first row, else one scalar.
void write_temperature_state(std::ostream& out, const Choice& choice) {
  out << "  template <class Visit>\n  MPM_HD static void for_each_temperature_state([[maybe_unused]] Visit visit) {\n";
  int scalar = 0;
  for (const mpm_state& declared : choice.transfer->state()) {
    const int number = number_of(choice.particle_fields, temperature_state + std::string(declared.name));
    const Field& field = choice.particle_fields.at(static_cast<std::size_t>(number));
    out << "    visit(TemperatureState<" << number << ", " << field.components << ", " << scalar << ">{});  // "
        << declared.name << "\n";
    scalar += state_components(kept_shape(declared, choice.axisymmetric), choice.dimension);
  }
  out << "  }\n";
}

/// Writes the scene's fields by number and by place in a scatter, and the list of those of nodes.
void write_fields(std::ostream& out, const Choice& choice) {
  std::ostringstream numbers, places, visits;
  int place = 0;
  for (std::size_t k = 0; k < choice.node_fields.size(); ++k) {
    const Field& field = choice.node_fields[k];
    const bool scattered = is_scattered(field);
    numbers << "    static constexpr int " << field.id << " = " << k << ";\n";
    if (scattered) places << "    static constexpr int " << field.id << " = " << place << ";\n";
    visits << "    visit(NodeField<" << k << ", " << field.components << ", " << static_cast<int>(field.at_wall) << ", "
           << static_cast<int>(field.folded) << ", " << yes(field.cleared) << ", " << (scattered ? place : -1)
           << ">{});  // " << field.id << "\n";
    if (scattered) place += field.components;
  }
  out << "  struct Node : NoNodeFields {\n"
      << numbers.str() << "  };\n  struct Place : NoNodeFields {\n"
      << places.str() << "  };\n  static constexpr int scattered = " << place << ";\n"
      << "  template <class Visit>\n  MPM_HD static void for_each_node_field(Visit visit) {\n"
      << visits.str() << "  }\n  struct Particle : NoParticleFields {\n";
  const auto& particle = choice.particle_fields;
  const auto write = [&](const std::string& id, int number) {
    if (number >= 0) out << "    static constexpr int " << id << " = " << number << ";\n";
  };
  for (const Field& field : particle)
    if (field.origin == Origin::host) write(field.id, number_of(particle, field.id));
  write("transfer_state", first_of(particle, Origin::transfer));
  write(polynomial_coefficients, number_of(particle, polynomial_coefficients, Origin::transfer));
  write("material_state", static_cast<int>(std::count_if(particle.begin(), particle.end(), [](const Field& field) {
          return field.origin != Origin::material;
        })));
  out << "  };\n";
}

/// Whether there is a place for what the ledger asks of particles.
bool keeps_ledger(const Choice& choice) {
  return number_of(choice.particle_fields, "dissipated") >= 0;
}

bool has_body_force(const Choice& choice) {
  return number_of(choice.node_fields, "body_force") >= 0;
}

/// Whether anything acts on bodies at points.
bool has_loads(const Choice& choice) {
  return choice.loads_at_points;
}

bool is_list(const Choice& choice) {
  return choice.shape->shape().form == MPM_NODE_LIST;
}

/// Whether the filter ever projects.
bool has_filter_loop(const Choice& choice) {
  return number_of(choice.node_fields, "projection") >= 0;
}

/// Entries of kernels.hpp that stand or fall together.
struct EntryGroup {
  const char* macro;
  std::size_t times;      ///< 0 where the scene does without them
  bool numbered = false;  ///< there is one for each material, or for each law of rigid bodies
};

std::vector<EntryGroup> entry_groups(const Choice& choice) {
  const std::size_t materials = choice.materials.size();
  const bool advances = choice.advance != Advance::apart, apart = choice.advance != Advance::at_once;
  const bool heat = has_temperature(choice), ledger = keeps_ledger(choice);
  std::vector<EntryGroup> groups{{"MPM_DEVICE_ENTRIES", true},
                                 {"MPM_DEVICE_SUM_ENTRIES", true},
                                 {"MPM_DEVICE_TOTALS_ENTRIES", true},
                                 {"MPM_DEVICE_SORT_ENTRIES", true},
                                 {"MPM_DEVICE_APART_ENTRIES", apart},
                                 {"MPM_DEVICE_BODY_FORCE_ENTRIES", has_body_force(choice)},
                                 {"MPM_DEVICE_LOAD_ENTRIES", has_loads(choice)},
                                 {"MPM_DEVICE_LEDGER_ENTRIES", ledger},
                                 {"MPM_DEVICE_CONTACT_ENTRIES", choice.contact != nullptr},
                                 {"MPM_DEVICE_CONTACT_POINTS_ENTRIES", choice.contact_by_particles},
                                 {"MPM_DEVICE_CONTACT_REACH_ENTRIES", choice.contact_by_particles && is_list(choice)},
                                 {"MPM_DEVICE_CONTACT_STATE_ENTRIES", contact_states(choice) > 0},
                                 {"MPM_DEVICE_TRACTION_ENTRIES", reads_traction(choice)},
                                 {"MPM_DEVICE_REACTION_ENTRIES", choice.reactions},
                                 {"MPM_DEVICE_GRIP_ENTRIES", has_grips(choice)},
                                 {"MPM_DEVICE_FILTER_ENTRIES", choice.filter != nullptr},
                                 {"MPM_DEVICE_FILTER_LOOP_ENTRIES", has_filter_loop(choice)},
                                 {"MPM_DEVICE_HEAT_ENTRIES", heat},
                                 {"MPM_DEVICE_HEAT_LEDGER_ENTRIES", heat && ledger},
                                 {"MPM_DEVICE_VISCOSITY_LEDGER_ENTRIES", books_viscosity(choice)},
                                 {"MPM_DEVICE_DILATION_ENTRIES", averages_dilation(choice)},
                                 {"MPM_DEVICE_MATERIAL_ENTRIES", materials, true},
                                 {"MPM_DEVICE_STRAIN_ENTRIES", apart ? materials : 0, true},
                                 {"MPM_DEVICE_ADVANCE_ENTRIES", advances ? materials : 0, true},
                                 {"MPM_DEVICE_MELTING_ENTRIES", melts(choice) ? materials : 0, true},
                                 {"MPM_DEVICE_RIGID_ENTRIES", choice.rigid_laws.size(), true}};
  std::erase_if(groups, [](const EntryGroup& group) { return group.times == 0; });
  return groups;
}

/// Writes the chosen types and what the tables say of them: functors keep their tables where only the host looks.
std::string scene_text(const Choice& choice) {
  const mpm_shape& shape = choice.shape->shape();
  const unsigned traits = choice.transfer->transfer().traits;
  const bool list = is_list(choice);
  const auto type = [](const Plugin* plugin) { return "::mpm::" + std::string(plugin->descriptor->functor_name); };
  const bool affine = traits & (MPM_GATHERS_AFFINE | MPM_STRESS_BY_AFFINE | MPM_STRAIN_BY_AFFINE);
  std::ostringstream out;
  out.precision(17);
  out << "#line 1 \"scene\"\nnamespace mpm::device {\nstruct Scene {\n"
      << "  static constexpr int dimension = " << choice.dimension << ";\n"
      << "  static constexpr bool axisymmetric = " << yes(choice.axisymmetric) << ";\n"
      << "  using Scalar = " << (choice.precision == Precision::single ? "float" : "double") << ";\n"
      << "  using Shape = " << type(choice.shape) << ";\n  using Transfer = " << type(choice.transfer) << ";\n";
  if (choice.filter) out << "  using Filter = " << type(choice.filter) << ";\n";
  if (choice.contact) out << "  using Contact = " << type(choice.contact) << ";\n";
  if (choice.normal) out << "  using Normal = " << type(choice.normal) << ";\n";
  if (choice.detection) out << "  using Detection = " << type(choice.detection) << ";\n";
  const unsigned detects = choice.detection ? choice.detection->detection().traits : 0,
                 normals = choice.normal ? choice.normal->normal().traits : 0;
  const bool weld = choice.contact && (choice.contact->contact().traits & MPM_BYPASSES_DETECTION);
  out << "  static constexpr bool contact = " << yes(choice.contact) << ", bypasses_detection = " << yes(weld)
      << ", contact_by_particles = " << yes(choice.contact_by_particles)
      << ", normal_by_particles = " << yes(normals & MPM_LOOKS_AT_POINTS)
      << ", own_normals = " << yes(normals & MPM_OWN_NORMALS)
      << ", reads_surfaces = " << yes(detects & MPM_READS_PARTICLE_SURFACES)
      << ", reads_means = " << yes(detects & MPM_READS_MEAN_POSITION)
      << ", reads_edges = " << yes(detects & MPM_READS_EDGES) << ", notes_contact = " << yes(choice.notes_contact)
      << ", reads_traction = " << yes(reads_traction(choice)) << ", grips = " << yes(has_grips(choice))
      << ", list = " << yes(list) << ", sampled = " << yes(shape.sample_points[choice.dimension - 2] > 0)
      << ", sized = " << yes(!list && (choice.shape->descriptor->needs & MPM_NEEDS_HALF_SIZE))
      << ", deformed = " << yes(!list && (choice.shape->descriptor->needs & MPM_NEEDS_DOMAIN)) << ";\n"
      << "  static constexpr int width = " << (list ? 1 : shape.width)
      << ", list_capacity = " << (list ? shape.capacity[choice.dimension - 2] : 1)
      << ", contact_states = " << contact_states(choice) << ";\n"
      << "  static constexpr bool moment_is_gradient = " << yes(shape.second_moment_kind == MPM_MOMENT_IS_GRADIENT)
      << ", moment_per_particle = " << yes(shape.second_moment_kind == MPM_MOMENT_PER_PARTICLE) << ";\n"
      << "  static constexpr double inverse_second_moment = "
      << (shape.second_moment_kind == MPM_MOMENT_CONSTANT ? 1 / shape.second_moment : 0) << ";  // cells^-2\n"
      << "  static constexpr bool affine = " << yes(affine) << ";  // D^-1 is wanted\n"
      << "  static constexpr bool scatters_affine = " << yes(traits & (MPM_SCATTERS_AFFINE))
      << ", gathers_increment = " << yes(traits & MPM_GATHERS_INCREMENT)
      << ", reads_second_moment = " << yes(traits & MPM_READS_SECOND_MOMENT)
      << ", stress_by_affine = " << yes(traits & MPM_STRESS_BY_AFFINE)
      << ", strain_by_affine = " << yes(traits & MPM_STRAIN_BY_AFFINE)
      << ", affine_carries_energy = " << yes(traits & MPM_AFFINE_CARRIES_ENERGY) << ";\n"
      << "  static constexpr bool deterministic = " << yes(choice.deterministic) << ";\n"
      << "  static constexpr bool reactions = " << yes(choice.reactions) << ";\n"
      << "  static constexpr bool ledger = " << yes(keeps_ledger(choice)) << ";\n"
      << "  static constexpr int basis_order = " << choice.basis_order
      << ", basis_functions = " << basis_functions(choice.dimension, choice.basis_order)
      << ";  // polynomials beyond affine\n";
  write_fields(out, choice);
  if (has_temperature(choice)) write_temperature_state(out, choice);
  out << choice.formulas << "};\n";
  for (std::size_t k = 0; k < choice.materials.size(); ++k) {
    const auto* temperature = extension_of<mpm_material_temperature>(*choice.materials[k]);
    out << "struct Scene" << k << " : Scene {\n  using Material = " << type(choice.materials[k])
        << ";\n  static constexpr bool reads_temperature = " << yes(temperature) << ";\n";
    if (temperature)
      out << "  static constexpr double reference_temperature = " << temperature->reference << ";  // K\n";
    out << "};\n";
  }
  for (std::size_t k = 0; k < choice.rigid_laws.size(); ++k)
    out << "struct RigidScene" << k << " : Scene {\n  using Contact = " << type(choice.rigid_laws[k]) << ";\n};\n";
  for (const EntryGroup& group : entry_groups(choice)) {
    if (!group.numbered) out << group.macro << "\n";
    for (std::size_t k = 0; group.numbered && k < group.times; ++k) out << group.macro << "(" << k << ")\n";
  }
  out << "}  // namespace mpm::device\n";
  return out.str();
}

/// Reads the entries that the macros of kernels.hpp make from that file, so that there is one list.
std::vector<std::string> entry_names(const Choice& choice) {
  const std::vector<EntryGroup> groups = entry_groups(choice);
  std::vector<std::string> names;
  std::istringstream lines(embedded_header("backends/device/kernels/kernels.hpp"));
  std::string line, macro;
  while (std::getline(lines, line)) {
    if (line.rfind("#define ", 0) == 0) macro = line.substr(8, line.find_first_of(" (", 8) - 8);
    const std::string start = "MPM_DEVICE_PHASE(";
    std::size_t at = line.find(start);
    if (at == line.npos || line.rfind("//", 0) == 0) continue;
    at += start.size();
    const std::string name = line.substr(at, line.find(',', at) - at);
    const auto group =
        std::find_if(groups.begin(), groups.end(), [&](const EntryGroup& g) { return macro == g.macro; });
    if (group == groups.end()) continue;
    const std::size_t number = name.find("##");
    if (number == name.npos) names.push_back(name);
    for (std::size_t k = 0; number != name.npos && k < group->times; ++k)
      names.push_back(name.substr(0, number) + std::to_string(k));
  }
  return names;
}

}  // namespace

std::string Choice::name() const {
  std::string text = std::to_string(dimension) + "-D " + (axisymmetric ? "axisymmetric " : "") +
                     (precision == Precision::single ? "float" : "double") + ":";
  std::vector<const Plugin*> plugins{shape, transfer, filter, contact, normal, detection};
  plugins.insert(plugins.end(), rigid_laws.begin(), rigid_laws.end());
  plugins.insert(plugins.end(), materials.begin(), materials.end());
  for (const Plugin* plugin : plugins)
    if (plugin) text += " " + std::string(plugin->id());
  if (basis_order > 0) text += ", polynomials of order " + std::to_string(basis_order);
  return text;
}

namespace {
std::vector<const Plugin*> laws_of_rigid_bodies(const Experiment& experiment) {
  std::vector<const Plugin*> laws;
  for (const RigidBodySpecification& body : experiment.rigid_bodies)
    if (std::find(laws.begin(), laws.end(), body.contact.plugin) == laws.end()) laws.push_back(body.contact.plugin);
  return laws;
}
}  // namespace

int number_of_law(const Experiment& experiment, std::size_t body) {
  const std::vector<const Plugin*> laws = laws_of_rigid_bodies(experiment);
  return static_cast<int>(std::find(laws.begin(), laws.end(), experiment.rigid_bodies[body].contact.plugin) -
                          laws.begin());
}

Choice choice_of(const Experiment& experiment, const Plan& plan) {
  Choice choice;
  choice.dimension = experiment.dimension;
  choice.precision = experiment.precision;
  choice.axisymmetric = experiment.axisymmetric();
  choice.shape = experiment.shape.plugin;
  choice.transfer = experiment.transfer.plugin;
  choice.basis_order = plan.basis_order;
  choice.reactions = experiment.notes_reactions();
  choice.advance = plan.advance;
  choice.deterministic = sums_deterministically(experiment);
  choice.contact_by_particles = ContactPoints(experiment).needed();
  choice.notes_contact = records_nodes(experiment);
  choice.loads_at_points = !experiment.loaded_at_points().empty();
  choice.formulas = ParticleFormulas(experiment).text();
  choice.node_fields = node_fields(experiment, plan);
  choice.particle_fields = particle_fields(experiment, plan, 0);
  if (experiment.filter) choice.filter = experiment.filter->plugin;
  if (experiment.contact) choice.contact = experiment.contact->plugin;
  if (experiment.contact) choice.normal = experiment.contact_normal->plugin;
  if (choice.normal && !(choice.contact->contact().traits & MPM_BYPASSES_DETECTION))
    choice.detection = experiment.contact_detection->plugin;
  choice.rigid_laws = laws_of_rigid_bodies(experiment);
  for (const MaterialSpecification& material : experiment.materials)
    choice.materials.push_back(material.component.plugin);
  return choice;
}

int most_channels(const Choice& choice) {
  int scattered = 0;
  for (const Field& field : choice.node_fields) scattered += is_scattered(field) ? field.components : 0;
  // As of heat; grips take one less in the plane, and as many in space.
  return std::max(scattered, 4 + choice.dimension);
}

const char* embedded_header(std::string_view path) {
  for (const Header& header : headers)
    if (path == header.path) return header.text;
  return nullptr;
}

Composition compose(const Choice& choice) {
  Text text;
  text.add_header("backends/device/kernels/kernels.hpp", "the composer");
  if (choice.contact_by_particles) text.add_header("backends/device/kernels/contact_points.hpp", "the composer");
  for (const Plugin* plugin :
       {choice.shape, choice.transfer, choice.filter, choice.contact, choice.normal, choice.detection})
    if (plugin) text.add_functor(*plugin);
  for (const Plugin* plugin : choice.rigid_laws) text.add_functor(*plugin);
  for (const Plugin* plugin : choice.materials) text.add_functor(*plugin);
  text.add(scene_text(choice));
  Composition composition{choice.name(), text.str(), "", entry_names(choice), {}};
  composition.hash = support::sha256(composition.text);
  std::vector<const Plugin*> chosen{choice.shape,   choice.transfer, choice.filter,
                                    choice.contact, choice.normal,   choice.detection};
  for (const Plugin* law : choice.rigid_laws)
    if (law != choice.contact) chosen.push_back(law);
  chosen.insert(chosen.end(), choice.materials.begin(), choice.materials.end());
  for (const Plugin* plugin : chosen)
    if (plugin) composition.plugins.emplace_back(name_in_messages(*plugin), plugin->file.string());
  return composition;
}

std::string cache_key(const Composition& composition, std::string_view compiler,
                      const std::vector<std::string>& options) {
  std::string all = composition.hash + "\n" + std::string(compiler);
  for (const std::string& option : options) all += "\n" + option;
  return support::sha256(all);
}

}  // namespace mpm::device
