// A step as a picture: a row an operator, a column a field, a mark where one uses the other; loops and conditions are
// boxes around their operators.

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

#include "plan/plan.hpp"

namespace mpm {
namespace {

constexpr double row_height = 26, column_width = 26, margin = 24, indent = 16, gap = 16;
constexpr double title_height = 52, owners_height = 26, legend_height = 44, legend_width = 300;
constexpr std::size_t longest_reason = 96;

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) result += c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '&' ? "&amp;" : std::string(1, c);
  return result;
}

std::string shortened(const std::string& text, std::size_t length) {
  return text.size() <= length ? text : text.substr(0, length - 1) + "…";
}

/// What a text takes at most, in pixels: a viewer without the font named takes a wider one.
double width_of(const std::string& text, double font_size) {
  return 0.58 * font_size * static_cast<double>(text.size());
}

/// "nodes/heat_capacity" as a person reads it.
std::string spoken(std::string name) {
  name = name.substr(name.find('/') + 1);
  std::replace(name.begin(), name.end(), '_', ' ');
  if (name == "transfer" || name == "material") name += "'s state";
  if (name == "dt") name = "time step";
  return name;
}

class Picture {
 public:
  explicit Picture(const Plan& plan) {
    collect_columns(plan.step);
    for (const Step& child : plan.step.children) add(child, 0);
    lay_out();
  }

  std::string svg(const std::string& title) const {
    const double bottom = top_ + row_height * static_cast<double>(rows_.size());
    const double width = std::max({reasons_ + reasons_width_ + margin, margin + width_of(title, title_size) + margin,
                                   margin + legend_width + margin});
    const double height = bottom + legend_height + margin;
    std::ostringstream out;
    out << "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" << std::ceil(width) << "\" height=\""
        << std::ceil(height)
        << "\" font-family=\"Open Sans, sans-serif\" font-size=\"13\">\n<rect width=\"100%\" height=\"100%\" "
           "fill=\"white\"/>\n<text x=\""
        << margin << "\" y=\"34\" font-size=\"" << title_size << "\">" << escaped(title) << "</text>\n";
    draw_columns(out, bottom);
    for (std::size_t row = 0; row < rows_.size(); ++row) draw(out, rows_[row], y_of(row));
    for (const Box& box : boxes_) draw(out, box);
    draw_legend(out, height - margin);
    out << "</svg>\n";
    return out.str();
  }

 private:
  static constexpr double label_size = 13, reason_size = 12, title_size = 20;

  /// An operator's visit, or the heading of a loop or condition, which marks nothing.
  struct Row {
    std::string label, because;
    int depth = 0;
    bool heading = false;
    std::map<std::string, int> marks;  ///< by field: 1 reads, 2 writes, 4 adds
  };
  struct Box {
    std::size_t first = 0, end = 0;  ///< rows
    int depth = 0;
  };

  /// Fields in groups by who holds them, each in the order of first use.
  void collect_columns(const Step& step) {
    std::map<std::string, std::vector<std::string>> groups;
    for_each_pass_as_a_rule(step, [&](const Pass& pass) {
      for (const Operator& operation : pass.operators)
        for (const FieldNames* names : {&operation.reads, &operation.writes, &operation.adds})
          for (const std::string& name : *names) {
            auto& group = groups[name.substr(0, name.find('/'))];
            if (std::find(group.begin(), group.end(), name) == group.end()) group.push_back(name);
          }
    });
    for (const char* owner : {"particles", "nodes", "step"})
      columns_.insert(columns_.end(), groups[owner].begin(), groups[owner].end());
  }

  void add(const Step& step, int depth) {
    if (step.kind == Step::Kind::pass) return add(step.pass, depth);
    const bool either = step.kind == Step::Kind::when && step.condition == Condition::may_scatter_ahead;
    if (either) return add(step.children.front(), depth);
    const std::size_t first = rows_.size();
    std::string label = step.name();
    if (step.kind == Step::Kind::repeat_until)
      label += " up to " + std::to_string(step.times) + (step.times > 1 ? " times" : " time");
    rows_.push_back({std::move(label), shortened(step.because, longest_reason), depth, true, {}});
    for (const Step& child : step.children) add(child, depth + 1);
    boxes_.push_back({first, rows_.size(), depth});
  }

  void add(const Pass& pass, int depth) {
    std::string label = pass.name();
    if (pass.every_steps > 1) label += " (every " + std::to_string(pass.every_steps) + " steps)";
    Row row{std::move(label), shortened(pass.operators.front().because, longest_reason), depth, false, {}};
    for (const Operator& operation : pass.operators) {
      for (const std::string& name : operation.reads) row.marks[name] |= 1;
      for (const std::string& name : operation.writes) row.marks[name] |= 2;
      for (const std::string& name : operation.adds) row.marks[name] |= 4;
    }
    rows_.push_back(std::move(row));
  }

  /// Every text has the room that the longest of its kind takes.
  void lay_out() {
    double names = 0, deepest = 0;
    for (const std::string& column : columns_) names = std::max(names, width_of(spoken(column), label_size));
    for (const Row& row : rows_) {
      left_ = std::max(left_, margin + indent * row.depth + width_of(row.label, label_size) + gap);
      reasons_width_ = std::max(reasons_width_, width_of(row.because, reason_size));
      deepest = std::max(deepest, indent * row.depth);
    }
    left_ += deepest;  // each box ends an indent within the one around it
    top_ = title_height + owners_height + names + gap;
    right_ = left_ + column_width * static_cast<double>(columns_.size());
    reasons_ = right_ + gap;
  }

  double x_of(std::size_t column) const { return left_ + column_width * (static_cast<double>(column) + 0.5); }
  double y_of(std::size_t row) const { return top_ + row_height * (static_cast<double>(row) + 0.5); }

  void draw(std::ostream& out, const Row& row, double y) const {
    if (!row.heading)
      out << "<line x1=\"" << margin << "\" x2=\"" << right_ << "\" y1=\"" << y + row_height / 2 << "\" y2=\""
          << y + row_height / 2 << "\" stroke=\"#eee\"/>\n";
    out << "<text x=\"" << margin + indent * row.depth << "\" y=\"" << y + 4.5 << '"'
        << (row.heading ? " font-style=\"italic\"" : "") << ">" << escaped(row.label) << "</text>\n<text x=\""
        << reasons_ << "\" y=\"" << y + 4.5 << "\" fill=\"#555\" font-size=\"" << reason_size << "\">"
        << escaped(row.because) << "</text>\n";
    for (std::size_t column = 0; column < columns_.size(); ++column)
      if (const auto uses = row.marks.find(columns_[column]); uses != row.marks.end())
        mark(x_of(column), y, uses->second, out);
  }

  void draw(std::ostream& out, const Box& box) const {
    const double x = margin + indent * box.depth - 6, y = y_of(box.first) - row_height / 2 + 2;
    out << "<rect x=\"" << x << "\" y=\"" << y << "\" width=\"" << left_ - 6 - indent * box.depth - x << "\" height=\""
        << row_height * static_cast<double>(box.end - box.first) - 4 << "\" rx=\"6\" fill=\"none\" stroke=\"#777\"/>\n";
  }

  /// The cross lies below the dot, so that a field which is cleared and then added to shows both.
  static void mark(double x, double y, int uses, std::ostream& out) {
    if (uses & 4)
      out << "<path d=\"M" << x - 7 << ' ' << y << "h14M" << x << ' ' << y - 7
          << "v14\" stroke=\"#009E73\" stroke-width=\"3\"/>\n";
    if (uses & 1)
      out << "<circle cx=\"" << x << "\" cy=\"" << y
          << "\" r=\"8\" fill=\"none\" stroke=\"#0072B2\" stroke-width=\"2\"/>\n";
    if (uses & 2) out << "<circle cx=\"" << x << "\" cy=\"" << y << "\" r=\"4.5\" fill=\"#D55E00\"/>\n";
  }

  void draw_columns(std::ostream& out, double bottom) const {
    std::string owner;
    for (std::size_t column = 0; column < columns_.size(); ++column) {
      const std::string own = columns_[column].substr(0, columns_[column].find('/'));
      const double left = x_of(column) - column_width / 2;
      if (own != owner)
        out << "<text x=\"" << left + 4 << "\" y=\"" << title_height + 12 << "\" font-weight=\"bold\">" << own
            << "</text>\n<line x1=\"" << left << "\" x2=\"" << left << "\" y1=\"" << title_height << "\" y2=\""
            << bottom << "\" stroke=\"#999\"/>\n";
      owner = own;
      out << "<text transform=\"translate(" << x_of(column) + 4 << ' ' << top_ - 8 << ") rotate(-90)\">"
          << escaped(spoken(columns_[column])) << "</text>\n";
    }
  }

  static void draw_legend(std::ostream& out, double y) {
    double x = margin + 8;
    for (const auto& [uses, meaning] : {std::pair{1, "reads"}, std::pair{2, "writes"}, std::pair{4, "adds to"}}) {
      mark(x, y - 4.5, uses, out);
      out << "<text x=\"" << x + 14 << "\" y=\"" << y << "\">" << meaning << "</text>\n";
      x += 100;
    }
  }

  std::vector<std::string> columns_;  ///< fields
  std::vector<Row> rows_;
  std::vector<Box> boxes_;
  double left_ = 0, right_ = 0, top_ = 0;  ///< of the marks
  double reasons_ = 0, reasons_width_ = 0;
};

}  // namespace

std::string Plan::to_svg(const std::string& title) const {
  return Picture(*this).svg(title);
}

}  // namespace mpm
