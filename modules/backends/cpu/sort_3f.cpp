#include "seeding.hpp"
#include "sort.hpp"

namespace mpm::cpu {
template void seed_particles<3, float>(Particles<3, float>&, const SeededBody&, const Domain&,
                                       const std::vector<float>&, int);
template bool sort_particles<3, float>(Particles<3, float>&, SortSpace&, const Scene<3, float>&, bool,
                                       const Foresight<float>&);
}  // namespace mpm::cpu
