#include "backends/device/particle_formulas.hpp"

#include <algorithm>
#include <sstream>

#include "experiment/formula.hpp"

namespace mpm::device {
namespace {

using formula::Operation;
using formula::Term;

/// Writes one formula as the body of a function, and collects the terms that it takes as numbers.
class FunctionText {
 public:
  FunctionText(const VectorExpression& formula, int dimension) : dimension_(dimension) {
    if (const formula::Graph* const graph = formula.graph())
      write(graph->terms(), formula.terms());
    else
      for (int c = 0; c < dimension; ++c) result_.push_back(number(c));
  }

  std::string text() const {
    std::string all = "{\n" + lines_.str() + "    return {{";
    for (std::size_t c = 0; c < result_.size(); ++c) all += (c > 0 ? ", " : "") + result_[c];
    return all + "}};\n  }\n";
  }
  const std::vector<int>& numbers() const { return numbers_; }

 private:
  /// Writes the terms that the components need, in the order in which they stand, so that each follows what it takes.
  void write(const std::vector<Term>& terms, const std::vector<int>& components) {
    std::vector<bool> wanted(terms.size());
    for (int c = 0; c < dimension_; ++c) wanted[static_cast<std::size_t>(components[c])] = true;
    for (std::size_t n = terms.size(); n-- > 0;)
      for (int i = 0; wanted[n] && terms[n].at_points && i < formula::operands(terms[n].operation); ++i)
        wanted[static_cast<std::size_t>(terms[n].of[i])] = true;
    std::vector<std::string> names(terms.size());
    int values = 0;
    for (std::size_t n = 0; n < terms.size(); ++n) {
      if (!wanted[n]) continue;
      names[n] = terms[n].at_points ? "v" + std::to_string(values++) : number(static_cast<int>(n));
      if (terms[n].at_points) lines_ << "    const Scalar " << names[n] << " = " << value(terms[n], names) << ";\n";
    }
    for (int c = 0; c < dimension_; ++c) result_.push_back(names[static_cast<std::size_t>(components[c])]);
  }

  /// The name of the next number, which is that of a term.
  std::string number(int term) {
    numbers_.push_back(term);
    return "numbers[" + std::to_string(numbers_.size() - 1) + "]";
  }

  static std::string variable(int variable) {
    return (variable < 3 ? "x[" : "X[") + std::to_string(variable % 3) + "]";
  }

  /// An operation on the values with these names.
  std::string value(const Term& term, const std::vector<std::string>& names) const {
    const auto of = [&](int i) { return names[static_cast<std::size_t>(term.of[i])]; };
    const auto between = [&](const char* sign) { return of(0) + " " + sign + " " + of(1); };
    const auto truth = [&](const std::string& condition) { return condition + " ? Scalar(1) : Scalar(0)"; };
    const auto both_ways = [&](const char* sign) {
      return truth("(" + of(0) + " != Scalar(0)) " + sign + " (" + of(1) + " != Scalar(0))");
    };
    switch (term.operation) {
      case Operation::variable:
        return variable(term.variable);
      case Operation::negate:
        return "-" + of(0);
      case Operation::add:
        return between("+");
      case Operation::subtract:
        return between("-");
      case Operation::multiply:
        return between("*");
      case Operation::divide:
        return between("/");
      case Operation::whole_power:
        return "formulas::pow(" + of(0) + ", " + of(1) + ")";
      case Operation::min:
        return of(1) + " < " + of(0) + " ? " + of(1) + " : " + of(0);
      case Operation::max:
        return of(0) + " < " + of(1) + " ? " + of(1) + " : " + of(0);
      case Operation::less:
        return truth(between("<"));
      case Operation::greater:
        return truth(between(">"));
      case Operation::less_or_equal:
        return truth(between("<="));
      case Operation::greater_or_equal:
        return truth(between(">="));
      case Operation::equal:
        return truth(between("=="));
      case Operation::unequal:
        return truth(between("!="));
      case Operation::both:
        return both_ways("&&");
      case Operation::either:
        return both_ways("||");
      case Operation::choose:
        return of(0) + " != Scalar(0) ? " + of(1) + " : " + of(2);
      default:
        return "formulas::" + function_of(term.operation) + "(" + of(0) +
               (formula::operands(term.operation) > 1 ? ", " + of(1) : "") + ")";
    }
  }

  static std::string function_of(Operation operation) {
    const std::vector<formula::Function>& all = formula::functions();
    return std::find_if(all.begin(), all.end(), [&](const formula::Function& f) { return f.operation == operation; })
        ->name;
  }

  int dimension_;
  std::ostringstream lines_;
  std::vector<std::string> result_;
  std::vector<int> numbers_;
};

/// The values of all terms of a formula that are the same at all particles; the others stay zero.
std::vector<double> values_without_place(const std::vector<Term>& terms, double time) {
  std::vector<double> values(terms.size());
  for (std::size_t n = 0; n < terms.size(); ++n) {
    const Term& term = terms[n];
    if (term.at_points) continue;
    std::array<double, 3> of{term.operation == Operation::variable ? time : term.constant, 0, 0};
    for (int i = 0; i < formula::operands(term.operation); ++i) of[i] = values[static_cast<std::size_t>(term.of[i])];
    values[n] = formula::value_of(term.operation, of[0], of[1], of[2]);
  }
  return values;
}

}  // namespace

ParticleFormulas::ParticleFormulas(const Experiment& experiment) : dimension_(experiment.dimension) {
  if (experiment.body_force) accelerations_.push_back({add(*experiment.body_force, false), all_bodies});
  for (std::size_t k = 0; k < experiment.loads.size(); ++k) {
    const Load& load = experiment.loads[k];
    loads_at_points_ = loads_at_points_ || load.at_points();
    if (load.type == LoadType::spring)
      use_initial_position_ = use_initial_position_ || load.gives(ExternalForce::spring);
    else if (load.at_points())
      values_.push_back({add(load.value, false), k});
    else
      accelerations_.push_back({add(load.value, false), load.body});
  }
  for (const Grip& grip : experiment.grips) velocities_.push_back(add(grip.velocity, true));
}

std::size_t ParticleFormulas::add(const VectorExpression& formula, bool at_end) {
  use_initial_position_ = use_initial_position_ || formula.uses_initial_position();
  use_time_ = use_time_ || formula.uses_time();
  const FunctionText written(formula, dimension_);
  const auto [known, is_new] = known_.try_emplace(written.text(), static_cast<int>(functions_.size()));
  if (is_new) functions_.push_back(known->first);
  calls_.push_back({&formula, known->second, at_end, count(), written.numbers()});
  return calls_.size() - 1;
}

std::size_t ParticleFormulas::count() const {
  return calls_.empty() ? 0 : calls_.back().first + calls_.back().terms.size();
}

std::vector<double> ParticleFormulas::numbers(double begin, double end) const {
  std::vector<double> all;
  for (const Call& call : calls_) {
    const double time = call.at_end ? end : begin;
    const formula::Graph* const graph = call.formula->graph();
    const Vector3 constant = graph ? Vector3{} : (*call.formula)({}, {}, time);
    const std::vector<double> values =
        graph ? values_without_place(graph->terms(), time) : std::vector<double>(constant.begin(), constant.end());
    for (const int term : call.terms) all.push_back(values[static_cast<std::size_t>(term)]);
  }
  return all;
}

std::string ParticleFormulas::call_text(std::size_t call) const {
  return "formula_" + std::to_string(calls_[call].function) + "(x, X, numbers + " + std::to_string(calls_[call].first) +
         ")";
}

std::string ParticleFormulas::text() const {
  if (!any() && !loads_at_points_) return "";
  const std::string vector = "Vec<" + std::to_string(dimension_) + ", Scalar>", place = vector + "& ";
  const std::string parameters = "[[maybe_unused]] const " + place + "x, [[maybe_unused]] const " + place +
                                 "X,\n      [[maybe_unused]] const Scalar* numbers) ";
  std::ostringstream out;
  for (std::size_t k = 0; k < functions_.size(); ++k)
    out << "  MPM_HD static " << vector << " formula_" << k << "(" << parameters << functions_[k];
  out << "  MPM_HD static " << vector << " acceleration([[maybe_unused]] int body, " << parameters << "{\n    "
      << vector << " sum{};\n";
  for (const Acceleration& part : accelerations_)
    out << (part.body == all_bodies ? "    " : "    if (body == " + std::to_string(part.body) + ") ")
        << "formulas::add(sum, " << call_text(part.call) << ");\n";
  out << "    return sum;\n  }\n  MPM_HD static " << vector << " velocity_of_grip([[maybe_unused]] int grip, "
      << parameters << "{\n";
  for (std::size_t grip = 0; grip < velocities_.size(); ++grip)
    out << "    if (grip == " << grip << ") return " << call_text(velocities_[grip]) << ";\n";
  out << "    return {};\n  }\n  MPM_HD static " << vector << " load_value([[maybe_unused]] int load, " << parameters
      << "{\n";
  for (const Value& value : values_)
    out << "    if (load == " << value.load << ") return " << call_text(value.call) << ";\n";
  out << "    return {};\n  }\n";
  return out.str();
}

}  // namespace mpm::device
