#include "simulation/contact_impulse.hpp"

#include <vector>

#include "plugin/abi.h"
#include "plugin/registry.hpp"

namespace mpm {

namespace {

template <std::size_t n>
void add(std::array<double, n>& sum, const std::array<double, n>& more) {
  for (std::size_t c = 0; c < n; ++c) sum[c] += more[c];
}

}  // namespace

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
    : shares_(experiment.meets() ? gather_shares(experiment) : GatherShares()),
      flows_(recorded_pairs(experiment)),
      records_(flows_.size()) {}

ContactImpulse::Momentum ContactImpulse::momentum_of(const PairGiven& given) {
  const Vector3 &all = given.impulse, &along = given.along, &gained = given.unbalanced;
  return {all[0], all[1], all[2], along[0], along[1], along[2], given.pressing, gained[0], gained[1], gained[2]};
}

template <class Visit>
void ContactImpulse::for_each_flow(const ContactGiven& given, Visit visit) {
  visit(total_, momentum_of({.impulse = given.impulse}));
  for (std::size_t k = 0; k < flows_.size(); ++k) visit(flows_[k], momentum_of(given.pairs[k]));
  for (std::size_t k = 0; k < node_flows_.size(); ++k)
    visit(node_flows_[k], momentum_of({.impulse = given.nodes.at(k).impulse}));
}

template <class Visit>
void ContactImpulse::for_each_flow(Visit visit) {
  visit(total_);
  for (Flow& flow : flows_) visit(flow);
  for (Flow& flow : node_flows_) visit(flow);
}

void ContactImpulse::book(Ledger& ledger, const ContactGiven& given, double share) {
  ledger.friction += share * given.dissipated;
  ledger.rigid_bodies += share * given.driven;
  ledger.contact -= share * given.driven;
  ledger.interface += share * given.stored;
}

void ContactImpulse::before_forces(const ContactGiven& given, bool filtered, Ledger* ledger) {
  node_flows_.resize(given.nodes.size());
  for_each_flow(given, [](Flow& flow, const Momentum& momentum) { flow.before = flow.now = momentum; });
  friction_ = given.dissipated, driven_ = given.driven, stored_ = given.stored;
  if (!ledger) return;
  const double kept = filtered ? 1.0 : shares_.of_velocity;
  book(*ledger, given, kept);
  ledger->friction_taken_back += (1 - kept) * given.dissipated;
}

void ContactImpulse::after_forces(const ContactGiven& given, Ledger* ledger) {
  for_each_flow(given, [](Flow& flow, const Momentum& momentum) { add(flow.now, momentum); });
  friction_ += given.dissipated, driven_ += given.driven, stored_ += given.stored;
  if (ledger) book(*ledger, given, 1);
}

void ContactImpulse::in_filter(const ContactGiven& given, bool replaces, Ledger* ledger) {
  if (replaces && ledger) book(*ledger, {.dissipated = friction_, .driven = driven_, .stored = stored_}, -1);
  if (replaces) {
    for_each_flow(given, [](Flow& flow, const Momentum&) { flow.now = {}; });
    friction_ = driven_ = stored_ = 0;
  }
  after_forces(given, ledger);
}

void ContactImpulse::keep() {
  for_each_flow([](Flow& flow) { flow.kept = flow.now; });
  kept_friction_ = friction_, kept_driven_ = driven_, kept_stored_ = stored_;
}

void ContactImpulse::restore(bool keeps_correction) {
  friction_ = kept_friction_, driven_ = kept_driven_, stored_ = kept_stored_;
  for_each_flow([&](Flow& flow) {
    const Momentum filtered = flow.now;
    flow.now = flow.kept;
    if (!keeps_correction) return;
    for (std::size_t c = 0; c < filtered.size(); ++c) flow.kept[c] = filtered[c] - flow.kept[c];
  });
}

void ContactImpulse::add_correction() {
  for_each_flow([](Flow& flow) { add(flow.now, flow.kept); });
}

ContactImpulse::Momentum ContactImpulse::handed_over(const Flow& flow, bool filtered) const {
  const GatherShares shares = filtered ? GatherShares() : shares_;
  Momentum sum{};
  for (std::size_t c = 0; c < sum.size(); ++c)
    sum[c] = shares.of_velocity * flow.now[c] + shares.of_increment * (flow.now[c] - flow.before[c]);
  return sum;
}

void ContactImpulse::record_counts(const ContactGiven& given) {
  before_step_ = records_;
  for (std::size_t k = 0; k < records_.size(); ++k) {
    const PairGiven& pair = given.pairs[k];
    PairRecord& record = records_[k];
    record.nodes = pair.sticking + pair.slipping, record.sticking = pair.sticking, record.slipping = pair.slipping;
    record.largest_penetration = pair.largest_penetration, record.largest_gap = pair.largest_gap;
    record.area = pair.area;
  }
  nodes_.clear();
  for (const NodeGiven& given_here : given.nodes) nodes_.push_back(given_here.node);
}

void ContactImpulse::record_forces(bool filtered, double dt) {
  for (std::size_t k = 0; k < records_.size(); ++k) {
    const Momentum momentum = handed_over(flows_[k], filtered);
    const PairRecord& before = before_step_[k];
    PairRecord& record = records_[k];
    for (std::size_t c = 0; c < 3; ++c) {
      const double impulse = momentum[c], tangential = impulse - momentum[3 + c];
      record.force[c] = impulse / dt, record.impulse[c] = before.impulse[c] + impulse;
      record.tangential_force[c] = tangential / dt;
      record.tangential_impulse[c] = before.tangential_impulse[c] + tangential;
      record.unbalanced_impulse[c] = before.unbalanced_impulse[c] + momentum[7 + c];
    }
    record.normal_force = momentum[6] / dt, record.normal_impulse = before.normal_impulse + momentum[6];
  }
  for (std::size_t k = 0; k < nodes_.size(); ++k) {
    const Momentum momentum = handed_over(node_flows_[k], filtered);
    for (std::size_t c = 0; c < 3; ++c) nodes_[k].force[c] = momentum[c] / dt;
  }
}

}  // namespace mpm
