// Bodies, groups, probes and figures that an experiment asks for by name.
#include <algorithm>
#include <cctype>
#include <cmath>

#include "experiment/reader.hpp"
#include "experiment/records.hpp"

namespace mpm {
namespace {

bool is_word(const std::string& text) {
  return !text.empty() && std::all_of(text.begin(), text.end(),
                                      [](char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; });
}

/// The text with _ in place of what a name cannot have.
std::string as_word(std::string text) {
  for (char& c : text)
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  return text;
}

/// Whether any of them has this name already.
template <class Named>
bool taken(const std::vector<Named>& others, const std::string& name) {
  return std::any_of(others.begin(), others.end(), [&](const Named& other) { return other.name == name; });
}

}  // namespace

int ExperimentReader::body_index(const Node& place, const std::string& name) {
  std::vector<std::string> names;
  for (const BodySpecification& body : experiment_.bodies) names.push_back(body.name);
  const auto found = std::find(names.begin(), names.end(), name);
  if (found != names.end()) return static_cast<int>(found - names.begin());
  problem(place, "there is no body " + in_quotes(name) + suggestion(name, names, "bodies: " + quoted_list(names)));
  return -1;
}

OrderedJson ExperimentReader::read_recorded_bodies(const Node& node) {
  std::vector<int>& bodies = experiment_.output.bodies;
  if (node.type == Node::Type::boolean) {
    for (int body = 0; node.boolean && body < static_cast<int>(experiment_.bodies.size()); ++body)
      bodies.push_back(body);
    return node.boolean;
  }
  if (node.type != Node::Type::array) {
    problem(node, "expected true, false or a list of bodies, got " + describe_value(node));
    return {};
  }
  OrderedJson resolved = OrderedJson::array();
  for (const Node& item : node.items) {
    if (item.type != Node::Type::string) {
      problem(item, "expected the name of a body, got " + describe_value(item));
      continue;
    }
    const int body = body_index(item, item.text);
    if (std::find(bodies.begin(), bodies.end(), body) != bodies.end() && body >= 0)
      problem(item, in_quotes(item.text) + " is listed twice");
    bodies.push_back(body);
    resolved.push_back(item.text);
  }
  return resolved;
}

OrderedJson ExperimentReader::read_group(const Node& node) {
  const Fields fields(&node, group_section(), context_);
  OrderedJson resolved = fields.resolved;
  GroupSpecification group;
  group.name = fields.text("name");
  group.pointer = node.pointer;
  if (fields.valid("name")) check_record_name(fields, taken(experiment_.output.groups, group.name), "groups");
  if (fields.given("body") && fields.valid("body")) group.body = body_index(fields.place("body"), fields.text("body"));
  if (const Node* where = fields.node("where")) group.where = read_geometry(*where, context_, resolved["where"]);
  experiment_.output.groups.push_back(std::move(group));
  return resolved;
}

bool ExperimentReader::check_word(const Fields& fields, const char* key) {
  const std::string& name = fields.text(key);
  if (is_word(name)) return true;
  problem(fields.place(key), in_quotes(name) + " is no name here: letters, digits and _ alone" +
                                 (is_word(as_word(name)) ? "; write " + in_quotes(as_word(name)) : ""));
  return false;
}

void ExperimentReader::check_record_name(const Fields& fields, bool is_taken, const char* what) {
  const std::string& name = fields.text("name");
  if (check_word(fields, "name") && is_taken)
    problem(fields.place("name"), std::string("there are two ") + what + " named " + in_quotes(name));
}

OrderedJson ExperimentReader::read_probe(const Node& node) {
  const Fields fields(&node, probe_section(options_), context_);
  OrderedJson resolved = fields.resolved;
  ProbeSpecification probe;
  probe.name = fields.text("name");
  probe.quantities = fields.names("quantities");
  probe.pointer = node.pointer;
  if (fields.valid("name")) check_record_name(fields, taken(experiment_.output.probes, probe.name), "probes");
  if (fields.given("body") && fields.valid("body")) probe.body = body_index(fields.place("body"), fields.text("body"));
  constexpr std::pair<const char*, ProbeKind> kinds[] = {{"nearest", ProbeKind::nearest},
                                                         {"place", ProbeKind::place},
                                                         {"line", ProbeKind::line},
                                                         {"section", ProbeKind::section}};
  int given = 0;
  for (const auto& [key, kind] : kinds)
    if (fields.given(key)) probe.kind = kind, ++given;
  if (given != 1)
    problem(node, given == 0 ? "says no place: give \"nearest\", \"place\", \"line\" or \"section\""
                             : "says more than one place: give one of \"nearest\", \"place\", \"line\", \"section\"");
  else if (probe.quantities.empty() && probe.kind != ProbeKind::section && fields.valid("quantities"))
    problem(node, "records nothing: name \"quantities\"");
  if (probe.kind == ProbeKind::nearest || probe.kind == ProbeKind::place)
    probe.point = fields.vector(probe.kind == ProbeKind::nearest ? "nearest" : "place");
  if (probe.kind == ProbeKind::line) read_line(fields.nested("line"), probe, resolved["line"]);
  if (probe.kind == ProbeKind::section) read_section(fields.nested("section"), probe, resolved["section"]);
  if (grid_good_ && given == 1) check_probe_inside(fields, probe);
  experiment_.output.probes.push_back(std::move(probe));
  return resolved;
}

/// Refuses a probe that never meets a particle: a point outside of the domain, a line or a section that passes it by.
void ExperimentReader::check_probe_inside(const Fields& fields, const ProbeSpecification& probe) {
  const GridSpecification& grid = experiment_.grid;
  const auto inside = [&](const Vector3& point) {
    bool good = true;
    for (int c = 0; c < context_.dimension; ++c) {
      const double slack = 1e-9 * (grid.upper[c] - grid.lower[c]);
      good = good && point[c] >= grid.lower[c] - slack && point[c] <= grid.upper[c] + slack;
    }
    return good;
  };
  const auto refuse = [&](const char* key, const std::string& what) {
    const auto corner = [&](const Vector3& at) {
      std::string text = number_text(at[0]);
      for (int c = 1; c < context_.dimension; ++c) text += ", " + number_text(at[c]);
      return "(" + text + ")";
    };
    problem(fields.place(key), what + " the domain, from " + corner(grid.lower) + " to " + corner(grid.upper) +
                                   " m, where no particle ever is; move it inside, or enlarge /grid/domain");
  };
  switch (probe.kind) {
    case ProbeKind::nearest:
    case ProbeKind::place: {
      const char* const key = probe.kind == ProbeKind::nearest ? "nearest" : "place";
      if (fields.valid(key) && !inside(probe.point)) refuse(key, "the point lies outside of");
      return;
    }
    case ProbeKind::line: {
      bool any = probe.count < 1;
      for (int k = 0; k < probe.count && !any; ++k) {
        Vector3 point{};
        for (int c = 0; c < context_.dimension; ++c)
          point[c] = probe.point[c] + (probe.end[c] - probe.point[c]) * k / std::max(1, probe.count - 1);
        any = inside(point);
      }
      if (!any) refuse("line", "no point of the line lies in");
      return;
    }
    case ProbeKind::section: {
      double least = 0, most = 0;  // the distances from the plane within the domain
      for (int c = 0; c < context_.dimension; ++c) {
        const double low = (grid.lower[c] - probe.point[c]) * probe.normal[c];
        const double high = (grid.upper[c] - probe.point[c]) * probe.normal[c];
        least += std::min(low, high), most += std::max(low, high);
      }
      if (least > 0 || most < 0) refuse("section", "the section does not meet");
    }
  }
}

void ExperimentReader::read_line(const Fields& fields, ProbeSpecification& probe, OrderedJson& resolved) {
  resolved = fields.resolved;
  probe.point = fields.vector("from"), probe.end = fields.vector("to");
  probe.count = fields.integer("count"), probe.profiles = fields.integer("profiles");
  if (fields.valid("from") && fields.valid("to") && probe.point == probe.end)
    problem(fields.place("to"), "the line has no length");
}

void ExperimentReader::read_section(const Fields& fields, ProbeSpecification& probe, OrderedJson& resolved) {
  resolved = fields.resolved;
  probe.point = fields.vector("point"), probe.normal = fields.vector("normal");
  const double length = std::hypot(probe.normal[0], probe.normal[1], probe.normal[2]);
  if (fields.valid("normal") && length == 0) problem(fields.place("normal"), "the normal has no length");
  for (double& component : probe.normal) component /= length;
  if (experiment_.axisymmetric() && fields.valid("normal") && probe.normal[0] != 0)
    problem(fields.place("normal"), "in an axisymmetric scene sections lie across the axis: give [0, 1] or [0, -1]");
}

void ExperimentReader::read_normal_error(const Fields& fields) {
  experiment_.output.normal_error = fields.boolean("normal_error");
  if (!experiment_.output.normal_error) return;
  const auto refuse = [&](const std::string& why) { problem(fields.place("normal_error"), why); };
  if (!experiment_.output.contact_pairs) refuse("its columns are those of pairs: set \"contact_pairs\" to true");
  if (!experiment_.contact)
    refuse("there are no such normals without \"contact\"; those of rigid bodies are exact");
  else if (experiment_.contact->plugin && (experiment_.contact->plugin->contact().traits & MPM_BYPASSES_DETECTION))
    refuse("the contact law \"" + std::string(experiment_.contact->plugin->id()) + "\" has no normals");
  for (const BodySpecification& body : experiment_.bodies)
    if (body.seeding.kind == SeedingKind::points)
      refuse("body " + in_quotes(body.name) + " has particles out of a file, and nobody knows where its boundary is");
  for (int axis = 0; axis < context_.dimension; ++axis)
    if (experiment_.faces[axis][0].type == ConditionType::periodic)
      refuse("bodies are followed as wholes, and a periodic axis may take one apart: remove one of them");
}

void ExperimentReader::read_contact_nodes(const Fields& fields) {
  experiment_.output.contact_nodes = fields.boolean("contact_nodes");
  if (!experiment_.output.contact_nodes) return;
  const auto refuse = [&](const char* why) { problem(fields.place("contact_nodes"), why); };
  if (!experiment_.contact) refuse("there are no such nodes without \"contact\"");
  if (experiment_.output.frames <= 0) refuse("they are shown in frames: give \"frames\"");
}

void ExperimentReader::read_records(const Fields& fields) {
  OrderedJson& resolved = resolved_["output"];
  experiment_.output.contact_pairs = fields.boolean("contact_pairs");
  if (experiment_.output.contact_pairs && !experiment_.contact && experiment_.rigid_bodies.empty())
    problem(fields.place("contact_pairs"), "there are no pairs without \"contact\" or \"rigid_bodies\"");
  read_normal_error(fields);
  read_contact_nodes(fields);
  if (fields.given("bodies")) resolved["bodies"] = read_recorded_bodies(*fields.node("bodies"));
  for (const char* key : {"groups", "probes"}) {
    if (!fields.given(key) || !is_list(*fields.node(key), key, true)) continue;
    resolved[key] = OrderedJson::array();
    for (const Node& item : fields.node(key)->items)
      resolved[key].push_back(key[0] == 'g' ? read_group(item) : read_probe(item));
  }
}

void ExperimentReader::read_column_figures(const Node* node) {
  if (!node || node->type != Node::Type::array) return;
  for (std::size_t k = 0; k < node->items.size(); ++k) {
    const Node& item = node->items[k];
    if (item.type != Node::Type::object) continue;
    const std::vector<Section> kinds{column_figure_section()};
    if (!choose_kind(item, kinds, "figure", false, context_)) continue;
    const Fields fields(&item, kinds.front(), context_);
    ColumnFigure figure{fields.text("name"), "", fields.names("columns"), fields.boolean("log_y"), item.pointer};
    figure.title = fields.given("title") ? fields.text("title") : figure.name;
    const bool is_kind =
        std::find(options_.figures.begin(), options_.figures.end(), figure.name) != options_.figures.end();
    if (fields.valid("name"))
      check_record_name(fields, is_kind || taken(experiment_.column_figures, figure.name), "figures");
    if (fields.valid("columns") && figure.columns.empty()) problem(fields.place("columns"), "the list is empty");
    experiment_.column_figures.push_back(std::move(figure));
    if (k < resolved_["figures"].size()) resolved_["figures"][k] = fields.resolved;
  }
}

}  // namespace mpm
