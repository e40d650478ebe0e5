#include "experiment/formula_program.hpp"

#include <algorithm>
#include <limits>
#include <map>

namespace mpm::formula {
namespace {

constexpr int never = -1, at_the_end = std::numeric_limits<int>::max();

/// The term that reads each term last. Terms that come with an earlier one (`comes_with`) read nothing themselves.
std::vector<int> last_uses(const std::vector<Term>& terms, const std::vector<int>& outputs,
                           const std::vector<int>& comes_with) {
  std::vector<int> last(terms.size(), never);
  for (const int output : outputs)
    if (output >= 0) last[output] = at_the_end;
  for (int n = static_cast<int>(terms.size()) - 1; n >= 0; --n) {
    if (last[n] == never || comes_with[n] >= 0) continue;
    for (int i = 0; i < operands(terms[n].operation); ++i) {
      int& use = last[terms[n].of[i]];
      use = std::max(use, n);
    }
  }
  return last;
}

/// Registers that are free again after their last use.
class Registers {
 public:
  int take() {
    if (free_.empty()) return count_++;
    const int taken = free_.back();
    free_.pop_back();
    return taken;
  }
  void give_back(int number) { free_.push_back(number); }
  int count() const { return count_; }

 private:
  std::vector<int> free_;
  int count_ = 0;
};

}  // namespace

Program::Program(const Graph& graph, const std::vector<int>& outputs) {
  const std::vector<Term>& terms = graph.terms();
  std::vector<int> pairs(terms.size(), never), comes_with = pairs;
  std::vector<int> last = last_uses(terms, outputs, comes_with);
  std::map<int, int> circular;  // the first sine or cosine of a term
  for (int n = 0; n < static_cast<int>(terms.size()); ++n) {
    const bool is_one = terms[n].operation == Operation::sin || terms[n].operation == Operation::cos;
    if (last[n] == never || !terms[n].at_points || !is_one) continue;
    const auto [first, alone] = circular.try_emplace(terms[n].of[0], n);
    if (!alone) pairs[first->second] = n, comes_with[n] = first->second;
  }
  last = last_uses(terms, outputs, comes_with);
  std::vector<Source> place(terms.size());
  Registers registers;
  // Places of variables are filled before the first instruction, so nothing else may lie there before.
  for (std::size_t n = 0; n < terms.size(); ++n)
    if (last[n] != never && terms[n].operation == Operation::variable && terms[n].at_points)
      place[n] = {Source::Kind::in_register, inputs_[terms[n].variable] = registers.take()};
  for (int n = 0; n < static_cast<int>(terms.size()); ++n) {
    const Term& term = terms[n];
    if (last[n] == never || place[n].kind != Source::Kind::none) continue;
    if (term.operation == Operation::constant) {
      place[n] = {Source::Kind::constant, static_cast<int>(constants_.size())};
      std::fill_n(constants_.emplace_back().values, pack_size, term.constant);
      continue;
    }
    std::array<Source, 3> of;
    for (int i = 0; i < operands(term.operation); ++i) of[i] = place[term.of[i]];
    if (!term.at_points) {
      place[n] = {Source::Kind::of_call, static_cast<int>(call_instructions_.size())};
      call_instructions_.push_back({term.operation, of});
      continue;
    }
    Instruction instruction{term.operation, false, of};
    place[n] = {Source::Kind::in_register, instruction.to = registers.take()};
    if (term.operation == Operation::whole_power) instruction.exponent = static_cast<int>(terms[term.of[1]].constant);
    if (const int other = pairs[n]; other >= 0) {
      place[other] = {Source::Kind::in_register, instruction.cosine_to = registers.take()};
      if (term.operation == Operation::cos) std::swap(instruction.to, instruction.cosine_to);
      instruction.operation = Operation::sin, instruction.and_cosine = true;
    }
    instructions_.push_back(instruction);
    for (int i = 0; i < operands(term.operation); ++i) {
      const int operand = term.of[i];
      if (last[operand] != n || place[operand].kind != Source::Kind::in_register) continue;
      registers.give_back(place[operand].index);
      last[operand] = at_the_end;  // once, also where a term takes it twice
    }
  }
  for (const int output : outputs) outputs_.push_back(output < 0 ? Source{} : place[output]);
  registers_ = registers.count();
}

void Program::begin(double t, Space& space) const {
  if (space.registers.size() < static_cast<std::size_t>(registers_)) space.registers.resize(registers_);
  if (space.of_call.size() < call_instructions_.size()) space.of_call.resize(call_instructions_.size());
  for (std::size_t n = 0; n < call_instructions_.size(); ++n) {
    const CallInstruction& instruction = call_instructions_[n];
    std::array<double, 3> values{t, 0, 0};
    for (int i = 0; i < operands(instruction.operation); ++i) values[i] = find(instruction.of[i], space)[0];
    std::fill_n(space.of_call[n].values, pack_size, value_of(instruction.operation, values[0], values[1], values[2]));
  }
}

}  // namespace mpm::formula
