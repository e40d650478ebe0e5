#pragma once
// What the copies of a VectorExpression share: its formulas, and the programs made of them.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "experiment/expression.hpp"
#include "experiment/formula_program.hpp"

namespace mpm {

struct VectorExpression::Formulas {
  std::array<std::string, 3> text;  ///< empty where the component is constant
  ExpressionScope scope;
  /// Number of the program of all components, before those of one each; never used twice, unlike an address.
  std::uint64_t id = 0;
  formula::Graph graph;
  std::vector<int> terms;                      ///< of the components in the graph
  formula::Program all;                        ///< of all components
  std::array<formula::Program, 3> components;  ///< of one each

  /// Adds the next component. Throws std::invalid_argument where the text is no formula.
  void add(const std::string& component, double constant) {
    terms.push_back(component.empty() ? graph.constant(constant)
                                      : formula::parse(component, scope.constants, terms.size(), graph));
  }
  void compile() {
    all = formula::Program(graph, terms);
    for (std::size_t i = 0; i < 3; ++i) components[i] = formula::Program(graph, {terms[i]});
  }
};

}  // namespace mpm
