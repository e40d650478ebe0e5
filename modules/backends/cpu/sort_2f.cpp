#include "seeding.hpp"
#include "sort.hpp"

namespace mpm::cpu {
template void seed_particles<2, float>(Particles<2, float>&, const SeededBody&, const Domain&,
                                       const std::vector<float>&, int);
template bool sort_particles<2, float>(Particles<2, float>&, SortSpace&, const Scene<2, float>&, bool,
                                       const Foresight<float>&);
}  // namespace mpm::cpu
