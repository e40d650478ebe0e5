#include "run/earlier_run.hpp"

#include <iostream>

#include "output/checkpoint_file.hpp"
#include "run/checkpoint.hpp"
#include "support/files.hpp"

namespace mpm::app {
namespace {

namespace fs = std::filesystem;

constexpr const char* remedies = "replace it with --replace, or choose another folder with --out";

/// Why the run that a folder holds must not be replaced without a word; an empty string when it may be.
std::string objection(const output::RunFolder& folder, const Experiment& experiment) {
  const fs::path file = folder.root() / "experiment.json";
  // A run that was killed before it wrote its experiment has no results.
  if (!fs::exists(file)) return "";
  const auto recorded = nlohmann::ordered_json::parse(support::read_file(file), nullptr, false);
  if (!recorded.is_object()) return "holds a run whose experiment.json is damaged: " + std::string(remedies);
  if (const auto difference = difference_to(experiment, recorded))
    return "holds the results of another experiment (" + difference->pointer + " is " + difference->then +
           " there, and " + difference->now + " here): " + remedies;
  if (!finished_with(folder) && !output::checkpoints_in(folder.root() / "checkpoint").empty())
    return "holds an unfinished run of this experiment: go on with it with --resume, start anew with --replace, or "
           "choose another folder with --out";
  return "";
}

}  // namespace

output::RunFolder folder_for_new_run(const fs::path& place, const Experiment& experiment, bool replace) {
  if (!output::RunFolder::holds_run(place)) return output::RunFolder::create(place);
  const output::RunFolder earlier = output::RunFolder::open(place);
  const output::FolderLock nobody_writes(earlier.root());
  const std::string trouble = objection(earlier, experiment);
  if (!trouble.empty() && !replace) throw output::FolderRefused(place.string() + " " + trouble);
  std::cerr << place.string() << ": "
            << (trouble.empty() ? "the earlier run of the same experiment is replaced\n"
                                : "the earlier run is replaced (--replace)\n");
  return output::RunFolder::replace(place);
}

}  // namespace mpm::app
