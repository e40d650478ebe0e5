#include "backends/device/device_plan.hpp"

#include <algorithm>
#include <cstdio>
#include <stdexcept>

#include "backends/device/cache.hpp"
#include "backends/device/drivers/host_compiler.hpp"
#include "backends/device/drivers/nvrtc.hpp"
#include "simulation/contact_points.hpp"

namespace mpm::device {
namespace {

using Json = nlohmann::ordered_json;

/// What ptxas says of a composition's kernels, from the cache where it has said so before.
std::string log_of(const Nvrtc& nvrtc, const Composition& composition, const std::string& architecture) {
  const ProgramCache cache = ProgramCache::of_user();
  const std::string key = cache_key(composition, "NVRTC " + nvrtc.version() + ", resources", {architecture});
  if (const auto kept = cache.find(key)) return *kept;
  const Cubin cubin = nvrtc.compile(composition, architecture, /*verbose=*/true);
  if (!cubin.compiled)
    throw CompilerError("NVRTC " + nvrtc.version() + " does not compile the composition " + composition.name + " for " +
                        architecture + ":\n" + cubin.log);
  cache.keep(key, cubin.log);
  return cubin.log;
}

std::string row(const char* format, auto... values) {
  char text[256];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

std::string fields_text(const std::vector<TakenMemory>& memory, int body) {
  std::string text;
  for (const TakenMemory& field : memory)
    if (field.body == body)
      text += row("    %-32s %4d   %4.0f B%s\n", field.field.c_str(), field.components, field.bytes,
                  field.working ? "   within a step" : "");
  return text;
}

double sum_of(const std::vector<TakenMemory>& memory, int body) {
  double sum = 0;
  for (const TakenMemory& field : memory) sum += field.body == body ? field.bytes : 0;
  return sum;
}

}  // namespace

std::string who_looks_at_particles(const Experiment& experiment) {
  const ContactPoints points(experiment);
  const auto named = [&](const char* key, const Component& component) {
    return experiment.contact->pointer + "/" + key + " \"" + std::string(component.plugin->id()) + "\"";
  };
  std::string names;
  if (points.gives_normal()) names = named("normal", *experiment.contact_normal);
  if (points.sees_surfaces()) names += (names.empty() ? "" : ", ") + named("detection", *experiment.contact_detection);
  return names;
}

const Multiprocessor& multiprocessor(const std::string& architecture) {
  std::string names;
  for (const Multiprocessor& known : multiprocessors()) {
    if (known.architecture == architecture) return known;
    names += (names.empty() ? "" : ", ") + known.architecture;
  }
  throw std::invalid_argument("no figures are known of the architecture \"" + architecture + "\"; there are " + names);
}

DevicePlan device_plan(const Experiment& experiment, const Plan& plan, const Multiprocessor& processor) {
  const Composition composition = compose(choice_of(experiment, plan));
  DevicePlan result;
  result.composition = composition.name, result.processor = processor;
  for (const BodySpecification& body : experiment.bodies) result.bodies.push_back(body.name);
  result.memory = taken_by_one(experiment, plan);
  result.looks = who_looks_at_particles(experiment);
  for (const std::string& entry : composition.entries)
    result.kernels.push_back(entry.substr(std::string("mpm_").size()));
  std::optional<Nvrtc> nvrtc = Nvrtc::find(result.missing);
  if (!nvrtc) return result;
  result.compiler = "NVRTC " + nvrtc->version().substr(0, nvrtc->version().find(' '));
  result.taken = resources_in(log_of(*nvrtc, composition, processor.architecture));
  // In the order of the composition, which is that of the source.
  const auto place = [&](const KernelResources& kernel) {
    return std::find(result.kernels.begin(), result.kernels.end(), kernel.kernel);
  };
  std::stable_sort(result.taken.begin(), result.taken.end(),
                   [&](const auto& a, const auto& b) { return place(a) < place(b); });
  return result;
}

double DevicePlan::bytes_per_particle(int body) const {
  return sum_of(memory, body);
}
double DevicePlan::bytes_per_node() const {
  return sum_of(memory, TakenMemory::of_nodes);
}

std::string DevicePlan::to_text() const {
  std::string text = "On a device: " + composition + "\n";
  for (int body = 0; body < static_cast<int>(bodies.size()); ++body)
    text += row("  body %d, %s: %.0f bytes a particle\n", body, bodies[static_cast<std::size_t>(body)].c_str(),
                bytes_per_particle(body)) +
            fields_text(memory, body);
  text += row("  %.0f bytes a node, with all velocity fields\n", bytes_per_node()) +
          fields_text(memory, TakenMemory::of_nodes);
  if (!looks.empty())
    text += "  " + looks +
            ": nodes where fields meet look at particles, once a step (find_meeting_nodes, look_at_particles)\n";
  text += "  " + std::to_string(kernels.size()) + " kernels";
  if (!missing.empty()) return text + "; what they take is not known: " + missing + "\n";
  text += ", as " + compiler + " compiles them for " + processor.architecture + " (nothing was run), with " +
          std::to_string(lanes_of_gpu) + " lanes a team\n";
  text += row("    %-32s %9s %8s %7s %7s %10s\n", "kernel", "registers", "shared", "stack", "spilled", "occupancy");
  for (const KernelResources& kernel : taken)
    text += row("    %-32s %9d %6d B %5d B %5d B %8.0f %%\n", kernel.kernel.c_str(), kernel.registers,
                kernel.shared_bytes, kernel.stack_bytes, kernel.spilled_bytes, 100 * occupancy(kernel, processor));
  return text;
}

Json DevicePlan::to_json() const {
  Json json{{"composition", composition}, {"bytes_per_node", bytes_per_node()}};
  for (int body = 0; body < static_cast<int>(bodies.size()); ++body)
    json["bodies"].push_back(
        {{"name", bodies[static_cast<std::size_t>(body)]}, {"bytes_per_particle", bytes_per_particle(body)}});
  for (const TakenMemory& field : memory)
    json["memory"].push_back({{"field", field.field},
                              {"body", field.body < 0 ? Json() : Json(field.body)},
                              {"bytes", field.bytes},
                              {"within_a_step", field.working}});
  if (!looks.empty()) json["looks_at_particles"] = looks;
  json["kernel_count"] = kernels.size();
  if (!missing.empty()) {
    json["missing"] = missing;
    return json;
  }
  json["compiler"] = compiler, json["architecture"] = processor.architecture, json["lanes"] = lanes_of_gpu;
  for (const KernelResources& kernel : taken)
    json["kernels"].push_back({{"name", kernel.kernel},
                               {"registers", kernel.registers},
                               {"shared_bytes", kernel.shared_bytes},
                               {"stack_bytes", kernel.stack_bytes},
                               {"spilled_bytes", kernel.spilled_bytes},
                               {"occupancy", occupancy(kernel, processor)}});
  return json;
}

}  // namespace mpm::device
