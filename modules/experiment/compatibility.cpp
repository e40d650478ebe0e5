#include "experiment/compatibility.hpp"

namespace mpm {
namespace {

std::string named(const char* kind, const Plugin& plugin) {
  return std::string(kind) + " \"" + std::string(plugin.id()) + "\"";
}

}  // namespace

std::optional<Refusal> refusal_of(const Mix& mix) {
  const mpm_shape& shape = mix.shape->shape();
  if (shape.form == MPM_TENSOR_PRODUCT && (shape.width < 2 || shape.width > 4))
    return Refusal{MPM_SHAPE, named("shape", *mix.shape) + " has " + std::to_string(shape.width) +
                                  " nodes an axis; backends run 2 to 4"};
  // FLIP takes changes of the grid's velocity and a filter replaces the particles' velocity: both at every step is the
  // filter alone.
  const bool increments = mix.transfer->transfer().traits & MPM_GATHERS_INCREMENT;
  if (mix.filter && increments && mix.filtered_every_step)
    return Refusal{MPM_FILTER,
                   named("filter", *mix.filter) + " at every step leaves nothing of " +
                       named("transfer", *mix.transfer) +
                       ", whose increments it would replace each time; filter periodically (\"every_steps\": 4) or "
                       "choose transfer " +
                       (mix.transfer->transfer().traits & MPM_SCATTERS_AFFINE ? "\"apic\"" : "\"pic\"")};
  return std::nullopt;
}

std::vector<Mix> all_mixes(const Registry& registry) {
  std::vector<const Plugin*> laws = registry.of_kind(MPM_CONTACT), filters = registry.of_kind(MPM_FILTER);
  laws.insert(laws.begin(), nullptr);
  filters.insert(filters.begin(), nullptr);
  std::vector<Mix> mixes;
  for (const Plugin* shape : registry.of_kind(MPM_SHAPE))
    for (const Plugin* transfer : registry.of_kind(MPM_TRANSFER))
      for (const Plugin* filter : filters)
        for (const bool every_step : {true, false})
          for (const Plugin* law : laws)
            for (const StressUpdate update :
                 {StressUpdate::first, StressUpdate::last, StressUpdate::modified_last, StressUpdate::averaged})
              if (filter || every_step) mixes.push_back({shape, transfer, filter, law, update, every_step});
  return mixes;
}

}  // namespace mpm
