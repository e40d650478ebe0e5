// A step as a picture: a row an operator, a column a field, a mark where one uses the other; loops and conditions are
// boxes around their operators.

#include <algorithm>
#include <map>
#include <sstream>

#include "plan/plan.hpp"

namespace mpm {
namespace {

constexpr double row_height = 26, column_width = 26, left_width = 300, right_width = 620, margin = 24, indent = 16;
constexpr double names_height = 190, title_height = 52, legend_height = 44;

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) result += c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '&' ? "&amp;" : std::string(1, c);
  return result;
}

std::string shortened(const std::string& text, std::size_t length) {
  return text.size() <= length ? text : text.substr(0, length - 1) + "…";
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
  }

  std::string svg(const std::string& title) const {
    const double top = title_height + names_height;
    const double width = 2 * margin + left_width + column_width * static_cast<double>(columns_.size()) + right_width;
    const double height = top + row_height * static_cast<double>(rows_) + legend_height + margin;
    std::ostringstream out;
    out << "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" << width << "\" height=\"" << height
        << "\" font-family=\"Open Sans, sans-serif\" font-size=\"13\">\n<rect width=\"100%\" height=\"100%\" "
           "fill=\"white\"/>\n<text x=\""
        << margin << "\" y=\"34\" font-size=\"20\">" << escaped(title) << "</text>\n";
    draw_columns(out, top);
    out << body_.str();
    draw_legend(out, height - margin);
    out << "</svg>\n";
    return out.str();
  }

 private:
  struct Column {
    std::string name;
    double x = 0;
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
      for (const std::string& name : groups[owner])
        columns_.push_back({name, margin + left_width + column_width * (static_cast<double>(columns_.size()) + 0.5)});
  }

  double x_of(const std::string& name) const {
    for (const Column& column : columns_)
      if (column.name == name) return column.x;
    return 0;
  }
  double y_of(int row) const { return title_height + names_height + row_height * (row + 0.5); }

  void add(const Step& step, int depth) {
    if (step.kind == Step::Kind::pass) return add(step.pass, depth);
    const bool either = step.kind == Step::Kind::when && step.condition == Condition::may_scatter_ahead;
    if (either) return add(step.children.front(), depth);
    const int first = rows_;
    std::string label = step.name();
    if (step.kind == Step::Kind::repeat_until)
      label += " up to " + std::to_string(step.times) + (step.times > 1 ? " times" : " time");
    text(rows_, depth, label, step.because, true);
    ++rows_;
    for (const Step& child : step.children) add(child, depth + 1);
    const double x = margin + indent * depth - 6, y = y_of(first) - row_height / 2 + 2;
    body_ << "<rect x=\"" << x << "\" y=\"" << y << "\" width=\"" << left_width - 6 - 2 * indent * depth
          << "\" height=\"" << row_height * (rows_ - first) - 4 << "\" rx=\"6\" fill=\"none\" stroke=\"#777\"/>\n";
  }

  void add(const Pass& pass, int depth) {
    std::string label = pass.name();
    if (pass.every_steps > 1) label += " (every " + std::to_string(pass.every_steps) + " steps)";
    body_ << "<line x1=\"" << margin << "\" x2=\""
          << margin + left_width + column_width * static_cast<double>(columns_.size()) << "\" y1=\""
          << y_of(rows_) + row_height / 2 << "\" y2=\"" << y_of(rows_) + row_height / 2 << "\" stroke=\"#eee\"/>\n";
    text(rows_, depth, label, pass.operators.front().because, false);
    std::map<std::string, int> marks;  // 1 reads, 2 writes, 4 adds
    for (const Operator& operation : pass.operators) {
      for (const std::string& name : operation.reads) marks[name] |= 1;
      for (const std::string& name : operation.writes) marks[name] |= 2;
      for (const std::string& name : operation.adds) marks[name] |= 4;
    }
    for (const auto& [name, uses] : marks) mark(x_of(name), y_of(rows_), uses, body_);
    ++rows_;
  }

  static void mark(double x, double y, int uses, std::ostream& out) {
    if (uses & 1)
      out << "<circle cx=\"" << x << "\" cy=\"" << y
          << "\" r=\"8\" fill=\"none\" stroke=\"#0072B2\" stroke-width=\"2\"/>\n";
    if (uses & 2) out << "<circle cx=\"" << x << "\" cy=\"" << y << "\" r=\"4.5\" fill=\"#D55E00\"/>\n";
    if (uses & 4)
      out << "<path d=\"M" << x - 6 << ' ' << y << "h12M" << x << ' ' << y - 6
          << "v12\" stroke=\"#009E73\" stroke-width=\"3\"/>\n";
  }

  void text(int row, int depth, const std::string& label, const std::string& because, bool heading) {
    const double y = y_of(row) + 4.5;
    body_ << "<text x=\"" << margin + indent * depth << "\" y=\"" << y << '"'
          << (heading ? " font-style=\"italic\"" : "") << ">" << escaped(label) << "</text>\n<text x=\""
          << margin + left_width + column_width * static_cast<double>(columns_.size()) + 16 << "\" y=\"" << y
          << "\" fill=\"#555\" font-size=\"12\">" << escaped(shortened(because, 96)) << "</text>\n";
  }

  void draw_columns(std::ostream& out, double top) const {
    std::string owner;
    for (const Column& column : columns_) {
      const std::string own = column.name.substr(0, column.name.find('/'));
      const double left = column.x - column_width / 2;
      if (own != owner) {
        out << "<text x=\"" << left + 2 << "\" y=\"" << title_height + 12 << "\" font-weight=\"bold\">" << own
            << "</text>\n";
        out << "<line x1=\"" << left << "\" x2=\"" << left << "\" y1=\"" << title_height << "\" y2=\""
            << top + row_height * rows_ << "\" stroke=\"#999\"/>\n";
      }
      owner = own;
      out << "<text transform=\"translate(" << column.x + 4 << ' ' << top - 8 << ") rotate(-90)\">"
          << escaped(shortened(spoken(column.name), 24)) << "</text>\n";
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

  std::vector<Column> columns_;
  std::ostringstream body_;
  int rows_ = 0;
};

}  // namespace

std::string Plan::to_svg(const std::string& title) const {
  return Picture(*this).svg(title);
}

}  // namespace mpm
