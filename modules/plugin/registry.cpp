#include "plugin/registry.hpp"

#include <dlfcn.h>
#include <elf.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>

#include "plugin/extension_of.hpp"
#include "plugin/on_demand.hpp"

namespace mpm {
namespace {

constexpr std::array kinds{MPM_SHAPE, MPM_TRANSFER, MPM_FILTER, MPM_CONTACT, MPM_NORMAL, MPM_DETECTION, MPM_MATERIAL};

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& what, const std::string& remedy) {
  throw PluginError("plugin " + file.string() + ": " + what + "; " + remedy);
}

/// A truncated shared object can crash the loader when it is mapped, so the file must reach its section table's end.
void check_whole(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  Elf64_Ehdr header{};
  if (!in.read(reinterpret_cast<char*>(&header), sizeof header) || std::memcmp(header.e_ident, ELFMAG, SELFMAG) != 0)
    refuse(file, "is not a shared object", "rebuild it or remove it from the plugin folder");
  const auto expected = header.e_shoff + static_cast<std::uint64_t>(header.e_shnum) * header.e_shentsize;
  if (std::filesystem::file_size(file) < expected)
    refuse(file,
           "is truncated (" + std::to_string(std::filesystem::file_size(file)) + " of at least " +
               std::to_string(expected) + " bytes)",
           "rebuild or copy it again");
}

/// A loaded file, closed again unless it is kept.
class Library {
 public:
  explicit Library(const std::filesystem::path& file)
      : handle_(dlopen(std::filesystem::absolute(file).c_str(), RTLD_NOW | RTLD_LOCAL)) {
    if (handle_) return;
    const char* reason = dlerror();
    refuse(file, std::string("cannot be loaded: ") + (reason ? reason : "unknown reason"),
           "rebuild it on this machine");
  }
  ~Library() {
    if (handle_) dlclose(handle_);
  }
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;

  const void* symbol(const char* name) const { return dlsym(handle_, name); }
  void keep() { handle_ = nullptr; }

 private:
  void* handle_;
};

const std::string wrong_tables = "the plugin's tables are wrong: build it with plugin/sdk.hpp";

/// A table's size as the plugin has it must be that of this program: versions are equal when this is asked.
void check_size(const std::filesystem::path& file, const std::string& table, std::uint32_t theirs, std::size_t ours) {
  if (theirs == ours) return;
  refuse(file, "has " + table + " of " + std::to_string(theirs) + " bytes, this program has " + std::to_string(ours),
         wrong_tables);
}

/// The version stands first and is read alone: nothing else need be where this program looks for it.
const mpm_plugin_library& checked_library(const Library& loaded, const std::filesystem::path& file) {
  const void* symbol = loaded.symbol(MPM_PLUGIN_SYMBOL);
  if (!symbol)
    refuse(file, "exports no symbol `" MPM_PLUGIN_SYMBOL "`", "a plugin needs MPM_EXPORT_PLUGIN in one of its sources");
  const std::uint32_t version = *static_cast<const std::uint32_t*>(symbol);
  if (version != MPM_ABI_VERSION)
    refuse(file,
           "was built for plugin ABI version " + std::to_string(version) + ", this program has version " +
               std::to_string(MPM_ABI_VERSION),
           "rebuild the plugin against this version's headers");
  const auto& library = *static_cast<const mpm_plugin_library*>(symbol);
  check_size(file, "a library table", library.struct_size, sizeof(mpm_plugin_library));
  if (library.descriptor_count == 0 || !library.descriptors) refuse(file, "holds no descriptor", wrong_tables);
  return library;
}

std::size_t table_size(std::uint32_t kind) {
  switch (kind) {
    case MPM_SHAPE:
      return sizeof(mpm_shape);
    case MPM_TRANSFER:
      return sizeof(mpm_transfer);
    case MPM_FILTER:
      return sizeof(mpm_filter);
    case MPM_CONTACT:
      return sizeof(mpm_contact);
    case MPM_MATERIAL:
      return sizeof(mpm_material);
    case MPM_NORMAL:
      return sizeof(mpm_normal);
    case MPM_DETECTION:
      return sizeof(mpm_detection);
    default:
      return 0;
  }
}

/// Checks everything that the program takes for granted of a descriptor later on; rows of its tables may not be there
/// at all.
void check_descriptor(const mpm_descriptor& d, const std::filesystem::path& file) {
  if (!d.id || !*d.id || !d.version || !d.summary || !d.citation || !d.manual || !d.functor_name || !d.source)
    refuse(file, "has a descriptor without id, version, summary, citation, manual or functor source", wrong_tables);
  const std::string name = std::string("descriptor `") + d.id + "` ";
  const bool known = std::any_of(kinds.begin(), kinds.end(), [&](std::uint32_t kind) { return kind == d.kind; });
  if (!known || !d.kind_table || d.kind_table_size == 0)
    refuse(file,
           name + "has kind " + std::to_string(d.kind) + " with a table of " + std::to_string(d.kind_table_size) +
               " bytes",
           wrong_tables);
  const std::string table = "descriptor `" + std::string(d.id) + "` with a " +
                            std::string(kind_name(static_cast<mpm_kind>(d.kind))) + " table";
  check_size(file, table, d.kind_table_size, table_size(d.kind));
  if ((d.parameter_count > 0 && !d.parameters) || (d.state_count > 0 && !d.state))
    refuse(file,
           name + "counts " + std::to_string(d.parameter_count) + " parameters and " + std::to_string(d.state_count) +
               " state fields, and one of the tables is null",
           wrong_tables);
}

/// Nodes average what a law keeps, and particles never lose any of it.
void check_contact_state(const mpm_descriptor& d, const std::filesystem::path& file) {
  const std::string name = std::string("descriptor `") + d.id + "` ";
  if (d.state_count > MPM_CONTACT_STATES)
    refuse(file,
           name + "is a contact law with " + std::to_string(d.state_count) + " state fields; there is room for " +
               std::to_string(MPM_CONTACT_STATES),
           wrong_tables);
  for (std::size_t k = 0; k < d.state_count; ++k)
    if (d.state[k].shape != MPM_STATE_SCALAR || d.state[k].initial != MPM_INITIAL_ZERO)
      refuse(file,
             name + "is a contact law whose state field `" + d.state[k].name + "` is not a scalar that begins at zero",
             wrong_tables);
}

void check_rows(const mpm_descriptor& d, const std::filesystem::path& file) {
  const std::string name = std::string("descriptor `") + d.id + "` ";
  const auto incomplete = [&](const char* what, std::size_t row) {
    refuse(file, name + "has an incomplete " + what + " in row " + std::to_string(row + 1), wrong_tables);
  };
  bool density = false;
  for (std::size_t k = 0; k < d.parameter_count; ++k) {
    const mpm_parameter& p = d.parameters[k];
    if (!p.name || !p.unit || !p.doc || !p.choices || p.type > MPM_CHOICE ||
        p.offset + sizeof(double) > d.parameter_bytes || p.offset % sizeof(double) != 0)
      incomplete("parameter", k);
    density |= std::strcmp(p.name, "density") == 0;
  }
  for (std::size_t k = 0; k < d.state_count; ++k) {
    const mpm_state& s = d.state[k];
    if (!s.name || !*s.name || !s.unit || !s.doc || s.shape > MPM_STATE_PLANE_DEFORMATION ||
        s.initial > MPM_INITIAL_IDENTITY)
      incomplete("state field", k);
  }
  if (d.kind == MPM_CONTACT) check_contact_state(d, file);
  if (d.kind == MPM_MATERIAL && !density)
    refuse(file, name + "is a material without a parameter `density`", wrong_tables);
}

/// Checks that the extensions which this program knows have its versions and belong to their kind.
void check_extensions(const Plugin& plugin, const std::filesystem::path& file) {
  for (const KnownExtension& known : known_extensions()) {
    const void* table = plugin.extension(known.id);
    if (!table) continue;
    const std::string name = std::string("descriptor `") + plugin.descriptor->id + "` ";
    if (known.kind != 0 && known.kind != plugin.descriptor->kind)
      refuse(file,
             name + "is a " + std::string(kind_name(static_cast<mpm_kind>(plugin.descriptor->kind))) +
                 " and offers the extension `" + known.id + "` of a " +
                 std::string(kind_name(static_cast<mpm_kind>(known.kind))),
             wrong_tables);
    const std::uint32_t version = *static_cast<const std::uint32_t*>(table);
    if (version != known.version)
      refuse(file,
             name + "offers the extension `" + known.id + "` of version " + std::to_string(version) +
                 ", this program has version " + std::to_string(known.version),
             "rebuild the plugin against this version's headers");
  }
  const mpm_descriptor& d = *plugin.descriptor;
  if (const auto* cell_size = extension_of<mpm_material_cell_size>(plugin);
      cell_size && (cell_size->offset % sizeof(double) != 0 || cell_size->offset + sizeof(double) > d.parameter_bytes))
    refuse(file,
           std::string("descriptor `") + d.id + "` takes the cell size at byte " + std::to_string(cell_size->offset) +
               " of a block of " + std::to_string(d.parameter_bytes),
           wrong_tables);
}

}  // namespace

std::string_view kind_name(mpm_kind kind) {
  switch (kind) {
    case MPM_SHAPE:
      return "shape";
    case MPM_TRANSFER:
      return "transfer";
    case MPM_FILTER:
      return "filter";
    case MPM_CONTACT:
      return "contact";
    case MPM_MATERIAL:
      return "material";
    case MPM_NORMAL:
      return "normal";
    case MPM_DETECTION:
      return "detection";
  }
  return "unknown";
}

std::string_view kind_plural(mpm_kind kind) {
  switch (kind) {
    case MPM_SHAPE:
      return "shapes";
    case MPM_TRANSFER:
      return "transfers";
    case MPM_FILTER:
      return "filters";
    case MPM_CONTACT:
      return "contact laws";
    case MPM_MATERIAL:
      return "materials";
    case MPM_NORMAL:
      return "contact normals";
    case MPM_DETECTION:
      return "contact detections";
  }
  return "unknown";
}

std::span<const mpm_kind> all_kinds() {
  return kinds;
}

std::span<const KnownExtension> known_extensions() {
  static constexpr KnownExtension all[] = {
      extension_info<mpm_costs>,
      extension_info<mpm_refusals>,
      extension_info<mpm_shape_boxes>,
      extension_info<mpm_shape_courant_limit>,
      extension_info<mpm_transfer_polynomials>,
      extension_info<mpm_filter_step_limit>,
      extension_info<mpm_contact_step_limit>,
      extension_info<mpm_material_trial>,
      extension_info<mpm_material_tangent>,
      extension_info<mpm_material_projection>,
      extension_info<mpm_material_makes_energy>,
      extension_info<mpm_material_dissipation>,
      extension_info<mpm_material_clamps>,
      extension_info<mpm_material_temperature>,
      extension_info<mpm_material_cell_size>,
  };
  return all;
}

int state_components(mpm_state_shape shape, int dimension) {
  switch (shape) {
    case MPM_STATE_SCALAR:
      return 1;
    case MPM_STATE_VECTOR:
      return dimension;
    case MPM_STATE_MATRIX:
    case MPM_STATE_PLANE_DEFORMATION:
      return dimension * dimension;
    case MPM_STATE_SYMMETRIC:
      return dimension == 2 ? 4 : 6;
    case MPM_STATE_DEFORMATION:
      return dimension == 2 ? 5 : 9;
  }
  return 0;
}

mpm_state_shape kept_shape(const mpm_state& field, bool axisymmetric) {
  if (field.shape != MPM_STATE_PLANE_DEFORMATION) return static_cast<mpm_state_shape>(field.shape);
  return axisymmetric ? MPM_STATE_DEFORMATION : MPM_STATE_MATRIX;
}

void Registry::load(const std::filesystem::path& file) {
  check_whole(file);
  Library loaded(file);
  const mpm_plugin_library library = checked_library(loaded, file);
  std::vector<Plugin> found;
  const auto offers = [](const Plugin& plugin, const mpm_descriptor& d) {
    return plugin.descriptor->kind == d.kind && plugin.id() == d.id;
  };
  for (std::uint32_t k = 0; k < library.descriptor_count; ++k) {
    const mpm_descriptor& d = library.descriptors[k];
    check_descriptor(d, file);
    check_rows(d, file);
    const std::string name = std::string(kind_name(static_cast<mpm_kind>(d.kind))) + " `" + d.id + "`";
    if (const Plugin* earlier = find(static_cast<mpm_kind>(d.kind), d.id))
      refuse(file, "offers " + name + ", which " + earlier->file.string() + " already offers",
             "rename one of them or remove a folder from MPM_PLUGIN_PATH");
    if (std::any_of(found.begin(), found.end(), [&](const Plugin& plugin) { return offers(plugin, d); }))
      refuse(file, "offers " + name + " twice", "rename one of them");
    found.push_back({&d, file});
    check_extensions(found.back(), file);
  }
  loaded.keep();
  plugins_.insert(plugins_.end(), found.begin(), found.end());
}

Registry Registry::from_folders(std::span<const std::filesystem::path> folders) {
  Registry registry;
  for (const auto& folder : folders) {
    std::error_code error;
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder, error))
      if (entry.path().extension() == ".so") files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    for (const auto& file : files) try {
        registry.load(file);
      } catch (const PluginError& problem) {
        registry.rejected_.push_back(problem.what());
      }
  }
  std::stable_sort(registry.plugins_.begin(), registry.plugins_.end(), [](const Plugin& a, const Plugin& b) {
    return a.descriptor->kind != b.descriptor->kind ? a.descriptor->kind < b.descriptor->kind : a.id() < b.id();
  });
  return registry;
}

std::vector<std::filesystem::path> Registry::default_folders() {
  std::vector<std::filesystem::path> folders;
  if (const char* variable = std::getenv("MPM_PLUGIN_PATH")) {
    std::stringstream list(variable);
    for (std::string folder; std::getline(list, folder, ':');)
      if (!folder.empty()) folders.emplace_back(folder);
  }
  for (const auto& folder : folders_beside_program("plugins"))
    if (std::filesystem::is_directory(folder)) folders.push_back(folder);
  return folders;
}

const Plugin* Registry::find(mpm_kind kind, std::string_view id) const {
  for (const Plugin& plugin : plugins_)
    if (plugin.descriptor->kind == kind && plugin.id() == id) return &plugin;
  return nullptr;
}

std::vector<const Plugin*> Registry::of_kind(mpm_kind kind) const {
  std::vector<const Plugin*> found;
  for (const Plugin& plugin : plugins_)
    if (plugin.descriptor->kind == kind) found.push_back(&plugin);
  return found;
}

}  // namespace mpm
