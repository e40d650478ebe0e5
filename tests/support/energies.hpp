#pragma once
// Energies of a run at one time, from records of every step.

#include <string>
#include <vector>

namespace mpm::test {

/// Total energies at the steps 1 to n - 2 of n records, of kinetic energy and strain energy at the same time. Velocities
/// belong to the middle of steps, strains to their ends (USF: to their starts), so the kinetic energies on both sides of a
/// strain are averaged; with USAVG both belong to the ends. `update` is the word of /solver/stress_update.
inline std::vector<double> energies_at_one_time(const std::vector<double>& kinetic, const std::vector<double>& strain,
                                                const std::string& update) {
  const std::size_t back = update == "first" ? 1 : 0, on = update == "last" || update == "modified_last" ? 1 : 0;
  std::vector<double> totals;
  for (std::size_t k = 1; k + 1 < kinetic.size(); ++k)
    totals.push_back(0.5 * (kinetic[k - back] + kinetic[k + on]) + strain[k]);
  return totals;
}

}  // namespace mpm::test
