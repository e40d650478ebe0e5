#pragma once
// All that a particle does between two scatters, in one launch: what one part finds goes to the next in registers, and
// the particle crosses memory once. Each part is that of a phase of its own (kernels/gather.hpp, material.hpp, sorting.hpp).

#include "backends/device/kernels/gather.hpp"
#include "backends/device/kernels/material.hpp"
#include "backends/device/kernels/sorting.hpp"

namespace mpm::device {

/// Gathers, strains and moves; finds the stress and the block that the next scatter asks for.
template <class Scene>
MPM_HD void advance(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using Material = typename Scene::Material;
  const typename Material::template Constants<typename Scene::Scalar> constants(
      parameters_of<Material>(a.material_parameters));
  for_each_index(team, a.particles.count, [&](int p) {
    Gathered<Scene> gathered{};
    if (!gather_particle<Scene>(a, p, gathered)) return report(a, p);
    auto state = load_material_state<Scene>(a.particles, p);
    strain_particle<Scene>(a, p, constants, state, with_hoop_rate<Scene>(gathered.gradient, gathered.hoop_rate));
    if (!keep_volume_ratio<Scene>(a, p, state)) return report(a, p, part_of_strain);
    keep_stress<Scene>(a, p, constants, state);
    if (!move_particle<Scene>(a, p, gathered.advection)) return report(a, p, a.part_of_move);
    find_block<Scene>(a, p);
  });
}

}  // namespace mpm::device
