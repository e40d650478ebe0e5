#pragma once
// A plugin as an experiment has it that names it and says no more.

#include <string>

#include "experiment/experiment.hpp"

namespace mpm::app {

/// The plugin with the default of each of its parameters, and zero for one that has none.
Component default_component(const Plugin& plugin);

enum class Shapes { all, tensor_products };

/// The shape of that name among those, with its defaults. Throws PluginError that lists them and names the nearest.
Component default_shape(const Registry& registry, const std::string& id, Shapes among);

}  // namespace mpm::app
