#pragma once
// What a plugin's author includes: a plugin is a functor (a header of its own, which compilers of device code read too)
// and a .cpp with MPM_EXPORT_PLUGIN. What a functor must offer are the concepts in sdk/batches.hpp, what it may offer
// beyond those in sdk/extensions.hpp. A material's source may be compiled into two objects of the plugin, side by side, as
// that takes twice as long as any other's: MPM_PLUGIN_PART is 1 for what a run calls, 2 for what runs the functor over
// scalars of its own (tangent, costs). Without it all is in one.

#include "plugin/sdk/batches.hpp"
#include "plugin/sdk/extensions.hpp"

namespace mpm::sdk {

/// The words of a plugin's manual page.
struct Manual {
  const char* id;
  const char* version;
  const char* summary;
  const char* citation;
  const char* text;
  const char* functor_name;
};

template <class F, class Table>
constexpr mpm_descriptor descriptor(mpm_kind kind, const Table& table, const void* (*extension)(const char* id),
                                    const Manual& manual, const char* source) {
  mpm_descriptor d{};
  d.id = manual.id, d.version = manual.version, d.summary = manual.summary, d.citation = manual.citation,
  d.manual = manual.text;
  d.kind = kind;
  d.dimensions = MPM_2D | MPM_3D;
  d.precisions = (1u << MPM_LANES_FLOAT) | (1u << MPM_LANES_DOUBLE) | (1u << MPM_SCALAR_DOUBLE);
  if constexpr (requires { F::parameters[0].name; }) {
    constexpr std::size_t given_by_host = CellSizeFunctor<F> ? sizeof(double) : 0;
    static_assert(sizeof(typename F::Parameters) ==
                      sizeof(F::parameters) / sizeof(mpm_parameter) * sizeof(double) + given_by_host,
                  "Parameters must be doubles, one for each row of the parameter table");
    d.parameters = F::parameters, d.parameter_count = sizeof(F::parameters) / sizeof(mpm_parameter),
    d.parameter_bytes = sizeof(typename F::Parameters);
  }
  if constexpr (HasState<F>) d.state = F::state, d.state_count = sizeof(F::state) / sizeof(mpm_state);
  d.needs = needs_of<F>();
  d.kind_table = &table, d.kind_table_size = sizeof(Table);
  d.functor_name = manual.functor_name, d.source = source;
  d.extension = extension;
  return d;
}

template <class F>
constexpr mpm_descriptor shape(const Manual& m, const char* source) {
  return descriptor<F>(MPM_SHAPE, ShapeTable<F>::value, &shape_extension<F>, m, source);
}
template <class F>
constexpr mpm_descriptor filter(const Manual& m, const char* source) {
  return descriptor<F>(MPM_FILTER, filter_table<F>, &filter_extension<F>, m, source);
}
template <class F>
constexpr mpm_descriptor transfer(const Manual& m, const char* source) {
  return descriptor<F>(MPM_TRANSFER, transfer_table<F>, &transfer_extension<F>, m, source);
}
template <class F>
constexpr mpm_descriptor contact(const Manual& m, const char* source) {
  return descriptor<F>(MPM_CONTACT, contact_table<F>, &contact_extension<F>, m, source);
}
template <class F>
constexpr mpm_descriptor normal(const Manual& m, const char* source) {
  return descriptor<F>(MPM_NORMAL, NormalTable<F>::value, &refusal_extension<F>, m, source);
}
template <class F>
constexpr mpm_descriptor detection(const Manual& m, const char* source) {
  return descriptor<F>(MPM_DETECTION, detection_table<F>, &refusal_extension<F>, m, source);
}
template <class F>
constexpr mpm_descriptor material(const Manual& m, const char* source) {
  return descriptor<F>(MPM_MATERIAL, material_table<F>, &material_extension<F>, m, source);
}

/// What the second object of a plugin holds, by kind.
namespace second_part {
template <class F>
inline constexpr auto material = &extension_over_other_scalars<F>;
}

}  // namespace mpm::sdk

/// Text of the functor's header, written by the build (mpm_add_plugin in MpmPlugin.cmake).
#ifdef MPM_EMBEDDED_SOURCE
namespace mpm::sdk {
inline constexpr char embedded_source[] =
#include MPM_EMBEDDED_SOURCE
    ;
}  // namespace mpm::sdk
#endif

#if defined(MPM_PLUGIN_PART) && MPM_PLUGIN_PART == 2
#define MPM_EXPORT_PLUGIN(maker, ...) \
  [[gnu::used]] static constexpr auto mpm_second_part = mpm::sdk::second_part::maker;
#else
/// Exports the plugin: MPM_EXPORT_PLUGIN(material<NeoHookean>, {"neo_hookean", "1.0.0", "summary", "citation",
/// "manual", "NeoHookean"})
#define MPM_EXPORT_PLUGIN(maker, ...)                                                                     \
  static constexpr mpm_descriptor mpm_exported_descriptor =                                               \
      mpm::sdk::maker(mpm::sdk::Manual __VA_ARGS__, mpm::sdk::embedded_source);                           \
  extern "C" __attribute__((visibility("default"))) constexpr mpm_plugin_library mpm_plugin_library_v = { \
      MPM_ABI_VERSION, sizeof(mpm_plugin_library), 1, 0, &mpm_exported_descriptor};
#endif
