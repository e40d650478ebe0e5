#pragma once
// Why a run stops whose particle has outgrown the stencil of its shape: the same words on every backend.

#include <string>

#include "plugin/registry.hpp"

namespace mpm {

/// For a shape whose stencil follows the deformation of the particle, see mpm_shape_batch.
inline std::string domain_too_long(const Plugin& shape) {
  return "its domain has grown too long for the " + std::to_string(shape.shape().width) + " nodes an axis of shape \"" +
         std::string(shape.id()) + "\"; choose smaller particles or a shape without that bound (\"cpdi\")";
}

/// For a shape whose domains have corners that move (mpm_shape::sample_points).
inline std::string domain_inside_out(const Plugin& shape) {
  return "its domain is turned inside out: the corners that shape \"" + std::string(shape.id()) +
         "\" moves with the grid have passed one another; choose a smaller step, or a shape that follows F (\"cpdi\")";
}

}  // namespace mpm
