#include "study/report.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "output/report_parts.hpp"
#include "study/analysis.hpp"
#include "support/files.hpp"

namespace mpm::study {
namespace {

using output::escape_html;
using output::number_html;

/// A table whose cells are HTML already; numbers are set to the right.
class HtmlTable {
 public:
  struct Column {
    std::string title;
    bool is_number = false;
  };
  explicit HtmlTable(std::vector<Column> columns) : columns_(std::move(columns)) {
    html_ = "<div class=\"scroll\"><table><thead><tr>";
    for (const Column& column : columns_) html_ += tag(column, "th") + escape_html(column.title) + "</th>";
    html_ += "</tr></thead><tbody>";
  }
  void row(const std::vector<std::string>& cells) {
    html_ += "<tr>";
    for (std::size_t k = 0; k < cells.size(); ++k) html_ += tag(columns_.at(k), "td") + cells[k] + "</td>";
    html_ += "</tr>\n";
    ++rows_;
  }
  /// The table, or "" without rows.
  std::string html() const { return rows_ == 0 ? "" : html_ + "</tbody></table></div>"; }

 private:
  static std::string tag(const Column& column, const char* name) {
    return std::string("<") + name + (column.is_number ? " class=\"number\">" : ">");
  }
  std::vector<Column> columns_;
  std::string html_;
  std::size_t rows_ = 0;
};

/// A body folded away but complete; "" for an empty body.
std::string folded(const char* title, const std::string& body) {
  return body.empty() ? "" : std::string("<details><summary>") + title + "</summary>" + body + "</details>";
}

std::string number_or_nothing(double value) {
  return std::isfinite(value) ? number_html(value) : "";
}

std::string link_to(const Result& result, const std::string& text) {
  if (result.folder.empty()) return escape_html(text);
  return "<a href=\"" + output::relative_link(result.folder + "/report.html") + "\">" + escape_html(text) + "</a>";
}

std::string banner(const char* kind, const std::string& title, const std::vector<std::string>& lines) {
  std::string html = std::string("<div class=\"banner ") + kind + "\"><strong>" + escape_html(title) + "</strong>";
  if (!lines.empty()) html += "<ul>";
  for (const std::string& line : lines) html += "<li>" + escape_html(line) + "</li>";
  return html + (lines.empty() ? "" : "</ul>") + "</div>\n";
}

std::string outcome(const Results& results, const std::vector<std::string>& troubles) {
  const std::size_t count = results.results.size();
  const std::string all =
      std::to_string(count) + (count == 1 ? " combination: " : " combinations: ") + counted(results.results);
  const auto objected = objections(results);
  std::string html = banner(objected.empty() ? "good" : "bad", all, objected);
  if (results.interrupted) html += banner("warn", "The study was stopped; the same command goes on with it.", {});
  if (!troubles.empty()) html += banner("bad", "Could not be drawn", troubles);
  return html;
}

/// The measures that at least one run has.
std::vector<Measure> measured(const Results& results) {
  std::vector<Measure> some;
  for (const Measure& measure : results.study.measures)
    if (std::any_of(results.results.begin(), results.results.end(),
                    [&](const Result& result) { return std::isfinite(result.value(measure.name)); }))
      some.push_back(measure);
  return some;
}

std::string all_results(const Results& results) {
  const Study& study = results.study;
  const auto measures = measured(results);
  std::vector<HtmlTable::Column> columns;
  for (const Axis& axis : study.axes) columns.push_back({axis.title()});
  columns.push_back({"outcome"});
  for (const Measure& measure : measures) columns.push_back({measure.title(), true});
  if (study.bisection) columns.push_back({"first unstable", true});
  HtmlTable table(columns);
  for (const Result& result : results.results) {
    std::vector<std::string> cells;
    for (std::size_t k = 0; k < study.axes.size(); ++k)
      cells.push_back(escape_html(study.axes[k].choices[result.combination.choices[k]].label));
    std::string outcome = link_to(result, name_of(result.outcome.status));
    if (!result.flags.empty()) outcome += " <span class=\"bad verdict\">flagged</span>";
    cells.push_back(outcome);
    for (const Measure& measure : measures) cells.push_back(number_or_nothing(result.value(measure.name)));
    if (study.bisection) cells.push_back(result.unstable ? number_html(*result.unstable) : "");
    table.row(cells);
  }
  return output::report::section("Results", table.html());
}

std::string reasons(const Results& results) {
  HtmlTable table({{"run"}, {"outcome"}, {"reason"}});
  for (const Result& result : results.results) {
    std::string reason = result.outcome.reason;
    for (const std::string& flag : result.flags) reason += (reason.empty() ? "" : "; ") + flag;
    if (!reason.empty())
      table.row({link_to(result, result.combination.name),
                 escape_html(result.flags.empty() ? name_of(result.outcome.status) : "flagged"), escape_html(reason)});
  }
  return output::report::section("Refused, stopped and flagged", table.html());
}

std::string orders(const Results& results) {
  std::string html;
  for (const FigureRequest& figure : results.study.figures) {
    if (figure.type != FigureType::convergence) continue;
    const Measure& measure = *results.study.measure(figure.value);
    HtmlTable table({{"combination"},
                     {"runs", true},
                     {"order, all", true},
                     {"order, two finest", true},
                     {measure.title() + " at the finest", true}});
    for (const Order& order : observed_orders(results, figure))
      if (order.points > 0)
        table.row({escape_html(order.label), std::to_string(order.points),
                   number_or_nothing(std::round(100 * order.fitted) / 100),
                   number_or_nothing(std::round(100 * order.finest) / 100), number_or_nothing(order.y)});
    html += "<h3>" + escape_html(measure.label + " against " + results.study.axis(figure.x)->label) + "</h3>" +
            table.html();
  }
  return output::report::section("Observed orders", html);
}

std::string fronts(const Results& results) {
  std::string html;
  for (const FigureRequest& figure : results.study.figures) {
    if (figure.type != FigureType::pareto) continue;
    for (const std::string& cost : figure.costs) {
      const auto points = pareto(results, figure, cost, figure.value);
      if (points.empty()) continue;
      const Measure &x = *results.study.measure(cost), &y = *results.study.measure(figure.value);
      HtmlTable front({{"on the front"}, {x.title(), true}, {y.title(), true}});
      HtmlTable rest({{"dominated"}, {"by"}, {x.title(), true}, {y.title(), true}});
      for (const ParetoPoint& point : points) {
        const std::string name = link_to(*point.result, point.result->combination.name);
        if (point.dominated_by)
          rest.row({name, escape_html(point.dominated_by->combination.name), number_html(point.cost),
                    number_html(point.error)});
        else
          front.row({name, number_html(point.cost), number_html(point.error)});
      }
      html += "<h3>" + escape_html(y.label + " against " + x.label) + "</h3>" + front.html() +
              folded("What is dominated, and by what", rest.html());
    }
  }
  return output::report::section("Pareto fronts", html);
}

std::string probes(const Results& results) {
  if (!results.study.bisection) return "";
  const std::string& label = results.study.bisection->title();
  HtmlTable table({{"combination"}, {label, true}, {"stable"}, {"why not"}});
  for (const Result& result : results.results)
    for (const Probe& probe : result.probes)
      table.row({escape_html(result.combination.name), number_html(probe.value), probe.is_stable ? "yes" : "no",
                 escape_html(probe.reason)});
  return output::report::section("Bisection", folded("Every run of the search", table.html()));
}

std::string reproduction(const Results& results, const Json& machine, const std::string& version) {
  Json facts{{"study", results.study.file.filename().string()},
             {"base", results.study.base.filename().string()},
             {"version", version},
             {"machine", machine}};
  std::string html = "<pre>" + escape_html(results.command) + "</pre>" + output::table_html(facts);
  if (!results.study.overrides.empty()) {
    html += "<h3>set for all runs</h3><ul>";
    for (const std::string& text : results.study.overrides) html += "<li><code>" + escape_html(text) + "</code></li>";
    html += "</ul>";
  }
  return output::report::section(
      "How to do it again",
      html +
          "<p class=\"soft\">Numbers: <a href=\"table.csv\">table.csv</a>, <a href=\"study.json\">study.json</a>; each "
          "run has a folder of its own in <code>runs/</code>.</p>");
}

}  // namespace

void write_report(const Results& results, const Json& machine, const std::string& version,
                  const std::vector<std::string>& troubles, const std::filesystem::path& folder) {
  output::report::Run pictures;
  pictures.folder = folder;
  std::string page =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta name=\"color-scheme\" content=\"light dark\">\n<title>";
  page += escape_html(results.study.title) + "</title>\n<style>" + output::report::style() +
          "</style>\n</head>\n<body>\n<main>\n<h1>" + escape_html(results.study.title) + "</h1>\n";
  if (!results.study.description.empty()) page += "<p>" + escape_html(results.study.description) + "</p>\n";
  if (!results.study.note.empty()) page += "<p><strong>" + escape_html(results.study.note) + "</strong></p>\n";
  page += outcome(results, troubles) + output::report::figures(pictures) + orders(results) + fronts(results) +
          all_results(results) + reasons(results) + probes(results) + reproduction(results, machine, version);
  support::write_atomically(folder / "report.html", page + "</main>\n</body>\n</html>\n");
}

}  // namespace mpm::study
