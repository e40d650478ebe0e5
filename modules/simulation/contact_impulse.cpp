#include "simulation/contact_impulse.hpp"

#include <vector>

#include "plugin/abi.h"
#include "plugin/registry.hpp"

namespace mpm {

GatherShares gather_shares(const Experiment& experiment) {
  constexpr std::size_t n = MPM_LANES;
  const mpm_transfer& transfer = experiment.transfer.plugin->transfer();
  const auto D = static_cast<std::size_t>(experiment.dimension);
  const std::vector<double> zeros(D * D * n), ones(D * n, 1.0);
  std::vector<double> second_moment(D * D * n);
  for (std::size_t c = 0; c < D; ++c)
    for (std::size_t lane = 0; lane < n; ++lane) second_moment[(c * D + c) * n + lane] = 1;
  const auto share = [&](const std::vector<double>& velocity, const std::vector<double>& increment) {
    std::vector<double> result(D * n), advection(D * n);
    std::vector<std::vector<double>> values;
    std::vector<void*> state;
    for (const mpm_state& field : experiment.transfer.plugin->state())
      state.push_back(
          values.emplace_back(state_components(static_cast<mpm_state_shape>(field.shape), experiment.dimension) * n)
              .data());
    const mpm_gather_batch batch{n,
                                 n,
                                 static_cast<std::uint32_t>(D),
                                 0,
                                 1.0,
                                 velocity.data(),
                                 increment.data(),
                                 zeros.data(),
                                 zeros.data(),
                                 result.data(),
                                 state.data(),
                                 advection.data(),
                                 second_moment.data()};
    transfer.gather[MPM_SCALAR_DOUBLE][D - 2](experiment.transfer.parameters.data(), &batch);
    return result[0];
  };
  return {share(ones, zeros), share(zeros, ones)};
}

ContactImpulse::ContactImpulse(const Experiment& experiment)
    : shares_(experiment.contact ? gather_shares(experiment) : GatherShares()) {}

void ContactImpulse::add(const Vector3& impulse) {
  for (std::size_t c = 0; c < 3; ++c) now_[c] += impulse[c];
}

void ContactImpulse::before_forces(const ContactGiven& given, bool filtered, Ledger* ledger) {
  before_ = now_ = given.impulse;
  friction_ = given.dissipated;
  if (!ledger) return;
  const double kept = filtered ? 1.0 : shares_.of_velocity;
  ledger->friction += kept * given.dissipated;
  ledger->friction_taken_back += (1 - kept) * given.dissipated;
}

void ContactImpulse::after_forces(const ContactGiven& given, Ledger* ledger) {
  add(given.impulse);
  friction_ += given.dissipated;
  if (ledger) ledger->friction += given.dissipated;
}

void ContactImpulse::in_filter(const ContactGiven& given, bool replaces, Ledger* ledger) {
  if (replaces && ledger) ledger->friction -= friction_;
  if (replaces) now_ = {}, friction_ = 0;
  after_forces(given, ledger);
}

void ContactImpulse::restore(bool keeps_correction) {
  friction_ = kept_friction_;
  const Vector3 filtered = now_;
  now_ = kept_;
  if (!keeps_correction) return;
  for (std::size_t c = 0; c < 3; ++c) kept_[c] = filtered[c] - kept_[c];
}

Vector3 ContactImpulse::handed_over(bool filtered) const {
  const GatherShares shares = filtered ? GatherShares() : shares_;
  Vector3 sum{};
  for (std::size_t c = 0; c < 3; ++c)
    sum[c] = shares.of_velocity * now_[c] + shares.of_increment * (now_[c] - before_[c]);
  return sum;
}

}  // namespace mpm
