#include "sort.hpp"

namespace mpm::cpu {
template void seed_particles<3, float>(Particles<3, float>&, const SeededBody&, const Domain&);
template void sort_particles<3, float>(Particles<3, float>&, Particles<3, float>&, const Scene<3, float>&);
}  // namespace mpm::cpu
