#include "plan/compatibility.hpp"

#include <algorithm>

#include "experiment/problem_at.hpp"
#include "plugin/extension_of.hpp"

namespace mpm {
namespace {

std::string named(const char* kind, const Plugin& plugin) {
  return std::string(kind) + " \"" + std::string(plugin.id()) + "\"";
}

/// All orders that the choices among a transfer's parameters ask for, other parameters at their defaults.
std::vector<int> basis_orders_of(const Plugin& transfer) {
  const auto* polynomials = extension_of<mpm_transfer_polynomials>(transfer);
  if (!polynomials) return {0};
  const auto order_of = polynomials->order;
  std::vector<double> block(transfer.descriptor->parameter_bytes / sizeof(double));
  for (const mpm_parameter& parameter : transfer.parameters())
    block[parameter.offset / sizeof(double)] =
        parameter.default_value == parameter.default_value ? parameter.default_value : parameter.minimum;
  std::vector<int> orders{order_of(block.data())};
  for (const mpm_parameter& parameter : transfer.parameters()) {
    if (parameter.type != MPM_CHOICE) continue;
    const std::string choices = parameter.choices;
    std::vector<double> chosen = block;
    for (long k = std::count(choices.begin(), choices.end(), '|'); k >= 0; --k) {
      chosen[parameter.offset / sizeof(double)] = static_cast<double>(k);
      const int order = order_of(chosen.data());
      if (std::find(orders.begin(), orders.end(), order) == orders.end()) orders.push_back(order);
    }
  }
  return orders;
}

}  // namespace

std::optional<Refusal> refusal_of(const Mix& mix) {
  const mpm_shape& shape = mix.shape->shape();
  if (shape.form == MPM_TENSOR_PRODUCT && (shape.width < 2 || shape.width > 4))
    return Refusal{MPM_SHAPE, named("shape", *mix.shape) + " has " + std::to_string(shape.width) +
                                  " nodes an axis; backends run 2 to 4"};
  if (mix.basis_order > 0 && shape.form == MPM_NODE_LIST)
    return Refusal{MPM_TRANSFER, named("transfer", *mix.transfer) +
                                     " carries products of polynomials along the axes, and the nodes of " +
                                     named("shape", *mix.shape) +
                                     " have no axes; choose a shape that is a tensor product, e.g. "
                                     "\"bspline_quadratic\", or transfer \"apic\""};
  if (mix.basis_order > 1 && (mix.shape->descriptor->needs & (MPM_NEEDS_HALF_SIZE | MPM_NEEDS_DOMAIN)))
    return Refusal{MPM_TRANSFER,
                   named("transfer", *mix.transfer) +
                       " with powers above 1 takes them from all nodes of a stencil, and outer weights of " +
                       named("shape", *mix.shape) +
                       " vanish where a box does not reach them; choose basis \"multilinear\" or a "
                       "shape without a particle size, e.g. \"bspline_quadratic\""};
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

void refuse(const Experiment& experiment, const std::string& pointer, const std::string& message) {
  throw InputError({problem_at(experiment, pointer, message)});
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
              for (const int order : basis_orders_of(*transfer))
                if (filter || every_step) mixes.push_back({shape, transfer, filter, law, update, every_step, order});
  return mixes;
}

}  // namespace mpm
