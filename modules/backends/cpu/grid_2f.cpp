#include "grid_contact.hpp"
#include "grid_edges.hpp"
#include "grid_filter.hpp"
#include "grid_forces.hpp"

namespace mpm::cpu {
template class Grid<2, float>;
template class GridStep<2, float>;
}  // namespace mpm::cpu
