#include "bench/counting/boundary.hpp"

#include <cstring>

namespace mpm::counting {
namespace {

/// What is counted, and what is called, is global, since a plugin's function has no place for a context.
struct Attached {
  const mpm_shape* shape = nullptr;
  const mpm_transfer* transfer = nullptr;
  const mpm_filter* filter = nullptr;
  const mpm_contact* contact = nullptr;
  const mpm_material* material = nullptr;
};
Attached attached;
const Registry* originals = nullptr;

enum Entry {
  shape_calls,
  shape_gradients,
  shape_moments,
  scatter_calls,
  scatter_affine,
  gather_calls,
  gather_increment,
  gather_affine,
  gather_gradient,
  filter_calls,
  contact_calls,
  material_calls,
  material_advance,
  material_stress,
  material_stored,
  material_dissipated,
  material_wave_speed,
  material_volume_ratio,
  entry_count
};
constexpr const char* entry_names[entry_count] = {"shape",
                                                  "shape: gradients",
                                                  "shape: second moment",
                                                  "transfer: scatter",
                                                  "transfer: scatter, affine",
                                                  "transfer: gather",
                                                  "transfer: gather, increment",
                                                  "transfer: gather, affine",
                                                  "transfer: gather, gradient",
                                                  "filter",
                                                  "contact",
                                                  "material",
                                                  "material: advance",
                                                  "material: stress",
                                                  "material: stored energy",
                                                  "material: dissipated energy",
                                                  "material: wave speed",
                                                  "material: volume ratio"};
long counts[entry_count];

void count(Entry entry, const void* asked) {
  counts[entry] += asked != nullptr;
}

template <int P>
void evaluate(const void* parameters, const mpm_shape_batch* batch) {
  ++counts[shape_calls];
  count(shape_gradients, batch->gradient), count(shape_moments, batch->second_moment);
  attached.shape->evaluate[P](parameters, batch);
}
template <int P, int D>
void evaluate_list(const void* parameters, const mpm_list_batch* batch) {
  ++counts[shape_calls];
  count(shape_gradients, batch->gradient), count(shape_moments, batch->second_moment);
  attached.shape->evaluate_list[P][D](parameters, batch);
}
template <int P, int D>
void scatter(const void* parameters, const mpm_scatter_batch* batch) {
  ++counts[scatter_calls];
  count(scatter_affine, batch->A);
  attached.transfer->scatter[P][D](parameters, batch);
}
template <int P, int D>
void gather(const void* parameters, const mpm_gather_batch* batch) {
  ++counts[gather_calls];
  count(gather_increment, batch->velocity_increment), count(gather_affine, batch->affine);
  count(gather_gradient, batch->velocity_gradient);
  attached.transfer->gather[P][D](parameters, batch);
}
template <int P, int D>
void update_filter(const void* parameters, const mpm_filter_batch* batch) {
  ++counts[filter_calls];
  attached.filter->update[P][D](parameters, batch);
}
template <int P, int D>
void apply_contact(const void* parameters, const mpm_contact_batch* batch) {
  ++counts[contact_calls];
  attached.contact->apply[P][D](parameters, batch);
}
template <int P, int D>
std::int32_t update_material(const void* parameters, const mpm_material_batch* batch) {
  ++counts[material_calls];
  count(material_advance, batch->velocity_gradient), count(material_stress, batch->kirchhoff_stress);
  count(material_stored, batch->stored_energy), count(material_dissipated, batch->dissipated_energy);
  count(material_wave_speed, batch->wave_speed), count(material_volume_ratio, batch->volume_ratio);
  return attached.material->update[P][D](parameters, batch);
}

/// Puts make<P, D>() in every place of a table of functions that is filled.
template <class Function, class Make>
void replace(Function (&functions)[MPM_PRECISIONS][2], Make&& make) {
  static_assert(MPM_PRECISIONS == 3);
  const Function made[3][2] = {{make.template operator()<0, 0>(), make.template operator()<0, 1>()},
                               {make.template operator()<1, 0>(), make.template operator()<1, 1>()},
                               {make.template operator()<2, 0>(), make.template operator()<2, 1>()}};
  for (int p = 0; p < 3; ++p)
    for (int d = 0; d < 2; ++d)
      if (functions[p][d]) functions[p][d] = made[p][d];
}

}  // namespace

struct CountedPlugins::Copy {
  mpm_descriptor descriptor{};
  mpm_shape shape{};
  mpm_transfer transfer{};
  mpm_filter filter{};
  mpm_contact contact{};
  mpm_material material{};
  Plugin plugin;

  explicit Copy(const Plugin& original) : descriptor(*original.descriptor), plugin(original) {
    switch (descriptor.kind) {
      case MPM_SHAPE: {
        shape = original.shape();
        void (*const tensor[])(const void*, const mpm_shape_batch*) = {evaluate<0>, evaluate<1>, evaluate<2>};
        for (int p = 0; p < MPM_PRECISIONS; ++p)
          if (shape.evaluate[p]) shape.evaluate[p] = tensor[p];
        replace(shape.evaluate_list, []<int P, int D>() { return &evaluate_list<P, D>; });
        descriptor.kind_table = &shape;
        break;
      }
      case MPM_TRANSFER:
        transfer = original.transfer();
        replace(transfer.scatter, []<int P, int D>() { return &scatter<P, D>; });
        replace(transfer.gather, []<int P, int D>() { return &gather<P, D>; });
        descriptor.kind_table = &transfer;
        break;
      case MPM_FILTER:
        filter = original.filter();
        replace(filter.update, []<int P, int D>() { return &update_filter<P, D>; });
        descriptor.kind_table = &filter;
        break;
      case MPM_CONTACT:
        contact = original.contact();
        replace(contact.apply, []<int P, int D>() { return &apply_contact<P, D>; });
        descriptor.kind_table = &contact;
        break;
      case MPM_MATERIAL:
        material = original.material();
        replace(material.update, []<int P, int D>() { return &update_material<P, D>; });
        descriptor.kind_table = &material;
        break;
      default:
        break;
    }
    plugin.descriptor = &descriptor;
  }
};

CountedPlugins::CountedPlugins(const Registry& registry) {
  originals = &registry;
  for (const Plugin& plugin : registry.plugins()) copies_.push_back(std::make_unique<Copy>(plugin));
}
CountedPlugins::~CountedPlugins() = default;

ComponentLookup CountedPlugins::lookup() const {
  std::vector<const Plugin*> plugins;
  for (const auto& copy : copies_) plugins.push_back(&copy->plugin);
  return ComponentLookup(std::move(plugins));
}

void CountedPlugins::attach(const Experiment& experiment) const {
  const auto original = [](mpm_kind kind, const Component& component) {
    return originals->find(kind, component.plugin->id());
  };
  attached = {};
  attached.shape = &original(MPM_SHAPE, experiment.shape)->shape();
  attached.transfer = &original(MPM_TRANSFER, experiment.transfer)->transfer();
  attached.material = &original(MPM_MATERIAL, experiment.materials.front().component)->material();
  if (experiment.filter) attached.filter = &original(MPM_FILTER, *experiment.filter)->filter();
  if (experiment.meets()) {
    const Component& law = experiment.contact ? *experiment.contact : experiment.rigid_bodies.front().contact;
    attached.contact = &original(MPM_CONTACT, law)->contact();
  }
  clear();
}

void CountedPlugins::clear() const {
  std::memset(counts, 0, sizeof counts);
}

Calls CountedPlugins::calls() const {
  Calls calls;
  for (int entry = 0; entry < entry_count; ++entry)
    if (counts[entry] != 0) calls[entry_names[entry]] = counts[entry];
  return calls;
}

}  // namespace mpm::counting
