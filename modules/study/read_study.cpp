#include <algorithm>
#include <cmath>

#include "experiment/expression.hpp"
#include "experiment/parameter.hpp"
#include "experiment/sections.hpp"
#include "study/axis_reader.hpp"
#include "study/study.hpp"

namespace mpm::study {
namespace {

using Type = ParameterType;

constexpr std::size_t most_combinations = 100000;

ParameterSpec nested(const std::string& name, std::string doc) {
  return parameter(name, Type::nested, "", std::move(doc)).defined_as(name);
}

Section study_section() {
  return {"study",
          "a study",
          {
              parameter("title", Type::string, "", "One line that heads report and figures.").standard(""),
              parameter("description", Type::string, "", "What the study shows.").standard(""),
              parameter("note", Type::string, "", "What must be known before a number is taken; head of advice.")
                  .standard(""),
              parameter("base", Type::string, "", "Experiment file, relative to the study's folder.").needed(),
              nested("set", "an object of values by JSON pointer"),
              nested("axes", "an object of axes by JSON pointer, or a list of axes").needed(),
              nested("bisect", "a bisection"),
              nested("measure", "an object of measures by name"),
              parameter("error", Type::string, "", "Name of the measure that is the error."),
              parameter("cost", Type::string, "", "Name of the measure that is the cost.").standard("seconds"),
              nested("limits", "what finished runs must respect"),
              nested("figures", "a list of figures"),
          }};
}

Section measure_section() {
  return {
      "measure",
      "a measure",
      {parameter("value", Type::string, "", "JSON pointer or dotted path into summary.json.").needed(),
       parameter("label", Type::string, "", "Quantity on figures and in tables; default the name."),
       parameter("unit", Type::string, "", "Unit of the result."),
       parameter("formula", Type::string, "", "Formula of x, the value, and of the axes' numbers by their names.")}};
}

Section bisection_section() {
  return {"bisection",
          "a bisection",
          {parameter("pointer", Type::string, "", "JSON pointer that is bisected.").needed(),
           parameter("from", Type::number, "any", "End that is expected to be stable.").needed(),
           parameter("to", Type::number, "any", "End that is expected not to be.").needed(),
           parameter("relative_tolerance", Type::number, "", "Width of the last bracket over its stable end.")
               .above(0)
               .below(1)
               .standard(0.02),
           parameter("scale", Type::number, "any", "Numbers are multiplied by it before they are set.").standard(1),
           parameter("label", Type::string, "", "Quantity on figures and in tables."),
           parameter("unit", Type::string, "", "Unit of the numbers as figures show them."),
           nested("stable_while", "a list of conditions on summary.json"),
           nested("set", "an object of values by JSON pointer")}};
}

Section bound_section() {
  return {"condition",
          "a condition",
          {parameter("value", Type::string, "", "JSON pointer or dotted path into summary.json.").needed(),
           parameter("at_least", Type::number, "any", "Lower bound."),
           parameter("at_most", Type::number, "any", "Upper bound.")}};
}

ParameterSpec where_key() {
  return nested("where", "an object of lists of labels by axis");
}

std::vector<Section> figure_kinds() {
  const auto text = [](const char* name, const char* doc) { return parameter(name, Type::string, "", doc); };
  const auto flag = [](const char* name) {
    return parameter(name, Type::boolean, "", "Logarithmic axis.").standard(false);
  };
  const ParameterSpec name = text("name", "Of its files."), title = text("title", "Default: from what is shown.");
  const ParameterSpec value = text("value", "Measure; default the study's error.");
  const ParameterSpec panels = text("panels", "Axis with a panel for each value.");
  const ParameterSpec x = text("x", "Axis with numbers.").needed(), where = where_key();
  return {
      {"convergence", "error over resolution", {name, title, x, value, panels, where}, true},
      {"pareto",
       "error against cost",
       {name, title, value,
        parameter("costs", Type::names, "", "Measures; default the cost, particle-steps and flops."),
        text("series", "Axis whose values have colours of their own."), panels, where},
       true},
      {"heat_map",
       "a table of numbers as colours",
       {name, title, text("x", "Axis of the columns.").needed(), text("y", "Axis of the rows.").needed(), value,
        text("over", "Axis whose runs share a cell."),
        parameter("take", Type::choice, "", "What a cell takes of them.")
            .of({"smallest", "largest", "bounded"})
            .standard("smallest"),
        flag("log"), where},
       true},
      {"small_multiples",
       "a panel for each value of an axis",
       {name, title, x, value, text("panels", "Axis with a panel for each value.").needed(), flag("log_x"),
        flag("log_y"), text("exact", "Formula of x, drawn in every panel."), text("exact_label", "Its name."), where},
       true},
      {"curves",
       "recorded curves of the runs",
       {name, title, text("column", "Column of metrics.csv.").needed(), panels, flag("log_y"),
        parameter("over_initial", Type::boolean, "", "Over its first value.").standard(false),
        parameter("every", Type::integer, "", "Rows from one point to the next.").from(1).to(1e9).standard(1), where},
       true},
      {"outcome_map", "what became of the runs", {name, title, x, flag("log_x"), where}, true},
  };
}

constexpr std::pair<const char*, FigureType> figure_types[] = {
    {"convergence", FigureType::convergence}, {"pareto", FigureType::pareto},
    {"heat_map", FigureType::heat_map},       {"small_multiples", FigureType::small_multiples},
    {"curves", FigureType::curves},           {"outcome_map", FigureType::outcome_map}};

class StudyReader {
 public:
  StudyReader(const Node& root, const std::filesystem::path& file) : root_(root) {
    context_.file = file.string();
    study_.file = file;
  }

  Study read(const std::vector<std::string>& more_overrides) {
    const Fields fields(&root_, study_section(), context_);
    study_.title = fields.text("title").empty() ? study_.file.stem().string() : fields.text("title");
    study_.description = fields.text("description");
    study_.note = fields.text("note");
    study_.base = study_.file.parent_path() / fields.text("base");
    if (fields.given("axes")) study_.axes = read_axes(*fields.node("axes"), context_);
    read_overrides(fields, more_overrides);
    read_bisection(fields.node("bisect"));
    read_measures(fields.node("measure"));
    study_.error = known_measure(fields, "error");
    study_.cost = known_measure(fields, "cost");
    read_limits(fields.node("limits"));
    read_figures(fields.node("figures"));
    refuse_too_many(fields);
    if (!context_.problems.empty()) throw InputError(std::move(context_.problems));
    study_.places = std::move(context_.places);
    return std::move(study_);
  }

 private:
  void read_overrides(const Fields& fields, const std::vector<std::string>& more) {
    std::vector<std::string> pointers;
    if (fields.given("set")) study_.overrides = read_set(*fields.node("set"), context_, pointers);
    for (const std::string& pointer : pointers) refuse_overwritten(pointer, *fields.node("set"), "");
    for (const std::string& text : more) {
      const std::string pointer = text.substr(0, text.find('='));
      Node place;
      place.at.option = "--set";
      place.pointer = pointer;
      refuse_overwritten(pointer, place, "; change it in the study file");
      study_.overrides.push_back(text);
    }
  }

  /// Refuses a place that an axis sets too: what is set for all runs comes before the axes, which would undo it.
  void refuse_overwritten(const std::string& pointer, const Node& at, const std::string& remedy) {
    for (const Axis& axis : study_.axes)
      for (const std::string& later : axis.pointers)
        if (overwrites(later, pointer))
          context_.problem(at, pointer + " is overwritten by the axis " + in_quotes(axis.name) + remedy);
  }

  void read_bisection(const Node* node) {
    if (!node) return;
    const Fields fields(node, bisection_section(), context_);
    Bisection bisection;
    bisection.pointer = fields.text("pointer");
    context_.keep_place(bisection.pointer, *node);
    if (fields.given("pointer") && is_pointer(bisection.pointer, *fields.node("pointer"), context_))
      for (const Axis& axis : study_.axes)
        for (const std::string& pointer : axis.pointers)
          if (overwrites(bisection.pointer, pointer))
            context_.problem(*fields.node("pointer"), "overwrites " + pointer + " of the axis " + in_quotes(axis.name));
    bisection.label = fields.given("label") ? fields.text("label") : word_of(bisection.pointer);
    bisection.unit = fields.text("unit");
    bisection.from = fields.number("from");
    bisection.to = fields.number("to");
    bisection.relative_tolerance = fields.number("relative_tolerance");
    bisection.scale = fields.number("scale");
    if (fields.valid("from") && fields.valid("to")) {
      if (bisection.from == bisection.to) context_.problem(fields.place("to"), "is the same as \"from\"");
      if (bisection.from == 0 || bisection.to == 0 || (bisection.from < 0) != (bisection.to < 0))
        context_.problem(fields.place("from"), "\"from\" and \"to\" must have the same sign and not be 0");
    }
    if (const Node* bounds = fields.node("stable_while")) read_bounds(*bounds, bisection.stable_while);
    if (fields.given("set")) bisection.overrides = read_set_of_search(*fields.node("set"), bisection.pointer);
    study_.bisection = std::move(bisection);
  }

  std::vector<std::string> read_set_of_search(const Node& node, const std::string& bisected) {
    std::vector<std::string> pointers, overrides = read_set(node, context_, pointers);
    for (const std::string& pointer : pointers) {
      refuse_overwritten(pointer, node, "");
      if (overwrites(bisected, pointer) || overwrites(pointer, bisected))
        context_.problem(node, pointer + " is what is bisected");
    }
    return overrides;
  }

  void read_bounds(const Node& list, std::vector<Bound>& bounds) {
    if (list.type != Node::Type::array)
      return context_.problem(list, "expected a list of conditions, got " + describe_value(list));
    for (const Node& item : list.items) {
      const Fields fields(&item, bound_section(), context_);
      Bound bound{fields.text("value"), {}, {}};
      if (fields.given("at_least")) bound.at_least = fields.number("at_least");
      if (fields.given("at_most")) bound.at_most = fields.number("at_most");
      if (item.type == Node::Type::object && !bound.at_least && !bound.at_most)
        context_.problem(item, "demands nothing: give \"at_least\" or \"at_most\"");
      bounds.push_back(std::move(bound));
    }
  }

  void read_measures(const Node* node) {
    std::vector<Measure> built_in{{"seconds", "/performance/stepping_seconds", "time of stepping", "s", ""},
                                  {"particle_steps", "/performance/particle_steps", "particle-steps", "", ""},
                                  {"flops", "/performance/flops", "floating-point operations", "", ""}};
    if (study_.bisection)
      built_in.push_back({critical_measure, "", study_.bisection->label, study_.bisection->unit, ""});
    if (node && node->type != Node::Type::object)
      context_.problem(*node, "expected an object of measures by name, got " + describe_value(*node));
    for (const Member& member : node ? node->members : std::vector<Member>{}) {
      const bool taken = std::any_of(built_in.begin(), built_in.end(),
                                     [&](const Measure& measure) { return measure.name == member.key; });
      if (taken) context_.problem(member.at, member.value.pointer, "this measure is always there; take another name");
      study_.measures.push_back(read_measure(member));
    }
    study_.own_measures = study_.measures.size();
    study_.measures.insert(study_.measures.end(), built_in.begin(), built_in.end());
  }

  Measure read_measure(const Member& member) {
    std::string words = member.key;
    std::replace(words.begin(), words.end(), '_', ' ');
    if (member.value.type == Node::Type::string) return {member.key, member.value.text, words, "", ""};
    const Fields fields(&member.value, measure_section(), context_);
    Measure measure{member.key, fields.text("value"), words, fields.text("unit"), fields.text("formula")};
    if (fields.given("label")) measure.label = fields.text("label");
    if (!fields.given("formula")) return measure;
    const std::vector<std::size_t> first(study_.axes.size(), 0);
    const ExpressionScope scope = scope_of_measures(study_, first);
    std::string unnamed;
    for (const Axis& axis : study_.axes) {
      const auto is_it = [&](const auto& constant) { return constant.first == axis.name; };
      if (std::none_of(scope.constants.begin(), scope.constants.end(), is_it))
        unnamed += (unnamed.empty() ? "; a formula cannot name the axis " : ", ") + in_quotes(axis.name);
    }
    check_formula(fields, "formula", scope, unnamed);
    return measure;
  }

  void check_formula(const Fields& fields, const char* key, const ExpressionScope& scope = {"x", {}},
                     const std::string& more = "") {
    try {
      check_expression(fields.text(key), scope);
    } catch (const ExpressionError& error) {
      context_.problem(*fields.node(key), error.what() + more);
    }
  }

  std::vector<std::string> measure_names() const {
    std::vector<std::string> names;
    for (const Measure& measure : study_.measures) names.push_back(measure.name);
    return names;
  }

  /// The text of a key that names a measure.
  std::string known_measure(const Fields& fields, const char* key) {
    const std::string& name = fields.text(key);
    if (fields.given(key) && fields.valid(key) && !study_.measure(name)) {
      const auto names = measure_names();
      context_.problem(*fields.node(key), "no measure is called " + in_quotes(name) +
                                              suggestion(name, names, "measures: " + quoted_list(names)));
    }
    return name;
  }

  std::string known_axis(const Fields& fields, const char* key, bool with_numbers) {
    const std::string& name = fields.text(key);
    if (!fields.given(key) || !fields.valid(key)) return name;
    const Axis* axis = study_.axis(name);
    if (!axis) {
      unknown_axis(name, *fields.node(key));
    } else if (with_numbers && !axis->is_numeric()) {
      context_.problem(*fields.node(key), "the values of the axis " + in_quotes(name) +
                                              " have no numbers; a named axis gives them as \"value\"");
    }
    return name;
  }

  void unknown_axis(const std::string& name, const Node& at) {
    std::vector<std::string> names;
    for (const Axis& axis : study_.axes) names.push_back(axis.name);
    context_.problem(at,
                     "no axis is called " + in_quotes(name) + suggestion(name, names, "axes: " + quoted_list(names)));
  }

  /// Limits of the study are those of every run, in place of the base's; `set` and the axes come after them.
  void read_limits(const Node* node) {
    if (!node) return;
    const Fields fields(node, limits_section(), context_);
    limits_of(fields, context_);
    refuse_overwritten("/limits", *node, "");
    OrderedJson given = OrderedJson::object();
    for (const Member& member : node->members)
      if (fields.resolved.contains(member.key)) given[member.key] = fields.resolved[member.key];
    study_.overrides.insert(study_.overrides.begin(), "/limits=" + given.dump());
    context_.keep_place(study_.overrides.front(), *node);
  }

  void read_figures(const Node* node) {
    if (!node) return;
    if (node->type != Node::Type::array)
      return context_.problem(*node, "expected a list of figures, got " + describe_value(*node));
    const std::vector<Section> kinds = figure_kinds();
    for (const Node& item : node->items) {
      const Section* kind = choose_kind(item, kinds, "figure", true, context_);
      if (kind) read_figure(item, *kind);
    }
  }

  void read_figure(const Node& item, const Section& kind) {
    // A bare word leaves out what has no default; an empty object gets the message for that.
    Node object;
    object.type = Node::Type::object;
    object.at = item.at;
    object.pointer = item.pointer;
    const Fields fields(item.type == Node::Type::string ? &object : &item, kind, context_);
    const auto has = [&](const char* key) {
      return std::any_of(kind.parameters.begin(), kind.parameters.end(),
                         [&](const ParameterSpec& spec) { return spec.name == key; });
    };
    FigureRequest figure;
    for (const auto& [word, type] : figure_types)
      if (kind.name == word) figure.type = type;
    figure.name = fields.given("name") ? fields.text("name") : unused_name(kind.name);
    if (figure.name.empty() || figure.name.find_first_of("/\\") != std::string::npos || figure.name[0] == '.')
      context_.problem(fields.place("name"), "is the name of a file: no \"/\", not beginning with \".\"");
    figure.title = fields.text("title");
    const bool heat = figure.type == FigureType::heat_map;
    if (has("x")) figure.x = known_axis(fields, "x", !heat);
    if (has("y")) figure.y = known_axis(fields, "y", false);
    if (heat && !figure.x.empty() && figure.x == figure.y)
      context_.problem(fields.place("y"), "is the axis of the columns too");
    if (has("panels")) figure.panels = known_axis(fields, "panels", false);
    if (has("panels") && has("x") && !figure.panels.empty() && figure.panels == figure.x)
      context_.problem(fields.place("panels"), "is the axis of x too");
    if (has("series")) figure.series = known_axis(fields, "series", false);
    if (has("value")) figure.value = known_measure(fields, "value");
    if (has("over")) read_over(fields, figure);
    if (has("value") && figure.value.empty() && figure.take != Take::bounded) figure.value = error_measure(item);
    if (has("costs")) read_costs(fields, figure);
    if (has("column")) figure.column = fields.text("column");
    if (has("exact")) read_exact(fields, figure);
    figure.log_x = (has("log_x") && fields.boolean("log_x")) || (has("log") && fields.boolean("log"));
    figure.log_y = has("log_y") && fields.boolean("log_y");
    figure.over_initial = has("over_initial") && fields.boolean("over_initial");
    if (has("every")) figure.every = fields.integer("every");
    if (const Node* where = fields.node("where")) read_where(*where, figure);
    study_.figures.push_back(std::move(figure));
  }

  std::string error_measure(const Node& at) {
    if (study_.error.empty())
      context_.problem(at, "shows the error: name it with \"error\", or give the figure a \"value\"");
    return study_.error;
  }

  std::string unused_name(const std::string& wanted) const {
    std::string name = wanted;
    for (int copy = 2;; ++copy) {
      const bool taken = std::any_of(study_.figures.begin(), study_.figures.end(),
                                     [&](const FigureRequest& figure) { return figure.name == name; });
      if (!taken) return name;
      name = wanted + "_" + std::to_string(copy);
    }
  }

  void read_exact(const Fields& fields, FigureRequest& figure) {
    figure.exact = fields.text("exact");
    figure.exact_label = fields.given("exact_label") ? fields.text("exact_label") : figure.exact;
    if (fields.given("exact")) check_formula(fields, "exact");
    if (fields.given("exact_label") && !fields.given("exact"))
      context_.problem(*fields.node("exact_label"), "names a formula that is not there: give \"exact\" too");
  }

  void read_over(const Fields& fields, FigureRequest& figure) {
    figure.over = known_axis(fields, "over", false);
    figure.take = static_cast<Take>(fields.choice("take"));
    if (!figure.over.empty() && (figure.over == figure.x || figure.over == figure.y))
      context_.problem(fields.place("over"), "is the axis of the columns or rows too");
    if (fields.given("take") && !fields.given("over"))
      context_.problem(*fields.node("take"), "takes of several runs: name their axis with \"over\"");
  }

  void read_costs(const Fields& fields, FigureRequest& figure) {
    figure.costs = fields.names("costs");
    const auto names = measure_names();
    for (const std::string& name : figure.costs)
      if (!study_.measure(name))
        context_.problem(*fields.node("costs"), "no measure is called " + in_quotes(name) +
                                                    suggestion(name, names, "measures: " + quoted_list(names)));
    if (!figure.costs.empty()) return;
    figure.costs = {study_.cost};
    for (const char* name : {"particle_steps", "flops"})
      if (study_.cost != name) figure.costs.emplace_back(name);
  }

  void read_where(const Node& node, FigureRequest& figure) {
    if (node.type != Node::Type::object)
      return context_.problem(node, "expected an object of lists of labels by axis, got " + describe_value(node));
    for (const Member& member : node.members) {
      const Axis* axis = study_.axis(member.key);
      if (!axis) {
        unknown_axis(member.key, member.value);
        continue;
      }
      if (member.value.type != Node::Type::array || member.value.items.empty()) {
        context_.problem(member.value, "expected a list of labels, got " + describe_value(member.value));
        continue;
      }
      std::vector<std::string> labels, known;
      for (const Choice& choice : axis->choices) known.push_back(choice.label);
      for (const Node& item : member.value.items) {
        const std::string label = item.type == Node::Type::number ? number_text(item.number) : item.text;
        if (std::find(known.begin(), known.end(), label) == known.end())
          context_.problem(item, "the axis has no value " + in_quotes(label) +
                                     suggestion(label, known, "values: " + quoted_list(known)));
        labels.push_back(label);
      }
      figure.where.emplace_back(member.key, labels);
    }
  }

  void refuse_too_many(const Fields& fields) {
    double count = 1;
    for (const Axis& axis : study_.axes) count *= static_cast<double>(axis.choices.size());
    if (count > static_cast<double>(most_combinations))
      context_.problem(fields.place("axes"), "make " + number_text(count) + " combinations; at most " +
                                                 std::to_string(most_combinations) + " fit in a study");
  }

  const Node& root_;
  StudyContext context_;
  Study study_;
};

}  // namespace

bool is_study(const Node& root) {
  return root.find("bodies") == nullptr && (root.find("axes") || root.find("base"));
}

Study read_study_text(std::string_view text, const std::filesystem::path& file,
                      const std::vector<std::string>& more_overrides) {
  const Node root = parse_located(text, file.string());
  return StudyReader(root, file).read(more_overrides);
}

Study read_study(const std::filesystem::path& file, const std::vector<std::string>& more_overrides) {
  const Node root = read_located(file);
  if (root.find("bodies") && !root.find("axes"))
    throw InputError({Problem{file.string(), 1, 1, "",
                              "this is an experiment (it has \"bodies\"), and mpm study takes a study: use `mpm run " +
                                  file.string() + "`"}});
  return StudyReader(root, file).read(more_overrides);
}

}  // namespace mpm::study
