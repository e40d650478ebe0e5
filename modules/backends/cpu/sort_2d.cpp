#include "sort.hpp"

namespace mpm::cpu {
template void seed_particles<2, double>(Particles<2, double>&, const SeededBody&, const Domain&);
template void sort_particles<2, double>(Particles<2, double>&, Particles<2, double>&, const Scene<2, double>&);
}  // namespace mpm::cpu
