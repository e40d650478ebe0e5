#include "run/record_names.hpp"

#include <algorithm>
#include <cmath>

#include "metrics/probes.hpp"
#include "output/summary_value.hpp"
#include "run/run_record.hpp"
#include "run/start_checks.hpp"
#include "run/summary.hpp"
#include "simulation/seeding.hpp"

namespace mpm::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t enough = 8;  ///< particles a body, which may spin

/// Keeps the first particles of a body and lets them move, so that no number of the scene is left out because it is zero.
SeededBody few_of(SeededBody seeded) {
  SeededBody few = seeded;
  few.particles = std::min(enough, seeded.particles);
  few.make = [seeded, count = few.particles](const std::function<void(const SeedBatch&)>& visit) {
    seeded.make([&](const SeedBatch& all) {
      if (all.first > 0) return;
      SeedBatch batch = all;
      batch.count = std::min(count, all.count);
      std::vector<double> velocity(batch.count * seeded.dimension);
      for (std::size_t k = 0; k < velocity.size(); ++k) velocity[k] = 1 + 0.1 * std::sin(static_cast<double>(k * k));
      batch.velocity = velocity.data();
      visit(batch);
    });
  };
  return few;
}

void collect(const Json& value, const std::string& prefix, std::vector<std::string>& names) {
  if (value.is_number()) names.push_back(prefix);
  if (!value.is_object()) return;
  for (const auto& [key, child] : value.items()) collect(child, prefix.empty() ? key : prefix + "." + key, names);
}

std::string without_unit(const std::string& column) {
  return column.substr(0, column.find(" ("));
}

void check_expectations(const Experiment& experiment, const Json& summary, std::vector<Problem>& problems) {
  for (const Expectation& expectation : experiment.expectations) {
    const Json* value = output::value_at(summary, expectation.metric);
    if (value && (value->is_number() || value->is_null())) continue;  // null: a number that only some states have
    const std::vector<std::string> names = paths_of(summary);
    problems.push_back(problem_at(experiment, expectation.pointer + "/metric",
                                  "no run of this experiment records " + in_quotes(expectation.metric) +
                                      suggestion(expectation.metric, names, "it records " + quoted_list(names))));
  }
}

void check_figures(const Experiment& experiment, const std::vector<std::string>& columns,
                   std::vector<Problem>& problems) {
  std::vector<std::string> names;
  for (const std::string& column : columns) names.push_back(without_unit(column));
  for (const ColumnFigure& figure : experiment.column_figures)
    for (std::size_t k = 0; k < figure.columns.size(); ++k) {
      const std::string& name = figure.columns[k];
      if (std::find(names.begin(), names.end(), name) != names.end()) continue;
      problems.push_back(problem_at(experiment, figure.pointer + "/columns/" + std::to_string(k),
                                    "no run of this experiment has a column " + in_quotes(name) +
                                        suggestion(name, names, "it has " + quoted_list(names))));
    }
}

void check_probes(const Experiment& experiment, std::vector<Problem>& problems) {
  for (const ProbeSpecification& probe : experiment.output.probes)
    for (std::size_t k = 0; k < probe.quantities.size(); ++k) {
      const std::string& name = probe.quantities[k];
      if (!bodies_with(experiment, probe.body, name).empty()) continue;
      std::vector<std::string> names;
      for (int body = 0; body < static_cast<int>(experiment.bodies.size()); ++body)
        for (const std::string& known : quantity_names(experiment, body))
          if ((probe.body < 0 || probe.body == body) && std::find(names.begin(), names.end(), known) == names.end())
            names.push_back(known);
      problems.push_back(problem_at(experiment, probe.pointer + "/quantities/" + std::to_string(k),
                                    "no particle of this experiment has " + in_quotes(name) +
                                        suggestion(name, names, "there are " + quoted_list(names))));
    }
}

bool holds_a_particle(const Experiment& experiment, const GroupSpecification& group) {
  bool any = false;
  const auto D = static_cast<std::size_t>(experiment.dimension);
  for (int body = 0; !any && body < static_cast<int>(experiment.bodies.size()); ++body) {
    if (group.body >= 0 && group.body != body) continue;
    seed_body(experiment, body).for_each_batch([&](const SeedBatch& batch) {
      for (std::size_t p = 0; !any && p < batch.count; ++p) {
        Vector3 x{};
        std::copy_n(batch.position + p * D, D, x.begin());
        any = group.where->contains(x);
      }
    });
  }
  return any;
}

}  // namespace

std::vector<std::string> paths_of(const Json& summary) {
  std::vector<std::string> names;
  collect(summary, "", names);
  return names;
}

RecordNames record_names(const Experiment& experiment, const BackendFactory& make_backend) {
  const Simulation simulation(experiment,
                              [&](const Experiment& same, const Plan& plan, std::vector<SeededBody> bodies) {
                                for (SeededBody& body : bodies) body = few_of(std::move(body));
                                return make_backend(same, plan, std::move(bodies));
                              });
  const Metrics metrics(simulation);
  RunRecord rows(simulation, metrics);
  const std::vector<double> row = metrics.row(metrics.initial());
  rows.take(metrics.initial(), std::span(row).last(metrics.chosen().count()));
  RecordNames names{summarise(simulation, metrics, rows, 0, {}), metrics.columns()};
  for_each_pass(simulation.plan().step,
                [&](const Pass& pass) { names.summary["performance"]["seconds_by_pass"][pass.name()] = 0.0; });
  return names;
}

std::vector<Problem> unknown_records(const Experiment& experiment, const RecordNames& names) {
  std::vector<Problem> problems;
  check_expectations(experiment, names.summary, problems);
  check_figures(experiment, names.columns, problems);
  check_probes(experiment, problems);
  for (const GroupSpecification& group : experiment.output.groups)
    if (!holds_a_particle(experiment, group))
      problems.push_back(problem_at(experiment, group.pointer + "/where", "no particle begins in this region"));
  return problems;
}

}  // namespace mpm::app
