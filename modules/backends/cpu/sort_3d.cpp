#include "seeding.hpp"
#include "sort.hpp"

namespace mpm::cpu {
template void seed_particles<3, double>(Particles<3, double>&, const SeededBody&, const Domain&,
                                        const std::vector<double>&, int);
template bool sort_particles<3, double>(Particles<3, double>&, SortSpace&, const Scene<3, double>&, bool,
                                        const Foresight<double>&);
}  // namespace mpm::cpu
