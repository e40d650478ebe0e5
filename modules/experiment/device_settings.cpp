#include "experiment/device_settings.hpp"

namespace mpm {

Section device_section() {
  return {"device",
          "how a device works",
          {
              parameter("sums", ParameterType::choice, "",
                        "How particles are summed on nodes: fast, or to the same bits in every run.")
                  .of({"fast", "deterministic"})
                  .standard("fast"),
          }};
}

void read_device(const Node* node, const Experiment& experiment, ReadContext& context,
                 nlohmann::ordered_json& resolved) {
  if (!node) return;
  const Fields fields(node, device_section(), context);
  if (experiment.backend != "cuda")
    context.problem(*node, "\"device\" says how backend \"cuda\" works, and the backend is " +
                               in_quotes(experiment.backend) + ": remove it, or choose --backend cuda");
  resolved["device"] = fields.resolved;
}

bool sums_deterministically(const Experiment& experiment) {
  const auto device = experiment.resolved.find("device");
  return device != experiment.resolved.end() && device->at("sums") == "deterministic";
}

}  // namespace mpm
