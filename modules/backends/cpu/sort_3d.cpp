#include "sort.hpp"

namespace mpm::cpu {
template void seed_particles<3, double>(Particles<3, double>&, const SeededBody&, const Domain&);
template void sort_particles<3, double>(Particles<3, double>&, Particles<3, double>&, const Scene<3, double>&);
}  // namespace mpm::cpu
