#include "mpm/run_figures.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>

#include "backends/make_backend.hpp"
#include "drive/read_drive.hpp"
#include "experiment/diagnostics.hpp"
#include "experiment/parameter.hpp"
#include "mpm/cli.hpp"
#include "output/report.hpp"
#include "output/run_folder.hpp"
#include "render/plot.hpp"
#include "run/record_names.hpp"
#include "run/start_checks.hpp"
#include "support/files.hpp"

namespace mpm::app {
namespace {

using render::Plot;
using render::Series;
using support::Table;

/// The unit of a recorded column, with its brackets: " (J/m)".
std::string unit_of(const Table& table, const std::string& name) {
  for (const std::string& header : table.header)
    if (header.starts_with(name + " (")) return header.substr(name.size());
  return "";
}

std::vector<double> column(const Table& table, const std::string& name, double factor = 1) {
  const auto* values = table.find(name);
  if (!values) throw std::runtime_error("metrics.csv has no column \"" + name + "\"");
  std::vector<double> scaled(*values);
  for (double& value : scaled) value *= factor;
  return scaled;
}

std::vector<std::string> names_without_units(const Table& table) {
  std::vector<std::string> names = table.header;
  for (std::string& name : names) name = name.substr(0, name.find(" ("));
  return names;
}

void add(Plot& plot, const Table& table, const std::string& name, const std::string& label, double factor = 1) {
  if (table.find(name)) plot.series.push_back({label, column(table, "time"), column(table, name, factor)});
}

Plot plot_of(const Table& table, const RunLabel& label, const std::string& title, const std::string& quantity,
             const std::string& like) {
  Plot plot;
  plot.title = title;
  plot.x_label = "time t (s)";
  plot.y_label = quantity + unit_of(table, like);
  plot.footnote = label.footnote;
  return plot;
}

void draw_energy(const Table& table, const RunLabel& label, const std::filesystem::path& stem) {
  Plot plot = plot_of(table, label, "Energy: " + label.title, "energy E", "total energy");
  add(plot, table, "total energy", "total");
  add(plot, table, "kinetic energy", "kinetic");
  add(plot, table, "strain energy", "strain");
  const auto gravitational = column(table, "gravitational energy");
  if (std::any_of(gravitational.begin(), gravitational.end(), [](double e) { return e != 0; }))
    add(plot, table, "gravitational energy", "gravitational");
  render::write_figure(plot, stem);
}

/// The columns of a ledger and what they are called.
using Causes = std::initializer_list<std::pair<const char*, const char*>>;

render::StackedPlot ledger_of(const Table& table, const RunLabel& label, const std::string& title,
                              const std::string& quantity, const Causes& causes) {
  render::StackedPlot plot;
  plot.title = title + ": " + label.title;
  plot.x_label = "time t (s)";
  plot.y_label = quantity + " given since the start" + unit_of(table, "total energy");
  plot.footnote = label.footnote;
  plot.x = column(table, "time");
  for (const auto& [name, text] : causes) {
    if (!table.find(name)) continue;  // the filter's column is absent in a run without one
    auto values = column(table, name);
    if (std::any_of(values.begin(), values.end(), [](double e) { return e != 0; }))
      plot.areas.push_back({text, plot.x, values});
  }
  return plot;
}

double largest_of(const std::vector<double>& values) {
  double largest = 0;
  for (const double value : values) largest = std::max(largest, std::abs(value));
  return largest;
}

/// Draws the rows of the heat ledger. What mirror images and held nodes make of the heat before a step reaches the
/// particles, or is taken back, in the gather: these rows belong together, with what fixed temperatures add. Without
/// images scatter and gather are rounding.
void draw_heat(const Table& table, const RunLabel& label, const std::filesystem::path& stem) {
  render::StackedPlot plot = ledger_of(table, label, "Where the heat came from", "heat Q",
                                       {{"heat ledger flux", "flux through walls"},
                                        {"heat ledger convection", "convection at walls"},
                                        {"heat ledger boxes", "boxes of nodes"},
                                        {"heat ledger dissipation", "dissipation"}});
  auto walls = column(table, "heat ledger walls");
  const bool fixed = largest_of(walls) > 0;
  if (fixed || largest_of(column(table, "heat ledger images")) > 0) {
    for (const char* name : {"heat ledger images", "heat ledger scatter", "heat ledger gather"}) {
      const auto part = column(table, name);
      for (std::size_t k = 0; k < walls.size(); ++k) walls[k] += part[k];
    }
    plot.areas.push_back({fixed ? "fixed temperatures, mirror images" : "mirror images", plot.x, walls});
  }
  plot.lines.push_back({"residual", plot.x, column(table, "heat ledger residual")});
  render::write_figure(plot, stem);

  Plot held = plot_of(table, label, "Heat held by the particles: " + label.title, "heat Q gained since the start",
                      "heat content");
  for (const auto& [name, text] : {std::pair{"heat content", "sensible"}, std::pair{"latent heat", "latent"}}) {
    auto values = column(table, name);
    const double start = values.front();
    for (double& value : values) value -= start;
    if (std::any_of(values.begin(), values.end(), [](double q) { return q != 0; }))
      held.series.push_back({text, plot.x, values});
  }
  render::write_figure(held, stem.parent_path() / "heat_held");
}

void draw_ledger(const Table& table, const RunLabel& label, const std::filesystem::path& stem) {
  render::StackedPlot plot = ledger_of(table, label, "Where the energy went", "energy",
                                       {{"ledger scatter", "particles to grid"},
                                        {"ledger gather", "grid to particles"},
                                        {"ledger filter", "filter"},
                                        {"ledger boundary", "boundary"},
                                        {"ledger contact", "contact"},
                                        {"ledger body force", "body force"},
                                        {"ledger gravity without potential", "gravity without potential"},
                                        {"ledger damping", "damping"},
                                        {"ledger surface load", "loads on surfaces"},
                                        {"ledger point load", "loads at points"},
                                        {"ledger spring", "springs"},
                                        {"ledger dashpot", "dashpots"},
                                        {"ledger filtered strain", "strain by filtered velocity"},
                                        {"ledger filtered gravity", "rise by filtered velocity"},
                                        {"ledger remapped strain", "strain by remapped velocity"},
                                        {"ledger second moment", "change of the second moment D"}});
  auto dissipated = column(table, "ledger material dissipation", -1);
  if (std::any_of(dissipated.begin(), dissipated.end(), [](double e) { return e != 0; }))
    plot.areas.push_back({"material", plot.x, dissipated});
  plot.lines.push_back({"residual", plot.x, column(table, "ledger residual")});
  render::write_figure(plot, stem);
}

void draw_dissipation(const Table& table, const RunLabel& label, const std::filesystem::path& stem) {
  Plot plot = plot_of(table, label, "Energy dissipated by cause: " + label.title, "energy dissipated since the start",
                      "total energy");
  Series transfer{"transfers", column(table, "time"), column(table, "ledger scatter", -1)};
  const auto gather = column(table, "ledger gather", -1);
  for (std::size_t k = 0; k < gather.size(); ++k) transfer.y[k] += gather[k];
  plot.series.push_back(transfer);
  const auto add_if_any = [&](const char* name, const char* text, double factor) {
    if (!table.find(name)) return;
    const auto values = column(table, name);
    if (std::any_of(values.begin(), values.end(), [](double e) { return e != 0; }))
      add(plot, table, name, text, factor);
  };
  add_if_any("ledger filter", "filter", -1);
  add_if_any("ledger filtered strain", "strain by filtered velocity", -1);
  add_if_any("ledger filtered gravity", "rise by filtered velocity", -1);
  add_if_any("ledger remapped strain", "strain by remapped velocity", -1);
  add_if_any("ledger boundary", "boundary", -1);
  add_if_any("ledger contact", "contact", -1);
  add_if_any("ledger damping", "damping", -1);
  const bool takes_back = table.find("ledger friction taken back") != nullptr;
  add_if_any("ledger friction", takes_back ? "friction that particles keep" : "of it friction", 1);
  add_if_any("ledger interface springs", "of it taken up by springs", 1);
  // A cause that is all of it gives the curve its name, and is not drawn twice.
  std::vector<std::string> causes;
  for (double Ledger::*const row : shares_of_dissipation) causes.emplace_back(name_of(row));
  const auto is_all = [&](const std::string& cause) {
    return table.find("ledger " + cause) &&
           column(table, "ledger " + cause) == column(table, "ledger material dissipation");
  };
  const auto only = std::find_if(causes.begin(), causes.end(), is_all);
  add_if_any("ledger material dissipation", only == causes.end() ? "material" : only->c_str(), 1);
  if (only == causes.end())
    for (const std::string& cause : causes) add_if_any(("ledger " + cause).c_str(), ("of it " + cause).c_str(), 1);
  render::write_figure(plot, stem);
}

void draw_momentum(const Table& table, const RunLabel& label, const std::filesystem::path& stem) {
  Plot plot = plot_of(table, label, "Linear momentum: " + label.title, "momentum p", "momentum y");
  for (const char* axis : {"x", "y", "z"}) add(plot, table, std::string("momentum ") + axis, std::string("p ") + axis);
  render::write_figure(plot, stem);
  if (!table.find("angular momentum z")) return;  // an axisymmetric scene has none
  Plot spin = plot_of(table, label, "Angular momentum about the centre of mass: " + label.title, "angular momentum L",
                      "angular momentum z");
  for (const char* axis : {"x", "y", "z"})
    add(spin, table, std::string("angular momentum ") + axis, std::string("L ") + axis);
  render::write_figure(spin, stem.parent_path() / "angular_momentum");
}

void draw_contact(const Table& table, const RunLabel& label, const std::filesystem::path& stem) {
  Plot plot =
      plot_of(table, label, "Contact force on the first body: " + label.title, "contact force F", "contact force x");
  for (const char* axis : {"x", "y", "z"})
    add(plot, table, std::string("contact force ") + axis, std::string("F ") + axis);
  render::write_figure(plot, stem);
  Plot nodes = plot_of(table, label, "Nodes in contact: " + label.title, "number of nodes", "contact nodes");
  add(nodes, table, "contact nodes", "in contact");
  add(nodes, table, "sticking nodes", "sticking");
  add(nodes, table, "slipping nodes", "slipping");
  render::write_figure(nodes, stem.parent_path() / "contact_nodes");
}

/// The size of a vector whose components are columns.
std::vector<double> size_of(const Table& table, const std::string& name) {
  std::vector<double> squares(table.rows());
  for (const char* axis : {" x", " y", " z"})
    if (table.find(name + axis)) {
      const std::vector<double> component = column(table, name + axis);
      for (std::size_t i = 0; i < squares.size(); ++i) squares[i] += component[i] * component[i];
    }
  for (double& value : squares) value = std::sqrt(value);
  return squares;
}

/// Draws the normal force of every pair that has met and the size of the tangential one, and the same of impulses.
void draw_pairs(const Table& table, const RunLabel& label, const std::filesystem::path& stem) {
  const std::string start = "pair ";
  for (const std::string quantity : {"force", "impulse"}) {
    const std::string normal = " normal " + quantity, tangential = " tangential " + quantity;
    Plot plot;
    std::vector<std::string> pairs;
    for (const std::string& name : names_without_units(table))
      if (name.starts_with(start) && name.ends_with(normal)) pairs.push_back(name);
    for (const std::string& name : pairs) {
      if (plot.title.empty())
        plot = plot_of(table, label,
                       (quantity == "force" ? "Contact force of pairs: " : "Contact impulse of pairs: ") + label.title,
                       quantity == "force" ? "force F" : "impulse J", name);
      const std::string pair = name.substr(0, name.size() - normal.size()), bodies = pair.substr(start.size());
      const std::vector<double> across = size_of(table, pair + tangential);
      const bool met = std::max(largest_of(column(table, name)), largest_of(across)) > 0;
      if (!met && !(plot.series.empty() && name == pairs.back())) continue;  // one curve at least, if nothing meets
      add(plot, table, name, bodies + ", normal");
      plot.series.push_back({bodies + ", tangential", column(table, "time"), across});
    }
    render::write_figure(plot, quantity == "force" ? stem : stem.parent_path() / "contact_pair_impulses");
  }
}

/// Draws the components of forces and moments of every support, but for those that are zero all along.
void draw_reactions(const Table& table, const RunLabel& label, const std::filesystem::path& stem) {
  const std::string start = "reaction ", moment = " moment ";
  Plot forces, moments;
  for (const std::string& name : names_without_units(table)) {
    if (!name.starts_with(start)) continue;
    const bool turns = name.find(moment) != std::string::npos;
    Plot& plot = turns ? moments : forces;
    if (plot.title.empty())
      plot = plot_of(table, label,
                     (turns ? "Moments of supports about the origin: " : "Forces of supports: ") + label.title,
                     turns ? "moment M" : "force F", name);
    if (largest_of(column(table, name)) > 0 || plot.series.empty()) add(plot, table, name, name.substr(start.size()));
  }
  render::write_figure(forces, stem);
  if (!moments.title.empty()) render::write_figure(moments, stem.parent_path() / "reaction_moments");
}

void draw_volume(const Table& table, const RunLabel& label, const std::filesystem::path& stem) {
  Plot plot =
      plot_of(table, label, "Compression and expansion: " + label.title, "volume ratio J", "smallest volume ratio");
  add(plot, table, "largest volume ratio", "largest J");
  add(plot, table, "smallest volume ratio", "smallest J");
  render::write_figure(plot, stem);
}

void draw_error(const Table& table, const RunLabel& label, const std::filesystem::path& stem) {
  Plot plot =
      plot_of(table, label, "Position error: " + label.title, "position error |x − x exact|", "position error rms");
  add(plot, table, "position error max", "largest");
  add(plot, table, "position error rms", "root mean square");
  plot.log_y = true;
  render::write_figure(plot, stem);
}

/// A plot of columns over time. The axis has their unit where they share one, else each curve names its own.
Plot columns_over_time(const Table& table, const std::vector<std::string>& names) {
  Plot plot;
  plot.x_label = "time t (s)";
  const std::string unit = unit_of(table, names.front());
  const bool shared = std::all_of(names.begin(), names.end(), [&](auto& name) { return unit_of(table, name) == unit; });
  for (const std::string& name : names) add(plot, table, name, name + (shared ? "" : unit_of(table, name)));
  plot.y_label = (names.size() == 1 ? names.front() : std::string("value")) + (shared ? unit : "");
  return plot;
}

struct FigureKind {
  const char* name;
  const char* needs;   ///< a column of metrics.csv; with a space at its end, what one begins with
  const char* remedy;  ///< what records it
  void (*draw)(const Table&, const RunLabel&, const std::filesystem::path&);
};
constexpr FigureKind kinds[] = {
    {"energy", "total energy", "", draw_energy},
    {"ledger", "ledger residual", "set /output/ledger to true", draw_ledger},
    {"heat", "heat ledger residual", "give the materials \"thermal\" and set /output/ledger to true", draw_heat},
    {"dissipation", "ledger residual", "set /output/ledger to true", draw_dissipation},
    {"momentum", "momentum y", "", draw_momentum},
    {"contact", "contact nodes", "give the experiment a \"contact\"", draw_contact},
    {"contact_pairs", "pair ", "give the experiment a \"contact\" between bodies and set /output/contact_pairs to true",
     draw_pairs},
    {"reactions", "reaction ", "name supports in /output/reactions", draw_reactions},
    {"volume_ratio", "smallest volume ratio", "", draw_volume},
    {"error", "position error rms", "name an exact solution in /compare/exact", draw_error},
};

const FigureKind& figure_kind(const std::string& name) {
  for (const FigureKind& kind : kinds)
    if (name == kind.name) return kind;
  throw std::runtime_error("no figure is called \"" + name + "\"");
}

/// A run folder's name, title and numbers.
struct RecordedRun {
  std::filesystem::path folder;
  std::string title, file;  ///< of the figures; of the folder, which tells runs apart
  Table metrics;
  std::vector<ColumnFigure> column_figures = {};
  std::string experiment_file = "";  ///< as the run was given it
  bool is_material_point = false;
};

/// The figures of columns that a run's experiment asks for and its numbers have.
std::vector<ColumnFigure> column_figures_of(const nlohmann::json& experiment, const Table& metrics) {
  std::vector<ColumnFigure> figures;
  if (!experiment.contains("figures") || !experiment["figures"].is_array()) return figures;
  for (const auto& item : experiment["figures"]) {
    if (!item.is_object()) continue;
    ColumnFigure figure{item.value("name", ""), item.value("title", item.value("name", "")),
                        item.value("columns", std::vector<std::string>()), item.value("log_y", false), ""};
    const bool all = std::all_of(figure.columns.begin(), figure.columns.end(),
                                 [&](const std::string& name) { return metrics.find(name) != nullptr; });
    if (!figure.name.empty() && !figure.columns.empty() && all) figures.push_back(std::move(figure));
  }
  return figures;
}

RecordedRun recorded(const std::filesystem::path& folder) {
  RecordedRun run{output::RunFolder::open(folder).root(), "", "", {}};
  const std::filesystem::path numbers = run.folder / "metrics.csv";
  if (!std::filesystem::is_regular_file(numbers))
    refuse_input(folder.string(), "holds no metrics.csv: the run ended before its first row");
  try {
    run.metrics = support::read_csv(numbers);
  } catch (const std::exception& error) {
    refuse_input(folder.string(), std::string("its numbers cannot be read: ") + error.what());
  }
  if (run.metrics.rows() == 0) refuse_input(numbers.string(), "holds no row: the run ended before its first one");
  std::error_code ignored;
  if (const auto file = run.folder / "experiment.json"; std::filesystem::is_regular_file(file, ignored)) {
    const auto experiment = nlohmann::json::parse(support::read_file(file), nullptr, false);
    if (experiment.is_object() && experiment.contains("title") && experiment["title"].is_string())
      run.title = experiment["title"].get<std::string>();
    if (experiment.is_object()) run.column_figures = column_figures_of(experiment, run.metrics);
    const auto type = nlohmann::json::json_pointer("/solver/type");
    run.is_material_point =
        experiment.is_object() && experiment.contains(type) && experiment[type] == drive::solver_name;
  }
  if (const auto file = run.folder / "manifest.json"; std::filesystem::is_regular_file(file, ignored)) {
    const auto manifest = nlohmann::json::parse(support::read_file(file), nullptr, false);
    if (manifest.is_object()) run.experiment_file = manifest.value("experiment_file", "");
  }
  if (run.title.empty()) run.title = std::filesystem::path(run.experiment_file).stem().string();
  run.file = run.folder.filename().string();
  return run;
}

/// Tells runs of one name in different folders apart by those.
void tell_apart(std::vector<RecordedRun>& runs) {
  std::vector<std::string> names;
  for (const RecordedRun& run : runs) names.push_back(run.file);
  for (RecordedRun& run : runs)
    if (std::count(names.begin(), names.end(), run.folder.filename().string()) > 1)
      run.file = (run.folder.parent_path().filename() / run.folder.filename()).string();
}

/// The slope of y over x, or over ln x, by the differences of rows on both sides; not a number where x does not change.
std::vector<double> slope_of(const std::vector<double>& x, const std::vector<double>& y, bool over_logarithm) {
  std::vector<double> slope;
  for (std::size_t k = 0; k < x.size(); ++k) {
    std::size_t a = k > 0 ? k - 1 : k, b = std::min(k + 1, x.size() - 1);
    if ((x[b] - x[k]) * (x[k] - x[a]) < 0) a = k;  // x turns back here: the slope is that of the way that begins
    slope.push_back((y[b] - y[a]) / (over_logarithm ? std::log(x[b] / x[a]) : x[b] - x[a]));
  }
  return slope;
}

/// Draws one curve a run and column.
void draw_overlay(const std::vector<RecordedRun>& runs, Plot plot, const std::string& x,
                  const std::vector<std::string>& columns, const std::vector<std::string>& labels,
                  const std::filesystem::path& stem, bool slope = false) {
  for (std::size_t k = 0; k < runs.size(); ++k)
    for (const std::string& y : columns) {
      const std::string run = k < labels.size() ? labels[k] : runs[k].file;
      const std::string label = columns.size() == 1 ? run : runs.size() == 1 && labels.empty() ? y : run + ", " + y;
      const std::vector<double> along = column(runs[k].metrics, x), values = column(runs[k].metrics, y);
      plot.series.push_back({label, along, slope ? slope_of(along, values, plot.log_x) : values});
    }
  for (const RecordedRun& run : runs) plot.footnote += (plot.footnote.empty() ? "runs " : ", ") + run.file;
  render::write_figure(plot, stem);
}

Section specification_section() {
  using Type = ParameterType;
  return {"specification",
          "a figure specification",
          {
              parameter("title", Type::string, "", "Title; default the name of y."),
              parameter("x", Type::string, "", "Column of metrics.csv.").standard("time"),
              parameter("y", Type::string, "", "Column of metrics.csv; or \"columns\"."),
              parameter("columns", Type::names, "", "Several columns of metrics.csv, a curve each of every run."),
              parameter("x_label", Type::string, "", "Default: the column and its unit."),
              parameter("y_label", Type::string, "", "Default: the column and its unit."),
              parameter("log_x", Type::boolean, "", "Logarithmic axis.").standard(false),
              parameter("log_y", Type::boolean, "", "Logarithmic axis.").standard(false),
              parameter("linear_within", Type::number, "any",
                        "Of log_y: y has both signs, and its axis is linear within this value on both sides of zero.")
                  .above(0),
              parameter("slope", Type::boolean, "",
                        "Draws the slope of y over x between rows in place of y, over ln x where x is logarithmic.")
                  .standard(false),
              parameter("marks", Type::nested, "", "a list of places along x, {\"at\": number, \"label\": text}"),
              parameter("labels", Type::names, "", "One a run, in the order of the command line."),
          }};
}

Section mark_section() {
  using Type = ParameterType;
  return {"mark",
          "a place along x",
          {parameter("at", Type::number, "any", "Where it is, in the unit of x.").needed(),
           parameter("label", Type::string, "", "Its name, beside the upper end of its line.").needed()}};
}

std::vector<render::PlaceMark> read_marks(const Fields& fields, ReadContext& context) {
  std::vector<render::PlaceMark> marks;
  if (!fields.given("marks")) return marks;
  const Node& list = *fields.node("marks");
  if (list.type != Node::Type::array) {
    context.problem(list, "expected a list of places {\"at\": number, \"label\": text}");
    return marks;
  }
  for (const Node& item : list.items) {
    const Fields mark(&item, mark_section(), context);
    if (mark.valid("label") && mark.text("label").empty()) context.problem(mark.place("label"), "the name is empty");
    marks.push_back({mark.number("at"), mark.text("label")});
  }
  return marks;
}

/// What `mpm figure --spec` draws, checked against the runs.
struct Specification {
  Plot plot;
  std::string x;
  std::vector<std::string> columns, labels;
  bool slope = false;
};

Specification read_specification(const std::filesystem::path& file, const std::vector<RecordedRun>& runs) {
  const Node root = read_located(file);
  ReadContext context;
  context.file = file.string();
  const Fields fields(&root, specification_section(), context);
  const auto check = [&](const Node& place, const std::string& name) {
    for (const RecordedRun& run : runs) {
      if (run.metrics.find(name)) continue;
      const auto names = names_without_units(run.metrics);
      context.problem(place, "run " + run.folder.string() + " has no column " + in_quotes(name) +
                                 suggestion(name, names, "it has " + quoted_list(names)));
    }
  };
  for (const char* key : {"x", "y"})
    if (fields.valid(key) && (key[0] == 'x' || fields.given(key))) check(fields.place(key), fields.text(key));
  for (std::size_t k = 0; k < fields.names("columns").size(); ++k)
    check(fields.node("columns")->items[k], fields.names("columns")[k]);
  if (!fields.given("y") && !fields.given("columns"))
    context.problem(root.at, "/y", "missing key; or give \"columns\", a list of them");
  if (fields.given("y") && fields.given("columns"))
    context.problem(*fields.node("columns"), "give \"y\", one column, or \"columns\", a list of them");
  if (fields.given("columns") && fields.valid("columns") && fields.names("columns").empty())
    context.problem(*fields.node("columns"), "the list is empty");
  const std::size_t labels = fields.names("labels").size();
  if (fields.valid("labels") && labels > 0 && labels != runs.size())
    context.problem(fields.place("labels"),
                    std::to_string(labels) + " labels for " + std::to_string(runs.size()) + " runs; give one a run");
  for (const RecordedRun& run : runs)
    if (fields.boolean("slope") && run.metrics.columns.front().size() < 2)
      context.problem(fields.place("slope"),
                      "run " + run.folder.string() + " has one row of numbers; a slope needs two");
  if (fields.given("linear_within") && !fields.boolean("log_y"))
    context.problem(fields.place("linear_within"), "belongs to \"log_y\": true");
  const std::vector<render::PlaceMark> marks = read_marks(fields, context);
  if (!context.problems.empty()) throw InputError(std::move(context.problems));

  const auto text_or = [&](const char* key, const std::string& standard) {
    return fields.given(key) ? fields.text(key) : standard;
  };
  Specification read{{}, fields.text("x"), fields.names("columns"), fields.names("labels")};
  if (fields.given("y")) read.columns = {fields.text("y")};
  const Table& first = runs.front().metrics;
  read.plot.title = text_or("title", read.columns.front());
  read.plot.x_label = text_or("x_label", read.x + unit_of(first, read.x));
  read.plot.y_label = text_or("y_label", columns_over_time(first, read.columns).y_label);
  read.plot.log_x = fields.boolean("log_x");
  read.plot.log_y = fields.boolean("log_y");
  if (fields.given("linear_within")) read.plot.linear_within = fields.number("linear_within");
  read.plot.marks = marks;
  read.slope = fields.boolean("slope");
  if (read.slope && !fields.given("y_label")) read.plot.y_label = "slope of " + read.columns.front();
  return read;
}

}  // namespace

std::vector<std::string> figure_names() {
  std::vector<std::string> names;
  for (const FigureKind& kind : kinds) names.emplace_back(kind.name);
  return names;
}

std::string missing_for(const std::string& name, const Table& metrics) {
  const FigureKind& kind = figure_kind(name);
  const std::string_view needs = kind.needs;
  const bool recorded = needs.ends_with(' ') ? std::any_of(metrics.header.begin(), metrics.header.end(),
                                                           [&](const std::string& h) { return h.starts_with(needs); })
                                             : metrics.find(needs) != nullptr;
  if (recorded) return "";
  return "figure \"" + name + "\" needs \"" + kind.needs + "\", which the run does not record: " + kind.remedy;
}

void draw_figures(const std::vector<std::string>& names, const Table& metrics, const RunLabel& label,
                  const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  for (const std::string& name : names) {
    const std::string missing = missing_for(name, metrics);
    if (!missing.empty()) throw std::runtime_error(missing);
    figure_kind(name).draw(metrics, label, folder / name);
  }
}

void draw_figures(const std::vector<ColumnFigure>& figures, const Table& metrics, const RunLabel& label,
                  const std::filesystem::path& folder) {
  if (figures.empty()) return;
  std::filesystem::create_directories(folder);
  for (const ColumnFigure& figure : figures) {
    Plot plot = columns_over_time(metrics, figure.columns);
    plot.title = figure.title + (label.title.empty() ? "" : ": " + label.title);
    plot.footnote = label.footnote;
    plot.log_y = figure.log_y;
    render::write_figure(plot, folder / figure.name);
  }
}

void refuse_unknown_records(const Experiment& experiment) {
  const bool any = !experiment.expectations.empty() || !experiment.figures.empty() ||
                   !experiment.column_figures.empty() || !experiment.output.probes.empty() ||
                   !experiment.output.groups.empty();
  if (!any) return;
  const RecordNames names = record_names(experiment, unstepped_backend_factory());
  std::vector<Problem> problems = unknown_records(experiment, names);
  Table columns;
  columns.header = names.columns;
  columns.columns.resize(columns.header.size());
  const auto& items = experiment.resolved["figures"];
  for (const std::string& name : experiment.figures)
    if (const std::string missing = missing_for(name, columns); !missing.empty())
      problems.push_back(problem_at(
          experiment, "/figures/" + std::to_string(std::find(items.begin(), items.end(), name) - items.begin()),
          missing));
  if (problems.empty()) return;
  std::stable_sort(problems.begin(), problems.end(), [](const Problem& a, const Problem& b) {
    return std::pair(a.line, a.column) < std::pair(b.line, b.column);
  });
  throw InputError(std::move(problems));
}

int figure(const std::vector<std::filesystem::path>& folders, const std::filesystem::path& specification,
           const std::filesystem::path& out) {
  std::vector<RecordedRun> runs;
  for (const auto& folder : folders) runs.push_back(recorded(folder));
  tell_apart(runs);
  std::optional<Specification> specified;
  if (!specification.empty()) specified = read_specification(specification, runs);
  for (const RecordedRun& run : runs)
    if (run.is_material_point && !specified)
      refuse_input(
          run.folder,
          "a material point's run has its figures since it ran, in figures/; others are drawn with --spec FILE, which "
          "names columns of metrics.csv, such as {\"x\": \"deformation gradient xx\", \"y\": \"stress xx\"}");
  const std::filesystem::path target = !out.empty()       ? out
                                       : runs.size() == 1 ? runs.front().folder / "figures"
                                                          : std::filesystem::path("runs/overlay");
  if (std::filesystem::exists(target) && !std::filesystem::is_directory(target))
    refuse_input(target.string(), "is a file; choose a folder with --out");
  std::filesystem::create_directories(target);
  if (specified) {
    draw_overlay(runs, specified->plot, specified->x, specified->columns, specified->labels,
                 target / specification.stem(), specified->slope);
  } else if (runs.size() == 1) {
    std::vector<std::string> names;
    for (const std::string& name : figure_names())
      if (missing_for(name, runs.front().metrics).empty()) names.push_back(name);
    const RunLabel label{runs.front().title, runs.front().experiment_file};
    draw_figures(names, runs.front().metrics, label, target);
    draw_figures(runs.front().column_figures, runs.front().metrics, label, target);
  } else {
    const std::pair<const char*, const char*> overlays[] = {
        {"total energy", "Total energy"},
        {"kinetic energy", "Kinetic energy"},
        {"strain energy", "Strain energy"},
        {"angular momentum z", "Angular momentum about the centre of mass"},
        {"position error rms", "Position error, root mean square"}};
    for (const auto& [name, title] : overlays) {
      if (!std::all_of(runs.begin(), runs.end(),
                       [&, n = name](const RecordedRun& run) { return run.metrics.find(n) != nullptr; }))
        continue;
      Plot plot;
      plot.title = title;
      plot.x_label = "time t (s)";
      plot.y_label = std::string(name) + unit_of(runs.front().metrics, name);
      std::string stem = name;
      std::replace(stem.begin(), stem.end(), ' ', '_');
      draw_overlay(runs, plot, "time", {name}, {}, target / stem);
    }
  }
  if (out.empty() && runs.size() == 1) output::write_report(runs.front().folder);
  std::cout << "figures in " << target.string() << "\n";
  return done;
}

}  // namespace mpm::app
