#include "particle_gather.hpp"
#include "particle_scatter.hpp"

namespace mpm::cpu {
template class ParticleStep<3, double>;
}  // namespace mpm::cpu
