#include "experiment/formula_program.hpp"

#include <algorithm>
#include <limits>
#include <map>

namespace mpm::formula {
namespace {

constexpr int never = -1, at_the_end = std::numeric_limits<int>::max();

/// How terms become instructions: which come with another one, and what each instruction reads.
struct Layout {
  std::vector<std::vector<int>> reads;  ///< of the instruction of a term; empty for terms without one
  std::vector<int> cosine;              ///< of a sine or cosine: the other one of the same value, done with it
  std::vector<int> first;               ///< of a sum or product: the term that is done first in the same instruction
  std::vector<bool> live, comes_along;
};

bool chains(Operation operation) {
  return operation == Operation::add || operation == Operation::subtract || operation == Operation::multiply;
}

Layout lay_out(const std::vector<Term>& terms, const std::vector<int>& outputs) {
  const int count = static_cast<int>(terms.size());
  Layout layout{std::vector<std::vector<int>>(terms.size()), std::vector<int>(terms.size(), never),
                std::vector<int>(terms.size(), never), std::vector<bool>(terms.size()),
                std::vector<bool>(terms.size())};
  std::vector<int> uses(terms.size());
  for (const int output : outputs)
    if (output >= 0) layout.live[output] = true, ++uses[output];
  for (int n = count - 1; n >= 0; --n)
    for (int i = 0; layout.live[n] && i < operands(terms[n].operation); ++i)
      layout.live[terms[n].of[i]] = true, ++uses[terms[n].of[i]];
  std::map<int, int> circular;  // the first sine or cosine of a term
  for (int n = 0; n < count; ++n) {
    const Term& term = terms[n];
    if (!layout.live[n]) continue;
    layout.reads[n].assign(term.of.begin(), term.of.begin() + operands(term.operation));
    if (!term.at_points) continue;
    if (term.operation == Operation::sin || term.operation == Operation::cos) {
      const auto [earlier, alone] = circular.try_emplace(term.of[0], n);
      if (alone) continue;
      layout.cosine[earlier->second] = n, layout.comes_along[n] = true, layout.reads[n].clear();
    }
    for (int i = 0; chains(term.operation) && i < 2; ++i) {
      const int a = term.of[i];
      if (uses[a] != 1 || !chains(terms[a].operation) || !terms[a].at_points || layout.first[a] != never) continue;
      layout.first[n] = a, layout.comes_along[a] = true, layout.reads[a].clear();
      layout.reads[n] = {terms[a].of[0], terms[a].of[1], term.of[1 - i]};
      break;
    }
  }
  return layout;
}

/// The term whose instruction reads each term last.
std::vector<int> last_uses(const Layout& layout, const std::vector<int>& outputs) {
  std::vector<int> last(layout.reads.size(), never);
  for (std::size_t n = 0; n < layout.reads.size(); ++n)
    for (const int operand : layout.reads[n]) last[operand] = static_cast<int>(n);
  for (const int output : outputs)
    if (output >= 0) last[output] = at_the_end;
  return last;
}

/// What an instruction does after the term `first`, one of the two that `term` takes.
Then after(const Term& term, int first) {
  if (term.operation == Operation::add) return Then::add;
  if (term.operation == Operation::multiply) return Then::multiply;
  return term.of[0] == first ? Then::subtract : Then::subtract_from;
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
  const Layout layout = lay_out(terms, outputs);
  std::vector<int> last = last_uses(layout, outputs);
  std::vector<Source> place(terms.size());
  Registers registers;
  // Places of variables are filled before the first instruction, so nothing else may lie there before.
  for (std::size_t n = 0; n < terms.size(); ++n)
    if (layout.live[n] && terms[n].operation == Operation::variable && terms[n].at_points)
      place[n] = {Source::Kind::in_register, inputs_[terms[n].variable] = registers.take()};
  for (int n = 0; n < static_cast<int>(terms.size()); ++n) {
    const Term& term = terms[n];
    if (!layout.live[n] || layout.comes_along[n] || place[n].kind != Source::Kind::none) continue;
    if (term.operation == Operation::constant) {
      place[n] = {Source::Kind::constant, static_cast<int>(constants_.size())};
      constants_.push_back(term.constant);
      continue;
    }
    std::array<Source, 3> of;
    for (std::size_t i = 0; i < layout.reads[n].size(); ++i) of[i] = place[layout.reads[n][i]];
    if (!term.at_points) {
      place[n] = {Source::Kind::of_call, static_cast<int>(call_instructions_.size())};
      call_instructions_.push_back({term.operation, of});
      continue;
    }
    Instruction instruction{term.operation, Then::nothing, false, of};
    place[n] = {Source::Kind::in_register, instruction.to = registers.take()};
    if (term.operation == Operation::whole_power) instruction.exponent = static_cast<int>(terms[term.of[1]].constant);
    if (const int first = layout.first[n]; first != never)
      instruction.operation = terms[first].operation, instruction.then = after(term, first);
    if (const int other = layout.cosine[n]; other != never) {
      place[other] = {Source::Kind::in_register, instruction.cosine_to = registers.take()};
      if (term.operation == Operation::cos) std::swap(instruction.to, instruction.cosine_to);
      instruction.operation = Operation::sin, instruction.and_cosine = true;
    }
    instructions_.push_back(instruction);
    for (const int operand : layout.reads[n]) {
      if (last[operand] != n || place[operand].kind != Source::Kind::in_register) continue;
      registers.give_back(place[operand].index);
      last[operand] = at_the_end;  // once, also where a term takes it twice
    }
  }
  for (const int output : outputs) outputs_.push_back(output < 0 ? Source{} : place[output]);
  registers_ = registers.count();
}

template <class T>
void Program::begin(double t, Space<T>& space) const {
  if (space.registers.size() < static_cast<std::size_t>(registers_)) space.registers.resize(registers_);
  space.constants.resize(constants_.size());
  for (std::size_t n = 0; n < constants_.size(); ++n)
    std::fill_n(space.constants[n].values, pack_size<T>, static_cast<T>(constants_[n]));
  space.of_call.resize(call_instructions_.size()), space.packs_of_call.resize(call_instructions_.size());
  for (std::size_t n = 0; n < call_instructions_.size(); ++n) {
    const CallInstruction& instruction = call_instructions_[n];
    std::array<double, 3> values{t, 0, 0};
    for (int i = 0; i < operands(instruction.operation); ++i) {
      const Source& of = instruction.of[i];
      values[i] = of.kind == Source::Kind::constant ? constants_[of.index] : space.of_call[of.index];
    }
    space.of_call[n] = value_of(instruction.operation, values[0], values[1], values[2]);
    std::fill_n(space.packs_of_call[n].values, pack_size<T>, static_cast<T>(space.of_call[n]));
  }
  space.steps.clear();
  for (const Instruction& instruction : instructions_)
    space.steps.push_back(
        {work_of<T>(instruction),
         instruction.operation,
         instruction.exponent,
         space.registers[instruction.to].values,
         space.registers[instruction.cosine_to].values,
         {find(instruction.of[0], space), find(instruction.of[1], space), find(instruction.of[2], space)}});
}

template void Program::begin<double>(double, Space<double>&) const;
template void Program::begin<float>(double, Space<float>&) const;

}  // namespace mpm::formula
