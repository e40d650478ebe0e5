#include "experiment/thermal.hpp"

#include <algorithm>

namespace mpm {
namespace {

using Type = ParameterType;

ParameterSpec temperature_field(std::string doc, std::string variables) {
  return parameter("temperature", Type::expression, "K", std::move(doc)).over(std::move(variables)).from(0);
}

ParameterSpec conductivity() {
  return parameter("conductivity", Type::number, "W/(m K)", "Heat flux that a unit gradient of temperature drives.")
      .above(0);
}

ParameterSpec heat_capacity() {
  return parameter("heat_capacity", Type::number, "J/(kg K)", "Heat that warms a unit of mass by one kelvin.").above(0);
}

/// The keys that may differ in the melted material. Its mass and volume are the particle's, so its density may not.
Section melted_section(const Plugin& plugin) {
  Section section{"melted",
                  "values of the melted material, where they are not those of the solid",
                  {conductivity(), heat_capacity()}};
  for (const mpm_parameter& declared : plugin.parameters()) {
    ParameterSpec spec = from_plugin(declared);
    if (spec.name == "density") continue;
    spec.required = false;
    spec.default_value = nullptr;
    section.parameters.push_back(std::move(spec));
  }
  return section;
}

Section phase_change_section(const Plugin& plugin) {
  return {
      "phase_change",
      "melting and freezing",
      {
          parameter("temperature", Type::number, "K", "Temperature at which it melts and freezes.").from(0).needed(),
          parameter("latent_heat", Type::number, "J/kg", "Heat that melts a unit of mass.").above(0).needed(),
          parameter("melted", Type::nested, "",
                    "Values of particles that are melted by half or more; default: those of the solid.")
              .made_of(melted_section(plugin)),
      }};
}

Section convection_section() {
  return {"convection",
          "heat exchanged with what lies beyond the wall",
          {
              parameter("coefficient", Type::number, "W/(m^2 K)", "Heat flux by a unit difference of temperature.")
                  .above(0)
                  .needed(),
              temperature_field("Temperature beyond the wall, of x y z and t.", "xyzt").needed(),
          }};
}

PhaseChange read_phase_change(const Fields& material, const Fields& thermal, const Component& component,
                              ReadContext& context, OrderedJson& resolved) {
  const Fields fields = thermal.nested("phase_change");
  PhaseChange change;
  change.pointer = thermal.node("phase_change")->pointer;
  change.temperature = fields.number("temperature");
  change.latent_heat = fields.number("latent_heat");

  const Section section = melted_section(*component.plugin);
  Section with_density = section;
  with_density.parameters.push_back(parameter("density", Type::number, "any", "").not_offered());
  const Fields melted(fields.node("melted"), with_density, context);
  if (melted.given("density"))
    context.problem(*melted.node("density"),
                    "a particle keeps its mass and its volume when it melts, and so its density; remove \"density\"");
  const auto value = [&](const char* name) { return (melted.given(name) ? melted : thermal).number(name); };
  change.melted = {value("conductivity"), value("heat_capacity")};
  change.melted_parameters = component.parameters;
  for (const mpm_parameter& declared : component.plugin->parameters()) {
    const std::size_t slot = declared.offset / sizeof(double);
    if (slot < change.melted_parameters.size() && melted.given(declared.name))
      change.melted_parameters[slot] = melted.number(declared.name);
  }

  resolved = fields.resolved;
  OrderedJson& written = resolved["melted"] = OrderedJson::object();
  for (const ParameterSpec& spec : section.parameters) {
    for (const Fields* from : {&melted, &thermal, &material}) {
      if (!from->resolved.contains(spec.name)) continue;
      written[spec.name] = from->resolved[spec.name];
      break;
    }
  }
  return change;
}

}  // namespace

bool Experiment::has_temperature() const {
  return std::any_of(materials.begin(), materials.end(), [](auto& material) { return material.thermal.has_value(); });
}

ParameterSpec thermal_parameter(const Plugin& plugin) {
  return parameter("thermal", Type::nested, "", "What the material does with heat; default: nothing.")
      .made_of({"thermal",
                "conduction and storage of heat",
                {
                    conductivity().needed(),
                    heat_capacity().needed(),
                    parameter("dissipation_to_heat", Type::number, "",
                              "Share of the energy that the material dissipates which warms it.")
                        .from(0)
                        .to(1)
                        .standard(0),
                    parameter("phase_change", Type::nested, "", "Melting and freezing; default: none.")
                        .made_of(phase_change_section(plugin)),
                }});
}

ParameterSpec body_temperature() {
  return temperature_field("Initial temperature, of x y z; with materials that have \"thermal\".", "xyz");
}

std::vector<ParameterSpec> wall_heat_parameters() {
  return {temperature_field("Temperature that the wall is held at, of x y z and t.", "xyzt"),
          parameter("heat_flux", Type::expression, "W/m^2", "Heat flux through the wall into the body, of x y z and t.")
              .over("xyzt"),
          parameter("convection", Type::nested, "", "Heat exchanged with what lies beyond the wall.")
              .made_of(convection_section())};
}

std::vector<ParameterSpec> box_heat_parameters() {
  return {temperature_field("Temperature that the nodes are held at, of x y z and t.", "xyzt"),
          parameter("heating", Type::expression, "W",
                    "Power that warms the nodes, shared by their mass (in plane strain a metre of depth), of x y z t.")
              .over("xyzt")};
}

std::optional<Thermal> read_thermal(const Fields& material, const Component& component, ReadContext& context,
                                    OrderedJson& resolved) {
  if (!material.given("thermal")) return std::nullopt;
  const Fields fields = material.nested("thermal");
  Thermal thermal;
  thermal.pointer = material.node("thermal")->pointer;
  thermal.solid = {fields.number("conductivity"), fields.number("heat_capacity")};
  thermal.dissipation_to_heat = fields.number("dissipation_to_heat");
  OrderedJson& written = resolved["thermal"] = fields.resolved;
  if (fields.given("phase_change"))
    thermal.phase_change = read_phase_change(material, fields, component, context, written["phase_change"]);
  return thermal;
}

ThermalCondition read_thermal_condition(const Fields& fields, ReadContext& context, OrderedJson& resolved) {
  constexpr std::pair<const char*, HeatExchange> keys[] = {{"temperature", HeatExchange::fixed_temperature},
                                                           {"heat_flux", HeatExchange::flux},
                                                           {"convection", HeatExchange::convection},
                                                           {"heating", HeatExchange::heating}};
  ThermalCondition condition;
  std::string chosen;
  for (const ParameterSpec& spec : fields.section().parameters) {
    const auto* const key =
        std::find_if(std::begin(keys), std::end(keys), [&](auto& k) { return spec.name == k.first; });
    if (key == std::end(keys) || !fields.given(spec.name)) continue;
    if (!chosen.empty()) {
      context.problem(*fields.node(spec.name), in_quotes(spec.name) + " and " + in_quotes(chosen) +
                                                   " are not both possible in one place; remove one of them");
      continue;
    }
    chosen = spec.name;
    condition.exchange = key->second;
    condition.pointer = fields.node(spec.name)->pointer;
    if (spec.type == Type::expression) {
      condition.value = fields.scalar_expression(spec.name);
      continue;
    }
    const Fields convection = fields.nested(spec.name);
    condition.coefficient = convection.number("coefficient");
    condition.value = convection.scalar_expression("temperature");
    resolved[spec.name] = convection.resolved;
  }
  return condition;
}

namespace {

/// The places of a scene without thermal materials that speak of heat, each once.
std::vector<std::string> places_of_heat(const Experiment& experiment) {
  std::vector<std::string> places;
  const auto add = [&](const std::string& pointer) {
    if (std::find(places.begin(), places.end(), pointer) == places.end()) places.push_back(pointer);
  };
  for (const auto& faces : experiment.faces)
    for (const FaceCondition& face : faces)
      if (face.thermal.exchange != HeatExchange::none) add(face.thermal.pointer);
  for (const BoxCondition& box : experiment.boxes)
    if (box.thermal.exchange != HeatExchange::none) add(box.thermal.pointer);
  for (const char* name : {"temperature", "melted_fraction"})
    if (experiment.output.colour_by == name) add("/output/colour_by");
  for (const BodySpecification& body : experiment.bodies)
    if (body.temperature) add(child_pointer(body.pointer, "temperature"));
  return places;
}

/// Refuses to turn dissipation to heat where a step strains before its gather, which may replace the temperature that
/// was raised.
void check_order_of_strain(const Node& root, const Experiment& experiment, ReadContext& context) {
  const StressUpdate update = experiment.solver.stress_update;
  if (update != StressUpdate::first && update != StressUpdate::averaged) return;
  for (const MaterialSpecification& material : experiment.materials) {
    if (!material.thermal || material.thermal->dissipation_to_heat == 0) continue;
    const Node& place = nearest_node(root, "/solver/stress_update");
    return context.problem(
        place,
        "order " + in_quotes(place.text) +
            " strains before the gather, which may replace the temperature that \"dissipation_to_heat\" of material " +
            in_quotes(material.name) + " has raised; choose \"last\" or \"modified_last\"");
  }
}

void check_body(const Node& root, const Experiment& experiment, const BodySpecification& body, ReadContext& context) {
  const Node &place = nearest_node(root, body.pointer), &name = nearest_node(root, body.pointer + "/material");
  const MaterialSpecification& material = experiment.materials[body.material];
  if (name.text != material.name) return;  // there is no such material, which is reported already
  if (!material.thermal)
    context.problem(name, "material " + in_quotes(material.name) +
                              " has no \"thermal\", which another has: all bodies have a temperature or none; give it "
                              "\"thermal\": {\"conductivity\": …, \"heat_capacity\": …}");
  else if (!body.temperature)
    context.problem(place.at, child_pointer(body.pointer, "temperature"),
                    "missing key; expected " + describe_expected(body_temperature()) + ", as material " +
                        in_quotes(material.name) + " has \"thermal\"");
}

}  // namespace

void check_temperature(const Node& root, const Experiment& experiment, ReadContext& context) {
  const auto is_plugin = [](const MaterialSpecification& material) { return material.component.plugin != nullptr; };
  const auto& materials = experiment.materials;
  if (materials.empty() || !std::all_of(materials.begin(), materials.end(), is_plugin)) return;  // reported already
  if (!experiment.has_temperature()) {
    for (const std::string& pointer : places_of_heat(experiment))
      context.problem(
          nearest_node(root, pointer),
          "nothing has a temperature here, as no material has \"thermal\"; give every material \"thermal\": "
          "{\"conductivity\": …, \"heat_capacity\": …}, or remove this");
    return;
  }
  if (experiment.output.colour_by == "melted_fraction" &&
      std::none_of(materials.begin(), materials.end(),
                   [](auto& material) { return material.thermal && material.thermal->phase_change; }))
    context.problem(nearest_node(root, "/output/colour_by"),
                    "nothing melts here, as no material has \"phase_change\" in its \"thermal\"; give one "
                    "\"phase_change\": {\"temperature\": …, \"latent_heat\": …}, or choose another colour");
  for (const BodySpecification& body : experiment.bodies) check_body(root, experiment, body, context);
  if (experiment.filter)
    context.problem(
        nearest_node(root, experiment.filter->pointer),
        "filter " + in_quotes(experiment.filter->plugin->id()) +
            " acts on velocities alone, and a scene with temperature needs one that acts on both; remove the "
            "filter, or \"thermal\"");
  check_order_of_strain(root, experiment, context);
  for (const auto& faces : experiment.faces)
    for (const FaceCondition& face : faces)
      if (face.type == ConditionType::separate && face.thermal.exchange != HeatExchange::none)
        context.problem(nearest_node(root, face.thermal.pointer),
                        "a wall of type \"separate\" mirrors a body only while that presses on it, and heat that comes "
                        "through a wall needs the mirror image all the time; choose \"slip\" or \"stick\"");
  const ThermalCondition& axis = experiment.faces[0][0].thermal;
  if (experiment.axisymmetric() && experiment.grid.lower[0] == 0 && axis.exchange != HeatExchange::none)
    context.problem(nearest_node(root, axis.pointer),
                    "x_min is the axis r = 0, which is no wall and lets no heat through; set \"x_min\" to \"slip\"");
}

std::optional<std::string> refusal_of_temperature(const Plugin& transfer, int basis_order) {
  const std::string name = "transfer " + in_quotes(transfer.id());
  if (transfer.transfer().traits & MPM_KEEPS_SPIN_ONLY)
    return name + " keeps the spin of a velocity alone, and a temperature has none; choose transfer \"apic\"";
  if (basis_order > 0)
    return name +
           " carries polynomials of a velocity beyond the affine ones, and none of a temperature; choose "
           "transfer \"apic\"";
  return std::nullopt;
}

std::optional<std::string> refusal_of_gradients(const Experiment& experiment) {
  const Plugin &shape = *experiment.shape.plugin, &transfer = *experiment.transfer.plugin;
  const auto is_frozen = [](const BodySpecification& body) { return body.frozen; };
  if ((transfer.transfer().traits & MPM_SCATTERS_AFFINE) == 0 ||
      shape.shape().second_moment_kind != MPM_MOMENT_IS_GRADIENT ||
      std::all_of(experiment.bodies.begin(), experiment.bodies.end(), is_frozen))
    return std::nullopt;
  return "shape " + in_quotes(shape.id()) + " with transfer " + in_quotes(transfer.id()) +
         " lets gradients of the temperature grow without bounds where the edge of a moving body leaves a node with "
         "little of it; choose shape \"gimp\" or \"bspline_quadratic\", transfer \"flip\" or \"pic\", or freeze every "
         "body";
}

}  // namespace mpm
