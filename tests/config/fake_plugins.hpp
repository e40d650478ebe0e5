#pragma once
// Plugins that only declare: what reading an experiment needs of them, without loading a file.

#include <vector>

#include "experiment/read.hpp"
#include "solvers/solver.hpp"

namespace mpm::test {

inline mpm_parameter number(const char* name, const char* unit, double standard, double minimum, double maximum,
                            std::uint32_t flags, std::uint32_t slot) {
  return {name, unit, "A number.", "", MPM_NUMBER, flags, slot * 8, 0, standard, minimum, maximum};
}

inline const mpm_parameter elastic_parameters[] = {
    number("density", "kg/m^3", 0, 0, 1e9, MPM_REQUIRED | MPM_ABOVE_MINIMUM, 0),
    number("youngs_modulus", "Pa", 0, 0, 1e15, MPM_REQUIRED | MPM_ABOVE_MINIMUM, 1),
    number("poisson_ratio", "", 0.3, -1, 0.5, MPM_ABOVE_MINIMUM | MPM_BELOW_MAXIMUM, 2),
    {"form", "", "Named form.", "standard|logarithmic", MPM_CHOICE, 0, 24, 0, 1, 0, 1},
};
inline const mpm_parameter pic_fraction[] = {number("pic_fraction", "", 0, 0, 1, 0, 0)};
inline const mpm_parameter friction[] = {number("friction", "", 0, 0, 10, MPM_REQUIRED, 0)};
inline const mpm_parameter direction[] = {number("x", "", 0, -1, 1, MPM_REQUIRED, 0)};
inline const mpm_parameter iterations[] = {
    {"iterations", "", "Passes.", "", MPM_INTEGER, 0, 0, 0, 3, 1, 20},
    {"quadratic", "", "Second order.", "", MPM_BOOLEAN, 0, 8, 0, 1, 0, 1},
};

constexpr std::uint32_t every_precision = 7, both = MPM_2D | MPM_3D;

inline const mpm_contact plain_law{};

inline mpm_descriptor descriptor(const char* id, mpm_kind kind, std::uint32_t dimensions, std::uint32_t precisions,
                                 const mpm_parameter* parameters, std::uint32_t count) {
  mpm_descriptor made{id,         "1.0.0",    "A test plugin.",
                      "",         "",         static_cast<std::uint32_t>(kind),
                      dimensions, precisions, 0,
                      parameters, count,      count * 8,
                      nullptr,    0,          0,
                      nullptr,    "Functor",  "// what backend cuda would compile",
                      nullptr};
  if (kind == MPM_CONTACT) made.kind_table = &plain_law;
  return made;
}

inline const mpm_descriptor descriptors[] = {
    descriptor("linear", MPM_SHAPE, both, every_precision, nullptr, 0),
    descriptor("bspline_quadratic", MPM_SHAPE, both, every_precision, nullptr, 0),
    descriptor("only_flat", MPM_SHAPE, MPM_2D, every_precision, nullptr, 0),
    descriptor("flip", MPM_TRANSFER, both, every_precision, pic_fraction, 1),
    descriptor("apic", MPM_TRANSFER, both, every_precision, nullptr, 0),
    descriptor("slow_double", MPM_TRANSFER, both, 1u << MPM_SCALAR_DOUBLE, iterations, 2),
    descriptor("coulomb", MPM_CONTACT, both, every_precision, friction, 1),
    descriptor("average_volume_gradient", MPM_NORMAL, both, every_precision, nullptr, 0),
    descriptor("widest_gap", MPM_NORMAL, both, every_precision, nullptr, 0),
    descriptor("given", MPM_NORMAL, both, every_precision, direction, 1),
    descriptor("approach_and_position", MPM_DETECTION, both, every_precision, nullptr, 0),
    descriptor("particle_surfaces", MPM_DETECTION, both, every_precision, nullptr, 0),
    descriptor("neo_hookean", MPM_MATERIAL, both, every_precision, elastic_parameters, 4),
    descriptor("linear_elastic", MPM_MATERIAL, both, every_precision, elastic_parameters, 4),
};

inline const ComponentLookup& components() {
  static const std::vector<Plugin> plugins = [] {
    std::vector<Plugin> all;
    for (const mpm_descriptor& one : descriptors) all.push_back({&one, "test"});
    return all;
  }();
  static const ComponentLookup lookup([] {
    std::vector<const Plugin*> all;
    for (const Plugin& plugin : plugins) all.push_back(&plugin);
    return all;
  }());
  return lookup;
}

/// Reading options as the program would give them.
inline ReadOptions options(std::vector<std::string> overrides = {}) {
  ReadOptions result;
  result.solvers = solver_descriptions();
  result.overrides = std::move(overrides);
  result.figures = {"energy", "dissipation", "contact"};
  result.colour_quantities = {"speed", "pressure", "density"};
  result.exact = {{"rolling",
                   "A rolling disc.",
                   {parameter("start", ParameterType::number, "s", "When it starts.").standard(0.0)}}};
  return result;
}

}  // namespace mpm::test
