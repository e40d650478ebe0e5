#include "mpm/remedy.hpp"

#include <utility>

namespace mpm::app {
namespace {

/// Beginnings of causes with their remedies. The backends word their causes alike; each begins with one of these.
constexpr std::pair<const char*, const char*> remedies[] = {
    {"not a number",
     "check the expressions of the file (velocities, /body_force, moving walls) at that place and time; where they are "
     "finite, a smaller /solver/courant or /solver/time_step"},
    {"left the domain",
     "a larger /grid/domain, or a wall that holds the material (/grid/boundaries); where a particle flew off that "
     "should "
     "not have, a smaller /solver/courant or /solver/time_step"},
    {"its domain has grown too long",
     "/shape/type \"cpdi\", or more particles a cell (particles_per_cell_axis of the body), so that a longer stretch "
     "fits "
     "the stencil; a smaller step changes nothing where the stretch is meant"},
    {"its domain reaches",
     "a larger /grid/domain, more particles a cell (particles_per_cell_axis of the body), so that a domain is shorter, "
     "or a shape whose domain does not follow the deformation (\"gimp\"); a smaller step changes nothing where the "
     "stretch is meant"},
};

}  // namespace

std::string remedy_for(const std::string& cause) {
  for (const auto& [begin, remedy] : remedies)
    if (cause.starts_with(begin)) return std::string("remedy: ") + remedy;
  return "remedy: a smaller /solver/courant or /solver/time_step, a transfer with more damping, or a material that is "
         "stiffer when crushed";
}

}  // namespace mpm::app
