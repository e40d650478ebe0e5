// Sets of scenes that hold every plugin and every kernel, for tests of the composition as a whole.
#pragma once

#include "device/device_support.hpp"

namespace mpm::test {

/// Mixes that hold every plugin at least once: the k-th of each kind together, or apart where these are refused. One of
/// them at least has no contact.
inline std::vector<Mix> every_plugin_once(int dimension) {
  const auto shapes = plugins().of_kind(MPM_SHAPE), transfers = plugins().of_kind(MPM_TRANSFER),
             filters = plugins().of_kind(MPM_FILTER), contacts = plugins().of_kind(MPM_CONTACT),
             materials = plugins().of_kind(MPM_MATERIAL), normals = plugins().of_kind(MPM_NORMAL),
             detections = plugins().of_kind(MPM_DETECTION);
  const std::size_t most =
      std::max({shapes.size(), transfers.size(), filters.size(), contacts.size(), materials.size()});
  std::vector<Mix> mixes;
  std::size_t next_normal = 0, next_detection = 0;  // the first that no mix holds yet
  for (std::size_t k = 0; k < most; ++k) {
    const Plugin *const shape = shapes[k % shapes.size()], *const transfer = transfers[k % transfers.size()],
                        *const material = materials[k % materials.size()], *const law = contacts[k % contacts.size()];
    Mix mix = mix_with(*shape, dimension);
    mix.transfer = device_choice(*transfer), mix.material = device_choice(*material);
    if (k < filters.size()) mix.filter = device_choice(*filters[k]);
    const bool asks = !(law->contact().traits & MPM_BYPASSES_DETECTION) && next_normal < normals.size();
    if (asks || k < contacts.size()) mix.contact = device_choice(*law);
    if (asks) mix.contact.insert(mix.contact.size() - 1, ", \"normal\": " + device_choice(*normals[next_normal]));
    Mix detected = mix;
    const bool detects = asks && next_detection < detections.size();
    if (detects)
      detected.contact.insert(mix.contact.size() - 1, ", \"detection\": " + device_choice(*detections[next_detection]));
    if (detects && !is_refused(detected)) {
      mixes.push_back(detected);
      ++next_normal, ++next_detection;
      continue;
    }
    if (!is_refused(mix)) {
      mixes.push_back(mix);
      next_normal += asks;
      continue;
    }
    for (const Plugin* plugin : {shape, transfer, material}) mixes.push_back(mix_with(*plugin, dimension));
    if (k < filters.size()) mixes.push_back(mix_with(*filters[k], dimension));
    if (k < contacts.size()) mixes.push_back(mix_with(*contacts[k], dimension));
  }
  for (; next_normal < normals.size(); ++next_normal) mixes.push_back(mix_with(*normals[next_normal], dimension));
  for (; next_detection < detections.size(); ++next_detection)
    mixes.push_back(mix_with(*detections[next_detection], dimension));
  if (std::none_of(mixes.begin(), mixes.end(), [](const Mix& mix) { return mix.contact.empty(); })) {
    mixes.emplace_back();
    mixes.back().dimension = dimension;
  }
  return mixes;
}

/// Everything that has to do with temperature at once, where shared memory is fullest: in three dimensions with contact.
inline Mix warm_mix(int dimension, const std::string& transfer) {
  Mix mix;
  mix.dimension = dimension, mix.transfer = transfer, mix.contact = R"({"type": "coulomb", "friction": 0.2})";
  mix.material = R"({"type": "von_mises", "youngs_modulus": 1000, "poisson_ratio": 0.3, "density": 1000,
    "yield_stress": 60, "thermal": {"conductivity": 500, "heat_capacity": 10, "dissipation_to_heat": 0.9,
    "phase_change": {"temperature": 22, "latent_heat": 10, "melted": {"youngs_modulus": 600}}}})";
  mix.boundaries = R"({"all": "slip", "x_min": {"type": "slip", "temperature": 30},
    "x_max": {"type": "slip", "heat_flux": 9000},
    "y_min": {"type": "slip", "convection": {"coefficient": 900, "temperature": 60}}})";
  mix.more = std::string(R"(, "body_force": [1, 2)") + (dimension == 3 ? ", 3]" : "]");
  mix.overrides = {set("/bodies/0/temperature", "20"), set("/bodies/1/temperature", "25")};
  if (!mix.contact.empty()) mix.overrides.push_back(set("/output", R"({"contact_pairs": true})"));
  return mix;
}

/// What a scene may hold beside plugins, in few scenes: temperature with melting, loads at points, springs, grips, boxes of
/// conditions, moving and periodic walls, both filters' loops, contact, by particles too, the ledger, rings, the orders of
/// the stress update, the mean dilation, and deterministic sums.
inline std::vector<Mix> every_addition(int dimension) {
  std::vector<Mix> mixes;
  const bool flat = dimension == 2;
  for (const std::string transfer : {R"({"type": "flip"})", R"({"type": "asflip"})"})
    mixes.push_back(warm_mix(dimension, transfer));
  std::erase_if(mixes.back().overrides, [](const std::string& o) { return o.starts_with("/output"); });
  mixes.back().contact = "", mixes.back().stress_update = "modified_last";
  mixes.back().more += std::string(R"(, "node_conditions": [{"type": "thermal", "heating": 900, "lower": )") +
                       (flat ? "[0.2, 0.2], \"upper\": [0.5, 0.4]}]" : "[0.2, 0.2, 0.2], \"upper\": [0.5, 0.4, 0.4]}]");
  mixes.back().overrides.push_back(set("/solver/time_step", "\"auto\""));
  Mix loaded;
  loaded.dimension = dimension, loaded.contact = R"({"type": "coulomb", "friction": 0.2})", loaded.close = true;
  loaded.filter = R"({"type": "fmpm", "order": 3, "position_update": "mean_velocity"})";
  loaded.stress_update = "averaged";
  loaded.overrides = {set("/solver/dilation", "averaged"), set("/materials/m/artificial_viscosity", "{}")};
  loaded.boundaries =
      flat ? R"({"all": "slip", "x_max": "stick", "y_min": {"type": "prescribed", "velocity": ["0.1+t+0.5*y", 0]}})"
           : R"({"all": "slip", "x_max": "stick", "y_max": "separate"})";
  const auto of = [&](const char* in_plane, const char* in_space) { return std::string(flat ? in_plane : in_space); };
  const auto beyond = [](const std::string& point, const std::string& normal) {
    return R"({"type": "half_space", "point": )" + point + R"(, "normal": )" + normal + "}";
  };
  loaded.more =
      R"J(, "damping": {"viscous": 3, "local": 0.2}, "output": {"reactions": true}, "loads": [
      {"type": "pressure", "body": "a", "where": )J" +
      beyond(of("[0.31, 0]", "[0.27, 0, 0]"), of("[1, 0.3]", "[1, 0.3, 0.1]")) +
      R"J(, "pressure": "400+100*sin(9*t)"},
      {"type": "spring", "body": "b", "where": )J" +
      beyond(of("[0.52, 0]", "[0.42, 0, 0]"), of("[1, 0]", "[1, 0, 0]")) + R"J(, "stiffness": )J" +
      of("[2e3, 1e3]", "[2e3, 1e3, 500]") + R"J(, "damping": )J" + of("[50, 100]", "[50, 100, 0]") +
      R"J(}, {"type": "body_force", "body": "b", "acceleration": )J" + of("[\"X\", \"t-y\"]", "[\"X\", \"t-y\", 1]") +
      R"J(}, {"type": "force", "body": "b", "at": )J" +
      of("[0.6, 0.37], \"force\": [5, \"9+20*t\"]", "[0.5, 0.3, 0.3], \"force\": [2, 9, \"-20*t\"]") +
      R"J(}], "node_conditions": [{"type": "slip", "axis": "y", "lower": )J" + of("[0.2, 0.3]", "[0.2, 0.1, 0.1]") +
      R"J(, "upper": )J" + of("[0.3, 0.4]", "[0.3, 0.2, 0.4]") + R"J(}, {"type": "prescribed", "lower": )J" +
      of("[0.7, 0.3]", "[0.5, 0.2, 0.3]") + R"J(, "upper": )J" + of("[0.8, 0.5]", "[0.6, 0.4, 0.4]") +
      R"J(, "velocity": )J" + of("[\"1.1-3*t*y\", \"0.3*x-0.12\"]", "[\"1.1-3*t*y\", \"0.3*x-0.12\", \"0.2*x*z\"]") +
      R"J(}], "grips": [{"body": "a", "where": )J" +
      beyond(of("[0.22, 0]", "[0.22, 0, 0]"), of("[1, 0]", "[1, 0, 0]")) + R"J(, "velocity": )J" +
      of("[\"1.2+t\", null]", "[\"1.2+t\", null, \"X\"]") +
      // This one holds nodes whole where the other body meets them.
      R"J(}, {"body": "b", "where": )J" + beyond(of("[0.58, 0]", "[0.48, 0, 0]"), of("[1, 0]", "[1, 0, 0]")) +
      R"J(, "velocity": )J" + of("[\"0.9-0.2*t\", \"0.3*y\"]", "[\"0.9-0.2*t\", \"0.3*y\", \"0.2*X\"]") + "}]";
  mixes.push_back(loaded);
  Mix periodic;
  periodic.dimension = dimension, periodic.boundaries = R"({"all": "slip", "x_min": "periodic", "x_max": "periodic"})";
  periodic.close = true, periodic.transfer = R"({"type": "flip"})";
  mixes.push_back(periodic);
  Mix exact = loaded;
  exact.contact = R"({"type": "coulomb", "normal": "widest_gap", "detection": "particle_surfaces"})";
  exact.overrides.push_back(deterministic_sums);
  exact.overrides.push_back(set("/output/ledger_every", "3"));
  mixes.push_back(exact);
  if (flat) {
    Mix rings;
    rings.overrides = {set("/grid/symmetry", "axisymmetric"), set("/gravity", "[0, -1.3]")};
    rings.filter = R"({"type": "xpic", "order": 2})", rings.stress_update = "modified_last";
    rings.close = true;
    rings.contact = R"({"type": "breakable_glue", "tension_stiffness": 1e4, "compression_stiffness": 5e4,
      "shear_stiffness": 2e4, "normal_strength": 60, "shear_strength": 90, "friction": 0.2})";
    mixes.push_back(rings);
  }
  return mixes;
}

/// Scenes that launch between them every kernel that there is (kernels/kernels.hpp): these, and all plugins, with which come
/// polynomials, lists and domains.
inline std::vector<Mix> every_kernel(int dimension) {
  std::vector<Mix> mixes = every_plugin_once(dimension);
  for (const Mix& mix : every_addition(dimension)) mixes.push_back(mix);
  return mixes;
}

}  // namespace mpm::test
