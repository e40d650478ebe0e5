#include "experiment/schema.hpp"
#include "experiment/device_settings.hpp"

#include <algorithm>
#include <cmath>

#include "experiment/particle_output.hpp"
#include "experiment/records.hpp"
#include "experiment/sections.hpp"

namespace mpm {
namespace {

using Json = OrderedJson;

/// The pattern of a number, then a unit: what units.hpp parses, as far as a pattern can tell.
constexpr const char* quantity_pattern = "^\\s*[-+]?([0-9]+\\.?[0-9]*|\\.[0-9]+)([eE][-+]?[0-9]+)?\\s*[^0-9\\s.].*$";

Json reference(const std::string& definition) {
  return {{"$ref", "#/$defs/" + definition}};
}

Json section_schema(const Section& section);

Json list_of(Json items) {
  return {{"type", "array"}, {"items", std::move(items)}};
}

void put_range(const ParameterSpec& spec, Json& schema) {
  if (std::isfinite(spec.minimum)) schema[spec.above_minimum ? "exclusiveMinimum" : "minimum"] = spec.minimum;
  if (std::isfinite(spec.maximum)) schema[spec.below_maximum ? "exclusiveMaximum" : "maximum"] = spec.maximum;
}

Json quantity(const Json& number, const ParameterSpec& spec) {
  Json any = Json::array({number, {{"type", "string"}, {"pattern", quantity_pattern}}});
  if (!spec.word.empty()) any.push_back({{"const", spec.word}});
  return {{"anyOf", std::move(any)}};
}

Json vector_of(const ParameterSpec& spec, Json component) {
  Json schema = list_of(std::move(component));
  schema["minItems"] = spec.components ? spec.components : 2;
  schema["maxItems"] = spec.components ? spec.components : 3;
  return schema;
}

Json strings_of(const ParameterSpec& spec) {
  Json schema = {{"type", "string"}};
  if (!spec.choices.empty()) schema["enum"] = spec.choices;
  return schema;
}

Json value_schema(const ParameterSpec& spec) {
  const Json number = {{"type", "number"}};
  switch (spec.type) {
    case ParameterType::number: {
      Json ranged = number;
      put_range(spec, ranged);
      return quantity(ranged, spec);
    }
    case ParameterType::integer: {
      Json schema = {{"type", "integer"}};
      put_range(spec, schema);
      return schema;
    }
    case ParameterType::boolean:
      return {{"type", "boolean"}};
    case ParameterType::choice:
    case ParameterType::string:
      if (spec.may_be_boolean) return {{"anyOf", Json::array({{{"type", "boolean"}}, strings_of(spec)})}};
      return strings_of(spec);
    case ParameterType::vector:
      return vector_of(spec, quantity(number, {}));
    case ParameterType::expression:
      return {{"type", Json::array({"number", "string"})}};
    case ParameterType::expression_vector: {
      Json types = Json::array({"number", "string"});
      if (spec.may_leave_free) types.push_back("null");
      return vector_of(spec, {{"type", types}});
    }
    case ParameterType::points: {
      Json schema = list_of(vector_of(spec, quantity(number, {})));
      schema["minItems"] = spec.least_items;
      schema["maxItems"] = spec.most_items;
      return schema;
    }
    case ParameterType::names: {
      Json items = strings_of(spec);
      if (spec.table) items = {{"anyOf", Json::array({std::move(items), section_schema(*spec.table)})}};
      Json schema = list_of(std::move(items));
      schema["uniqueItems"] = true;
      if (spec.may_be_boolean) return {{"anyOf", Json::array({{{"type", "boolean"}}, std::move(schema)})}};
      return schema;
    }
    case ParameterType::nested: {
      Json object = spec.table ? section_schema(*spec.table) : reference(spec.definition);
      if (spec.required) return object;
      // null takes an optional section away, so that a study can switch it off.
      return {{"anyOf", Json::array({std::move(object), {{"type", "null"}}})}};
    }
  }
  return {};
}

Json parameter_schema(const ParameterSpec& spec) {
  Json schema = value_schema(spec);
  if (spec.may_be_null) schema = {{"anyOf", Json::array({std::move(schema), {{"type", "null"}}})}};
  const bool has_unit = !spec.unit.empty() && spec.unit != "any";
  const std::string text = spec.doc + (has_unit ? " Unit: " + spec.unit + "." : "");
  if (!text.empty()) schema["description"] = text;
  if (spec.default_value.is_null()) return schema;
  const bool vector = spec.type == ParameterType::vector || spec.type == ParameterType::expression_vector;
  // The number that is a vector's default stands for as many as there are dimensions.
  if (!vector || spec.default_value.is_array()) schema["default"] = spec.default_value;
  return schema;
}

Json section_schema(const Section& section) {
  Json properties = Json::object(), required = Json::array();
  if (section.tagged) {
    properties["type"] = {{"const", section.name}};
    required.push_back("type");
  }
  for (const ParameterSpec& spec : section.parameters) {
    properties[spec.name] = parameter_schema(spec);
    if (spec.required) required.push_back(spec.name);
  }
  Json schema = {{"type", "object"}};
  if (!section.doc.empty()) schema["description"] = section.doc;
  schema["properties"] = std::move(properties);
  if (!required.empty()) schema["required"] = std::move(required);
  schema["additionalProperties"] = false;
  return schema;
}

/// An object whose "type" decides which keys it has: editors then complete the keys of that type alone. With
/// `first_is_standard` an object without "type" is of the first kind.
Json choice_schema(const std::vector<Section>& kinds, bool first_is_standard = false) {
  if (kinds.empty()) return {{"not", Json::object()}, {"description", "Nothing of this kind is available."}};
  Json names = Json::array(), branches = Json::array();
  for (const Section& kind : kinds) {
    names.push_back(kind.name);
    Json condition = {{"properties", {{"type", {{"const", kind.name}}}}}}, keys = section_schema(kind);
    const bool may_be_left_out = first_is_standard && &kind == &kinds.front();
    if (may_be_left_out)
      keys["required"].erase(0);  // "type", which a tagged section requires before its own keys
    else
      condition["required"] = {"type"};
    branches.push_back({{"if", std::move(condition)}, {"then", std::move(keys)}});
  }
  Json schema = {{"type", "object"}};
  if (!first_is_standard) schema["required"] = {"type"};
  schema["properties"]["type"]["enum"] = std::move(names);
  if (first_is_standard) schema["properties"]["type"]["default"] = kinds.front().name;
  schema["allOf"] = std::move(branches);
  return schema;
}

/// A word, or an object whose keys have defaults or not.
Json words_or(const std::vector<Section>& kinds) {
  Json names = Json::array();
  for (const Section& kind : kinds) {
    const auto& keys = kind.parameters;
    if (std::none_of(keys.begin(), keys.end(), [](auto& key) { return key.required; })) names.push_back(kind.name);
  }
  return {{"anyOf", Json::array({{{"enum", std::move(names)}}, choice_schema(kinds)})}};
}

Json definitions(const ComponentLookup& components, const ReadOptions& options) {
  Json all = Json::object();
  all["constants"] = {{"type", "object"},
                      {"description", "Named numbers for expressions."},
                      {"additionalProperties", quantity({{"type", "number"}}, {})}};
  all["grid"] = section_schema(grid_section());
  all["boundaries"] = section_schema(boundaries_section(3));
  all["face_condition"] = words_or(face_condition_kinds());
  all["node_condition"] = choice_schema(node_condition_kinds());
  all["node_conditions"] = list_of(reference("node_condition"));
  for (const mpm_kind kind : {MPM_SHAPE, MPM_TRANSFER, MPM_FILTER, MPM_CONTACT, MPM_MATERIAL}) {
    all[std::string(kind_name(kind))] = choice_schema(component_kinds(components, kind));
  }
  for (const mpm_kind kind : {MPM_NORMAL, MPM_DETECTION})
    all[std::string(kind_name(kind))] = words_or(component_kinds(components, kind));
  all["materials"] = {{"type", "object"}, {"minProperties", 1}, {"additionalProperties", reference("material")}};
  all["geometry"] = choice_schema(geometry_kinds());
  all["geometries"] = list_of(reference("geometry"));
  all["seeding"] = words_or(seeding_kinds());
  all["body"] = section_schema(body_section());
  all["bodies"] = list_of(reference("body"));
  all["bodies"]["minItems"] = 1;
  all["load"] = choice_schema(load_kinds());
  all["loads"] = list_of(reference("load"));
  all["solver"] = choice_schema(solver_kinds(options), true);
  all["output"] = section_schema(output_section(options));
  all["grips"] = list_of(section_schema(grip_section()));
  all["rigid_contact"] = choice_schema(rigid_contact_kinds(components));
  Json rigid_body = section_schema(rigid_body_section(3));
  Json& turning = rigid_body["properties"]["angular_velocity"];
  turning = {
      {"anyOf", Json::array({section_schema(rigid_body_section(2))["properties"]["angular_velocity"], turning})}};
  all["rigid_bodies"] = list_of(std::move(rigid_body));
  all["emitters"] = list_of(section_schema(emitter_section()));
  all["sinks"] = list_of(section_schema(sink_section()));
  all["device"] = section_schema(device_section());
  all["damping"] = section_schema(damping_section());
  all["compare"] = section_schema(compare_section());
  all["limits"] = section_schema(limits_section());
  all["exact"] = choice_schema(exact_kinds(options));
  all["expectation"] = section_schema(expectation_section());
  all["expectation"]["anyOf"] =
      Json::array({{{"required", {"at_least"}}}, {{"required", {"at_most"}}}, {{"required", {"equals"}}}});
  const auto particle_outputs = particle_output_schemas();
  for (const auto& [name, schema] : particle_outputs.items()) all[name] = schema;
  all["expectations"] = list_of(reference("expectation"));
  all["recorded_bodies"] = {{"anyOf", Json::array({{{"type", "boolean"}}, list_of({{"type", "string"}})})}};
  all["groups"] = list_of(section_schema(group_section()));
  all["probes"] = list_of(section_schema(probe_section(options)));
  return all;
}

}  // namespace

nlohmann::ordered_json json_schema(const ComponentLookup& components, const ReadOptions& options) {
  Json schema = {{"$schema", "https://json-schema.org/draft/2020-12/schema"}, {"title", "MPM Sandbox experiment"}};
  schema.update(section_schema(experiment_section(options)));
  schema["$defs"] = definitions(components, options);
  return schema;
}

nlohmann::ordered_json json_schema(const Registry& registry, const ReadOptions& options) {
  return json_schema(ComponentLookup(registry), options);
}

nlohmann::ordered_json json_schema(const ComponentLookup& components, const ReadOptions& options,
                                   const std::vector<FileKind>& others) {
  const Json experiment = json_schema(components, options);
  Json keys = section_schema(experiment_section(options));
  for (const auto& [file, solver, lists] : others) {
    const Json type = {{"properties", {{"type", {{"const", solver.name}}}}}, {"required", {"type"}}};
    const Json condition = {{"properties", {{"solver", type}}}, {"required", {"solver"}}};
    keys = {{"if", condition}, {"then", section_schema(file)}, {"else", keys}};
  }
  Json schema = {{"$schema", experiment["$schema"]}, {"title", experiment["title"]}};
  schema.update(keys);
  schema["$defs"] = experiment["$defs"];
  for (const FileKind& kind : others)
    for (const auto& [name, section] : kind.lists) schema["$defs"][name] = list_of(section_schema(section));
  return schema;
}

}  // namespace mpm
