#include "experiment/contact_settings.hpp"

#include "experiment/diagnostics.hpp"

namespace mpm {

double strain_cap_of(const Experiment& experiment) {
  const auto contact = experiment.resolved.find("contact");
  return contact == experiment.resolved.end() ? 0 : contact->value("strain_cap", 0.0);
}

std::string refuses_strain_cap(const Component& law, const Component& normal) {
  const std::string id = in_quotes(law.plugin->id());
  const std::uint32_t traits = law.plugin->contact().traits;
  if (traits & MPM_BYPASSES_DETECTION)
    return id + " joins bodies as if they were one, which a part of its impulse would not";
  if (traits & MPM_COMPLIANT) return id + " stores energy by the whole of its impulse";
  if (normal.plugin->normal().traits & MPM_OWN_NORMALS)
    return "normal " + in_quotes(normal.plugin->id()) +
           " gives each body an impulse of its own, and the cap is one factor for both";
  return "";
}

}  // namespace mpm
