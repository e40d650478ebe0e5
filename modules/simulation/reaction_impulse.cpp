#include "simulation/reaction_impulse.hpp"

#include <algorithm>
#include <string>

#include "operators/supports.hpp"
#include "plugin/abi.h"
#include "plugin/registry.hpp"

namespace mpm {
namespace {

/// Asks the scene's filter for the velocity that one pass adds where the projection is 1 and the increment 0.
double share_of_projection(const Component& filter, int dimension, int iteration) {
  constexpr std::size_t n = MPM_LANES;
  const auto D = static_cast<std::size_t>(dimension);
  const std::vector<double> projected(D * n, 1.0);
  std::vector<double> increment(D * n), velocity(D * n);
  const mpm_filter_batch batch{n,
                               n,
                               static_cast<std::uint32_t>(dimension),
                               static_cast<std::uint32_t>(iteration),
                               projected.data(),
                               increment.data(),
                               velocity.data()};
  filter.plugin->filter().update[MPM_SCALAR_DOUBLE][D - 2](filter.parameters.data(), &batch);
  return velocity[0];
}

}  // namespace

void SupportImpulses::add(int support, const Vector3& place, const Vector3& impulse, double factor) {
  Sum& sum = sums_[static_cast<std::size_t>(support)];
  add_impulse(sum.impulse.data(), sum.moment.data(), place.data(), impulse.data(), factor);
}

void SupportImpulses::add_sum(int support, const Vector3& impulse, const Vector3& moment) {
  Sum& sum = sums_[static_cast<std::size_t>(support)];
  for (std::size_t c = 0; c < 3; ++c) sum.impulse[c] += impulse[c], sum.moment[c] += moment[c];
}

void SupportImpulses::add(const SupportImpulses& other, double factor) {
  for (std::size_t support = 0; support < sums_.size(); ++support)
    for (std::size_t c = 0; c < 3; ++c) {
      sums_[support].impulse[c] += factor * other.sums_[support].impulse[c];
      sums_[support].moment[c] += factor * other.sums_[support].moment[c];
    }
}

ReactionImpulse::ReactionImpulse(const Experiment& experiment) : experiment_(experiment) {
  if (!experiment.notes_reactions()) return;
  shares_ = gather_shares(experiment);
  record_.resize(experiment.supports().size());
  impulse_before_.resize(record_.size());
  for (SupportImpulses* sums : {&mirrored_, &held_, &forces_, &before_, &kept_mirrored_, &kept_held_, &projected_,
                                &gathered_, &gathered_increment_})
    *sums = SupportImpulses(record_.size());
}

void ReactionImpulse::begin_step() {
  for (SupportImpulses* sums : {&mirrored_, &held_, &forces_, &before_}) sums->clear();
  for (std::size_t k = 0; k < record_.size(); ++k) impulse_before_[k] = record_[k].impulse;
}

void ReactionImpulse::add(GivenBySupport what, int support, const Vector3& impulse, const Vector3& moment) {
  SupportImpulses* const sums[] = {&held_, &mirrored_, &forces_, &projected_, &gathered_, &gathered_increment_};
  sums[static_cast<std::size_t>(what)]->add_sum(support, impulse, moment);
}

void ReactionImpulse::keep_before() {
  before_ = mirrored_;
  before_.add(held_);
}

void ReactionImpulse::apply_forces(double dt) {
  mirrored_.add(forces_, dt);
  forces_.clear();
}

void ReactionImpulse::take_projection(int iteration) {
  mirrored_.add(projected_, share_of_projection(*experiment_.filter, experiment_.dimension, iteration));
}

void ReactionImpulse::restore(bool keeps_correction) {
  std::swap(mirrored_, kept_mirrored_);
  std::swap(held_, kept_held_);
  if (!keeps_correction) return;
  kept_mirrored_.add(mirrored_, -1);
  kept_held_.add(held_, -1);
}

void ReactionImpulse::add_correction() {
  mirrored_.add(kept_mirrored_);
  held_.add(kept_held_);
}

void ReactionImpulse::begin_gather() {
  gathered_.clear();
  gathered_increment_.clear();
}

void ReactionImpulse::record(const StepInfo& step) {
  const GatherShares shares = step.filtered ? GatherShares() : shares_;
  SupportImpulses taken(record_.size());
  for (const SupportImpulses* given : {&mirrored_, &held_}) taken.add(*given, shares.of_velocity + shares.of_increment);
  taken.add(before_, -shares.of_increment);
  taken.add(gathered_, shares.of_velocity);
  taken.add(gathered_increment_, shares.of_increment);
  for (std::size_t k = 0; k < record_.size(); ++k) {
    const Vector3 impulse = taken.impulse(k), moment = taken.moment(k);
    for (std::size_t c = 0; c < 3; ++c) {
      record_[k].force[c] = impulse[c] / step.dt;
      record_[k].moment[c] = moment[c] / step.dt;
      record_[k].impulse[c] = impulse_before_[k][c] + impulse[c];
    }
  }
}

void ReactionImpulse::give_particles(int support, const GivenToGripped& given, double dt) {
  if (!asked()) return;
  Reaction& reaction = record_[static_cast<std::size_t>(support)];
  for (std::size_t c = 0; c < 3; ++c) {
    reaction.force[c] += given.impulse[c] / dt;
    reaction.moment[c] += given.moment[c] / dt;
    reaction.impulse[c] += given.impulse[c];
  }
}

}  // namespace mpm
