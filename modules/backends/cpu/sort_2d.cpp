#include "seeding.hpp"
#include "sort.hpp"

namespace mpm::cpu {
template void seed_particles<2, double>(Particles<2, double>&, const SeededBody&, const Domain&,
                                        const std::vector<double>&, int);
template bool sort_particles<2, double>(Particles<2, double>&, SortSpace&, const Scene<2, double>&, bool,
                                        const Foresight<double>&);
}  // namespace mpm::cpu
