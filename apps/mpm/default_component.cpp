#include "mpm/default_component.hpp"

#include <vector>

#include "experiment/diagnostics.hpp"

namespace mpm::app {

Component default_component(const Plugin& plugin) {
  Component component;
  component.plugin = &plugin;
  component.parameters.assign((plugin.descriptor->parameter_bytes + 7) / 8, 0.0);
  for (const mpm_parameter& parameter : plugin.parameters())
    component.parameters[parameter.offset / sizeof(double)] = parameter.default_value;
  return component;
}

Component default_shape(const Registry& registry, const std::string& id, Shapes among) {
  std::vector<std::string> names;
  for (const Plugin* plugin : registry.of_kind(MPM_SHAPE)) {
    if (among == Shapes::tensor_products && plugin->shape().form == MPM_NODE_LIST) continue;
    if (plugin->id() == id) return default_component(*plugin);
    names.emplace_back(plugin->id());
  }
  const std::string what = among == Shapes::all ? "shape" : "shape that is a tensor product";
  throw PluginError("no " + what + " is called " + in_quotes(id) + did_you_mean(id, names) + "; they are " +
                    quoted_list(names));
}

}  // namespace mpm::app
