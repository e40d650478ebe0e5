#include "solvers/solver.hpp"

#include "solvers/explicit/explicit.hpp"

namespace mpm {

std::span<const Solver> solvers() {
  static const Solver all[] = {
      {"explicit", "Symplectic Euler steps, bounded by the speed of the fastest wave.", explicit_parameters,
       read_explicit, explicit_step, explicit_limit},
  };
  return all;
}

const Solver& solver_of(const Experiment& experiment) {
  for (const Solver& solver : solvers())
    if (solver.id == experiment.solver.type) return solver;
  throw std::logic_error("no solver is called " + experiment.solver.type);
}

std::vector<SolverDescription> solver_descriptions() {
  std::vector<SolverDescription> all;
  for (const Solver& solver : solvers())
    all.push_back({std::string(solver.id), std::string(solver.summary), solver.parameters(), solver.read});
  return all;
}

Plan make_plan(const Experiment& experiment) {
  return assemble_plan(experiment, solver_of(experiment).step);
}

}  // namespace mpm
