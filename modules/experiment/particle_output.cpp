#include "experiment/particle_output.hpp"

#include <algorithm>
#include <cmath>

#include "experiment/polynomials.hpp"
#include "experiment/thermal.hpp"

namespace mpm {
namespace {

using Shape = ParticleField::Shape;
using Type = ParameterType;

constexpr std::size_t most_times = 100000;

Shape shape_of(const mpm_state& declared) {
  if (declared.shape == MPM_STATE_SCALAR) return Shape::scalar;
  return declared.shape == MPM_STATE_VECTOR ? Shape::vector : Shape::tensor;
}

bool knows(const std::vector<ParticleField>& fields, const std::string& name) {
  return std::any_of(fields.begin(), fields.end(), [&](const ParticleField& field) { return field.name == name; });
}

void add_state(const Component& component, std::vector<ParticleField>& fields) {
  for (const mpm_state& declared : component.plugin->state())
    if (!knows(fields, declared.name)) fields.push_back({declared.name, declared.unit, shape_of(declared)});
}

bool all_components_known(const Experiment& experiment) {
  return experiment.shape.plugin != nullptr && experiment.transfer.plugin != nullptr && !experiment.materials.empty() &&
         std::all_of(experiment.materials.begin(), experiment.materials.end(),
                     [](const MaterialSpecification& material) { return material.component.plugin != nullptr; });
}

/// Why a field that some scene may have is not there; an empty string when nothing is known about the name.
std::string reason_for_lack(const std::string& name) {
  if (name == "contact_traction") return "no two bodies of this scene meet by \"contact\"";
  if (name == "deformation_gradient") return "no material of this scene keeps a deformation gradient";
  if (name == "velocity_gradient") return "the transfer of this scene keeps no velocity gradient";
  if (name == "temperature" || name == "melted_fraction") return "no material of this scene has it in its \"thermal\"";
  if (name == "artificial_pressure") return "no material of this scene has \"artificial_viscosity\"";
  return "";
}

std::vector<std::string> names_of(const std::vector<ParticleField>& fields) {
  std::vector<std::string> names;
  for (const ParticleField& field : fields) names.push_back(field.name);
  return names;
}

std::string all_in_words(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

/// The strings of a list, or the one string; nothing, with a problem, for anything else.
std::vector<const Node*> strings_in(const Node& node, const char* expected, ReadContext& context) {
  if (node.type == Node::Type::string) return {&node};
  const bool list = node.type == Node::Type::array && !node.items.empty() &&
                    std::all_of(node.items.begin(), node.items.end(),
                                [](const Node& item) { return item.type == Node::Type::string; });
  if (!list) {
    context.problem(node, std::string("expected ") + expected + ", got " + describe_value(node));
    return {};
  }
  std::vector<const Node*> strings;
  for (const Node& item : node.items) strings.push_back(&item);
  return strings;
}

void read_format(const Fields& fields, ParticleOutput& output, ReadContext& context) {
  if (!fields.given("format")) return;
  output.vtk = output.csv = false;
  for (const Node* word : strings_in(*fields.node("format"), "\"vtk\", \"csv\" or a list of them", context)) {
    if (word->text == "vtk")
      output.vtk = true;
    else if (word->text == "csv")
      output.csv = true;
    else
      context.problem(*word, "expected \"vtk\" or \"csv\", got " + describe_value(*word));
  }
}

void read_names(const Fields& fields, const Experiment& experiment, ParticleOutput& output, ReadContext& context) {
  const bool known = all_components_known(experiment);
  const std::vector<std::string> names = known ? names_of(particle_fields(experiment)) : std::vector<std::string>();
  if (!fields.given("fields")) {
    output.fields = {"velocity", "body", "pressure", "von_mises_stress", "volume_ratio"};
    return;
  }
  const Node& node = *fields.node("fields");
  if (node.type == Node::Type::string && node.text == "all") {
    output.fields = names;
    return;
  }
  for (const Node* word : strings_in(node, "\"all\" or a list of names of fields", context)) {
    const std::string& name = word->text;
    const bool again = std::find(output.fields.begin(), output.fields.end(), name) != output.fields.end();
    if (again) context.problem(*word, in_quotes(name) + " stands twice in the list");
    if (known && std::find(names.begin(), names.end(), name) == names.end()) {
      const std::string reason = reason_for_lack(name);
      context.problem(*word, "there is no field " + in_quotes(name) + " here" +
                                 (reason.empty() ? did_you_mean(name, names) : ": " + reason) + "; available are " +
                                 all_in_words(names));
    }
    if (!again) output.fields.push_back(name);
  }
}

void read_list_of_times(const Node& node, double end, ParticleOutput& output, ReadContext& context) {
  if (node.type != Node::Type::array || node.items.empty())
    return context.problem(node, "expected a list of times (s), got " + describe_value(node));
  for (const Node& item : node.items) {
    double time = 0;
    if (!read_si(item, "s", "a time (s)", time, context)) return;
    if (!(time >= 0 && time <= end))
      return context.problem(item,
                             number_text(time) + " s is not within the run, which ends at " + number_text(end) + " s");
    if (!output.times.empty() && !(time > output.times.back()))
      return context.problem(
          item, "times must rise: " + number_text(time) + " comes after " + number_text(output.times.back()));
    output.times.push_back(time);
  }
}

void read_times(const Fields& fields, double end, ParticleOutput& output, ReadContext& context) {
  std::vector<std::string> given;
  for (const char* key : {"count", "every_time", "times"})
    if (fields.given(key)) given.emplace_back(key);
  if (given.size() != 1)
    return context.problem(fields.place(given.empty() ? "count" : given.back()),
                           "says " + std::string(given.empty() ? "not" : "twice") +
                               " when to write: give one of \"count\", \"every_time\" and \"times\"");
  if (!fields.valid(given.front()) || !(end > 0)) return;
  if (fields.given("times")) {
    read_list_of_times(*fields.node("times"), end, output, context);
  } else if (fields.given("count")) {
    const int count = fields.integer("count");
    for (int k = 0; k < count; ++k) output.times.push_back(count == 1 ? 0.0 : end * k / (count - 1));
  } else {
    const double every = fields.number("every_time");
    const double last = std::floor(end / every * (1 + 1e-12));
    if (last >= static_cast<double>(most_times))
      return context.problem(*fields.node("every_time"), "makes " + number_text(last + 1) + " files of the run of " +
                                                             number_text(end) + " s; at most " +
                                                             std::to_string(most_times) + " are written");
    for (int k = 0; k <= static_cast<int>(last); ++k) output.times.push_back(std::min(k * every, end));
  }
}

/// Keys that act on VTK files alone.
void refuse_without_vtk(const Fields& fields, const ParticleOutput& output, ReadContext& context) {
  if (output.vtk || !output.csv) return;
  for (const auto& [key, acts] :
       {std::pair{"shape", output.domains}, std::pair{"grid", output.grid},
        std::pair{"compress", fields.given("compress")}, std::pair{"numbers", fields.given("numbers")}})
    if (acts)
      context.problem(fields.place(key),
                      std::string("acts on VTK files alone: add \"vtk\" to \"format\", or remove ") + in_quotes(key));
}

Section particle_output_section() {
  return {"particles",
          "particle data in files",
          {
              parameter("format", Type::nested, "", "\"vtk\" (default), \"csv\" or a list of both.")
                  .defined_as("particle_formats"),
              parameter("fields", Type::nested, "", "Names of fields, or \"all\".").defined_as("particle_fields"),
              parameter("count", Type::integer, "", "Files over the run, at equal times, first and last included.")
                  .from(1)
                  .to(static_cast<double>(most_times)),
              parameter("every_time", Type::number, "s", "Time from one file to the next.").above(0),
              parameter("times", Type::nested, "", "Times of the files, s.").defined_as("particle_times"),
              parameter("shape", Type::choice, "", "What a particle is in VTK files: a point, or its deformed domain.")
                  .of({"points", "domains"})
                  .standard("points"),
              parameter("grid", Type::boolean, "", "Write mass and velocity of the nodes as an image file as well.")
                  .standard(false),
              parameter("compress", Type::boolean, "", "Compress VTK files by zlib.").standard(true),
              parameter("numbers", Type::choice, "", "Numbers of VTK files: 32 or 64 bits.")
                  .of({"float", "double"})
                  .standard("float"),
          }};
}

}  // namespace

bool ParticleOutput::asks(std::string_view field) const {
  return std::find(fields.begin(), fields.end(), field) != fields.end();
}

std::vector<ParticleField> particle_fields(const Experiment& experiment) {
  std::vector<ParticleField> fields{{"velocity", "m/s", Shape::vector},
                                    {"speed", "m/s", Shape::scalar},
                                    {"body", "", Shape::scalar},
                                    {"mass", "kg", Shape::scalar},
                                    {"volume", "m³", Shape::scalar},
                                    {"initial_position", "m", Shape::vector},
                                    {"displacement", "m", Shape::vector},
                                    {"cauchy_stress", "Pa", Shape::tensor},
                                    {"kirchhoff_stress", "Pa", Shape::tensor},
                                    {"pressure", "Pa", Shape::scalar},
                                    {"von_mises_stress", "Pa", Shape::scalar},
                                    {"volume_ratio", "", Shape::scalar},
                                    {"stored_energy", "J/m³", Shape::scalar},
                                    {"wave_speed", "m/s", Shape::scalar}};
  if (experiment.contact) fields.push_back({"contact_traction", "Pa", Shape::vector});
  if (experiment.has_temperature()) fields.push_back({"temperature", "K", Shape::scalar});
  if (experiment.has_artificial_viscosity()) fields.push_back({"artificial_pressure", "Pa", Shape::scalar});
  for (const MaterialSpecification& material : experiment.materials)
    if (material.thermal && material.thermal->phase_change && !knows(fields, "melted_fraction"))
      fields.push_back({"melted_fraction", "", Shape::scalar});
  for (const MaterialSpecification& material : experiment.materials) add_state(material.component, fields);
  add_state(experiment.transfer, fields);
  if (experiment.contact) add_state(*experiment.contact, fields);
  for (const std::string& name : polynomial_names(experiment)) fields.push_back({name, "m/s", Shape::vector});
  return fields;
}

ParameterSpec particle_output_parameter() {
  return parameter("particles", Type::nested, "", "Particle data in files, at times of their own; default: none.")
      .made_of(particle_output_section());
}

OrderedJson particle_output_schemas() {
  const OrderedJson format = {{"enum", {"vtk", "csv"}}}, name = {{"type", "string"}};
  const auto one_or_list = [](const OrderedJson& one) -> OrderedJson {
    return {{"anyOf", OrderedJson::array({one, {{"type", "array"}, {"items", one}, {"minItems", 1}}})}};
  };
  return {{"particle_formats", one_or_list(format)},
          {"particle_fields", one_or_list(name)},
          {"particle_times",
           {{"type", "array"}, {"items", {{"type", OrderedJson::array({"number", "string"})}}}, {"minItems", 1}}}};
}

ParticleOutput read_particle_output(const Fields& fields, const Experiment& experiment, ReadContext& context,
                                    OrderedJson& resolved) {
  ParticleOutput output;
  read_format(fields, output, context);
  read_names(fields, experiment, output, context);
  read_times(fields, experiment.solver.end_time, output, context);
  output.domains = fields.text("shape") == "domains";
  output.grid = fields.boolean("grid");
  output.compress = fields.boolean("compress");
  output.in_double = fields.text("numbers") == "double";
  refuse_without_vtk(fields, output, context);
  resolved = fields.resolved;
  // What a file without the key would be read as, so that the resolved file says all of it.
  for (const char* key : {"count", "every_time"})
    if (!fields.given(key)) resolved.erase(key);
  resolved["format"] = OrderedJson::array();
  if (output.vtk) resolved["format"].push_back("vtk");
  if (output.csv) resolved["format"].push_back("csv");
  resolved["fields"] = output.fields;
  if (fields.given("times")) resolved["times"] = output.times;
  if (!output.vtk)
    for (const char* key : {"compress", "numbers"}) resolved.erase(key);
  return output;
}

}  // namespace mpm
