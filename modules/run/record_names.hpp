#pragma once
// Which numbers a run will record, known before it runs.

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "experiment/diagnostics.hpp"
#include "simulation/simulation.hpp"

namespace mpm::app {

struct RecordNames {
  nlohmann::ordered_json summary;    ///< as summary.json will be, with other values
  std::vector<std::string> columns;  ///< the header of metrics.csv
};

/// The names that the run's own code gives: of a scene of a few particles a body that move as they please.
RecordNames record_names(const Experiment& experiment, const BackendFactory& make_backend);

/// Dotted paths of all numbers in a summary.
std::vector<std::string> paths_of(const nlohmann::ordered_json& summary);

/// What is wrong with the names of expectations, of columns in figures and of quantities in probes; and groups that hold no
/// particle.
std::vector<Problem> unknown_records(const Experiment& experiment, const RecordNames& names);

}  // namespace mpm::app
