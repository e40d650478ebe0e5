// The verb `compare`: what differs between two runs.

#include <iostream>

#include "experiment/diagnostics.hpp"
#include "mpm/cli.hpp"
#include "output/run_folder.hpp"
#include "run/compare_runs.hpp"
#include "support/files.hpp"

namespace mpm::app {

int compare(const CompareOptions& options) {
  RunComparison comparison;
  try {
    comparison = compare_runs(options.first, options.second);
  } catch (const output::FolderRefused&) {
    throw;
  } catch (const support::MachineError&) {
    throw;
  } catch (const std::runtime_error& error) {  // a file that is damaged
    throw InputError({Problem{"", 0, 0, "", error.what()}});
  }
  if (options.json)
    std::cout << json_of(comparison, options.tolerance).dump(2) << "\n";
  else
    std::cout << text_of(comparison, options.tolerance);
  return comparison.equal_within(options.tolerance) ? done : expectation_failed;
}

}  // namespace mpm::app
