#include "grid_contact.hpp"
#include "grid_edges.hpp"
#include "grid_filter.hpp"
#include "grid_forces.hpp"

namespace mpm::cpu {
template class Grid<3, float>;
template class GridStep<3, float>;
}  // namespace mpm::cpu
