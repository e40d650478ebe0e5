#pragma once
// The plugins found on this machine, by kind and id. Loading checks version and sizes before anything of a plugin is
// used.

#include <filesystem>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "plugin/abi.h"
#include "plugin/on_demand.hpp"

namespace mpm {

/// A plugin file that cannot be used; the message names the file, what is wrong and the remedy.
class PluginError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// One component as found. Its file, and with it the descriptor, stays loaded until the process ends.
struct Plugin {
  const mpm_descriptor* descriptor = nullptr;
  std::filesystem::path file;

  std::string_view id() const { return descriptor->id; }
  std::span<const mpm_parameter> parameters() const { return {descriptor->parameters, descriptor->parameter_count}; }
  std::span<const mpm_state> state() const { return {descriptor->state, descriptor->state_count}; }
  const mpm_shape& shape() const { return *static_cast<const mpm_shape*>(descriptor->kind_table); }
  const mpm_transfer& transfer() const { return *static_cast<const mpm_transfer*>(descriptor->kind_table); }
  const mpm_filter& filter() const { return *static_cast<const mpm_filter*>(descriptor->kind_table); }
  const mpm_contact& contact() const { return *static_cast<const mpm_contact*>(descriptor->kind_table); }
  const mpm_normal& normal() const { return *static_cast<const mpm_normal*>(descriptor->kind_table); }
  const mpm_detection& detection() const { return *static_cast<const mpm_detection*>(descriptor->kind_table); }
  const mpm_material& material() const { return *static_cast<const mpm_material*>(descriptor->kind_table); }
  /// The table of an extension, null where the plugin has none; extension_of() in plugin/extension_of.hpp knows types.
  const void* extension(const char* id) const { return descriptor->extension ? descriptor->extension(id) : nullptr; }
};

/// The kind as a word: "shape", "transfer", "filter", "contact", "normal", "detection", "material".
std::string_view kind_name(mpm_kind kind);
std::string_view kind_plural(mpm_kind kind);
/// All kinds, in the order they are listed.
std::span<const mpm_kind> all_kinds();

/// Components of one state field in `dimension` (2 or 3); a plane deformation has those of plane strain.
int state_components(mpm_state_shape shape, int dimension);

/// How a field is kept: a plane deformation becomes a matrix, or in axisymmetric scenes a deformation; every other
/// shape stays as it is declared.
mpm_state_shape kept_shape(const mpm_state& field, bool axisymmetric);

class Registry {
 public:
  /// Loads every plugin in `folders`, in order. A file that cannot be used is remembered in `rejected()`, not fatal.
  /// Two files with one kind and id: the first folder's wins and the second is rejected by name.
  static Registry from_folders(std::span<const std::filesystem::path> folders);

  /// Folders searched: MPM_PLUGIN_PATH (colon separated), then the build or install tree beside the program.
  static std::vector<std::filesystem::path> default_folders();

  /// Loads one file and adds what it holds. Throws PluginError; then nothing is added and the file is not kept loaded.
  void load(const std::filesystem::path& file);

  const std::vector<Plugin>& plugins() const { return plugins_; }
  /// The plugin of this kind and id, or null when there is none.
  const Plugin* find(mpm_kind kind, std::string_view id) const;
  std::vector<const Plugin*> of_kind(mpm_kind kind) const;
  /// Plugins that the program's build tree has not built (plugin/on_demand.hpp), for messages that name what there is.
  void set_not_built(std::vector<PluginTarget> plugins) { not_built_ = std::move(plugins); }
  const std::vector<PluginTarget>& not_built() const { return not_built_; }
  /// One message a file that was found but not usable.
  const std::vector<std::string>& rejected() const { return rejected_; }

 private:
  std::vector<Plugin> plugins_;
  std::vector<std::string> rejected_;
  std::vector<PluginTarget> not_built_;
};

}  // namespace mpm
