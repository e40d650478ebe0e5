#pragma once
// Which components run together. One function decides; the plan asks it for a scene, the table in the docs for all
// mixes.

#include <optional>
#include <string>
#include <vector>

#include "experiment/experiment.hpp"
#include "experiment/polynomials.hpp"

namespace mpm {

/// The components of a scene, without their numbers.
struct Mix {
  const Plugin* shape = nullptr;
  const Plugin* transfer = nullptr;
  const Plugin* filter = nullptr;   ///< or none
  const Plugin* contact = nullptr;  ///< or none
  StressUpdate stress_update = StressUpdate::last;
  bool filtered_every_step = true;
  int basis_order = 0;  ///< of the transfer, as its parameters ask for it (mpm_transfer_polynomials)
};

struct Refusal {
  mpm_kind at;         ///< the component to change
  std::string reason;  ///< names both and says why and what to do instead
};

/// Nothing when the mix runs on every backend.
std::optional<Refusal> refusal_of(const Mix& mix);

/// Throws InputError at the place of a JSON pointer's value.
[[noreturn]] void refuse(const Experiment& experiment, const std::string& pointer, const std::string& message);

/// Every mix of the registry's plugins: shape x transfer x (no filter, each filter at every step, each filter
/// periodically) x (no contact, each law) x stress update. Materials mix with everything. A transfer with polynomials
/// beyond affine comes once for every order that its choices ask for.
std::vector<Mix> all_mixes(const Registry& registry);

}  // namespace mpm
