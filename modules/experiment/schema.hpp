#pragma once
#include <nlohmann/json.hpp>

#include <string>
#include <utility>
#include <vector>

#include "experiment/parameter.hpp"
#include "experiment/read.hpp"

namespace mpm {

/// JSON Schema (draft 2020-12) of an experiment file, written from the tables that the reader checks against and from
/// the parameters that the plugins declare, so that editors complete and check what this build accepts. It cannot say
/// what the reader checks across keys (whole cells, bodies inside the domain, …).
nlohmann::ordered_json json_schema(const Registry& registry, const ReadOptions& options);
/// The same for files of other kinds too. The type of a file's solver, which is the name of the second section, says that
/// its keys are those of the first.
struct FileKind {
  Section file, solver;
  std::vector<std::pair<std::string, Section>> lists;  ///< of objects, by the definition that keys refer to
};
nlohmann::ordered_json json_schema(const ComponentLookup& components, const ReadOptions& options,
                                   const std::vector<FileKind>& others);
nlohmann::ordered_json json_schema(const ComponentLookup& components, const ReadOptions& options);

}  // namespace mpm
