#pragma once
// A study as read from its file: which experiments it makes, what it measures of them and what it draws.

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "experiment/expression.hpp"

namespace mpm {
struct Node;
}

namespace mpm::study {

/// One value of an axis.
struct Choice {
  std::string label;                   ///< name in tables, legends and names of folders
  std::optional<double> number;        ///< its place on the axis of a figure, in the axis' unit
  std::vector<std::string> overrides;  ///< "/json/pointer=value", applied to the base experiment
};

struct Axis {
  std::string name;  ///< what figures and study.json call it: the pointer, unless it has a name
  std::string label, unit;
  std::vector<Choice> choices;        ///< at least one, each label once
  std::vector<std::string> pointers;  ///< pointers of all that its choices set

  /// Whether every choice has a number.
  bool is_numeric() const;
  /// The axis' name with its unit: "cell size (m)".
  std::string title() const;
};

/// A number of summary.json, x, or a formula of it and of what the axes set.
struct Measure {
  std::string name;
  std::string path;  ///< JSON pointer or dotted path into summary.json
  std::string label, unit;
  std::string formula;  ///< formula over scope_of_measures; empty: x itself

  std::string title() const;
};

/// A condition on a number of summary.json; one that is missing or not finite does not hold.
struct Bound {
  std::string path;
  std::optional<double> at_least, at_most;
};

/// The search for the last stable value between one that is stable and one that is not.
struct Bisection {
  std::string pointer;
  std::string label, unit;
  double from = 0, to = 0;  ///< end that should be stable and end that should not, both over `scale`
  double relative_tolerance = 0.02;
  double scale = 1;  ///< the experiment gets value * scale
  std::vector<Bound> stable_while;
  std::vector<std::string> overrides;  ///< set in the runs of the search alone; the measures are then of one run more

  std::string title() const;
};

enum class FigureType { convergence, pareto, heat_map, small_multiples, curves, outcome_map };

/// How a cell of a heat map is made of the runs that share it.
enum class Take { smallest, largest, bounded };

/// A figure to be drawn; names are those of axes and measures, checked when read.
struct FigureRequest {
  FigureType type = FigureType::convergence;
  std::string name;  ///< name of its files
  std::string title;
  std::string x, y, panels, series;  ///< names of axes; empty: not given
  std::string value;                 ///< name of a measure; empty: the study's error
  std::string over;                  ///< axis whose runs share a cell of a heat map; empty: none
  Take take = Take::smallest;        ///< the smallest or largest value of theirs, or how many are bounded
  std::vector<std::string> costs;    ///< measures of a Pareto figure
  std::string column;                ///< column of metrics.csv, for curves
  std::string exact, exact_label;    ///< formula of x that is drawn beside the measured values; empty: none
  bool log_x = false, log_y = false;
  bool over_initial = false;                                            ///< curves are divided by first values
  int every = 1;                                                        ///< rows of a curve from one point to the next
  std::vector<std::pair<std::string, std::vector<std::string>>> where;  ///< axes and the labels that are shown
};

struct Study {
  std::filesystem::path file, base;
  std::string title, description;
  std::string note;                    ///< what must be known before a number is taken; head of report and advice
  std::vector<std::string> overrides;  ///< from "limits", from "set", then from the command line
  std::vector<Axis> axes;
  std::optional<Bisection> bisection;
  std::vector<Measure> measures;              ///< the file's, then the built-in ones
  std::size_t own_measures = 0;               ///< how many of them are the file's
  std::map<std::string, std::string> places;  ///< "FILE:LINE:COLUMN" by override, of a bisection by its pointer
  std::string error, cost;                    ///< names of measures; `error` may be empty
  std::vector<FigureRequest> figures;

  const Axis* axis(const std::string& name) const;        ///< null when there is none
  const Measure* measure(const std::string& name) const;  ///< null when there is none
  std::size_t axis_index(const std::string& name) const;  ///< axes.size() when there is none
};

/// What the formula of a measure may name: x, its value, and the number of each axis that has a free name and numbers alone, of
/// the choices of a run, as indices into the axes'.
ExpressionScope scope_of_measures(const Study& study, const std::vector<std::size_t>& choices);

/// The label with its unit, "label (unit)", or the label alone.
std::string with_unit(const std::string& label, const std::string& unit);

/// Name of the measure that a bisection finds.
inline constexpr const char* critical_measure = "critical";

/// Whether a file's JSON is meant as a study: an object with "axes", or with "base" and without "bodies".
bool is_study(const Node& root);

/// Reads and checks a study; `more_overrides` are those of the command line. Throws InputError with every mistake.
Study read_study(const std::filesystem::path& file, const std::vector<std::string>& more_overrides = {});
/// Reads a study from text; `file` names it in messages and is what `base` is relative to.
Study read_study_text(std::string_view text, const std::filesystem::path& file,
                      const std::vector<std::string>& more_overrides = {});

/// One experiment of the study.
struct Combination {
  std::string name;                    ///< name of its folder, unique in the study
  std::vector<std::size_t> choices;    ///< index into each axis' choices
  std::vector<std::string> overrides;  ///< the study's, then each axis', in order
};

/// All combinations, the first axis slowest.
std::vector<Combination> expand(const Study& study);

}  // namespace mpm::study
