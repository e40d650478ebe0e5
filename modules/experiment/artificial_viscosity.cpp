#include "experiment/artificial_viscosity.hpp"

#include <algorithm>

namespace mpm {

bool Experiment::has_artificial_viscosity() const {
  return std::any_of(bodies.begin(), bodies.end(), [&](const BodySpecification& body) {
    return materials[static_cast<std::size_t>(body.material)].artificial_viscosity.has_value();
  });
}

ParameterSpec artificial_viscosity_parameter() {
  return parameter("artificial_viscosity", ParameterType::nested, "",
                   "A pressure against fast compression, which spreads shocks over cells; default: none.")
      .made_of({"artificial_viscosity",
                "a pressure q = density h r (linear c + quadratic h r) where a particle is compressed at the rate r",
                {
                    parameter("linear", ParameterType::number, "",
                              "Share of cell size times rate times the law's wave speed; calms what rings behind.")
                        .from(0)
                        .to(100)
                        .standard(0.2),
                    parameter("quadratic", ParameterType::number, "",
                              "Share of the square of cell size times rate; spreads strong shocks.")
                        .from(0)
                        .to(10)
                        .standard(2.0),
                }});
}

std::optional<ArtificialViscositySpecification> read_artificial_viscosity(const Fields& material,
                                                                          const Component& component,
                                                                          ReadContext& context, OrderedJson& resolved) {
  if (!material.given("artificial_viscosity")) return std::nullopt;
  const Node& place = *material.node("artificial_viscosity");
  const Fields fields = material.nested("artificial_viscosity");
  resolved["artificial_viscosity"] = fields.resolved;
  // A law that spreads shocks by itself names its coefficients so (docs/writing_a_plugin.md).
  if (component.plugin)
    for (const mpm_parameter& declared : component.plugin->parameters())
      if (const std::string_view name = declared.name; name == "linear_viscosity" || name == "quadratic_viscosity") {
        context.problem(place, "material " + in_quotes(component.plugin->id()) +
                                   " has an artificial viscosity of its own, by its parameter " + in_quotes(name) +
                                   "; remove \"artificial_viscosity\"");
        break;
      }
  return ArtificialViscositySpecification{fields.number("linear"), fields.number("quadratic"), place.pointer};
}

}  // namespace mpm
