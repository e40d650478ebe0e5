#include "plugin/registry.hpp"

#include <dlfcn.h>
#include <elf.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>

namespace mpm {
namespace {

constexpr std::array kinds{MPM_SHAPE, MPM_TRANSFER, MPM_FILTER, MPM_CONTACT, MPM_MATERIAL};

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

const mpm_plugin_library& checked_library(void* handle, const std::filesystem::path& file) {
  const void* symbol = dlsym(handle, MPM_PLUGIN_SYMBOL);
  if (!symbol)
    refuse(file, "exports no symbol `" MPM_PLUGIN_SYMBOL "`", "a plugin needs MPM_EXPORT_PLUGIN in one of its sources");
  const auto& library = *static_cast<const mpm_plugin_library*>(symbol);
  if (library.abi_version != MPM_ABI_VERSION)
    refuse(file,
           "was built for plugin ABI version " + std::to_string(library.abi_version) + ", this program has version " +
               std::to_string(MPM_ABI_VERSION),
           "rebuild the plugin against this version's headers");
  if (library.struct_size != sizeof(mpm_plugin_library) || library.descriptor_size != sizeof(mpm_descriptor))
    refuse(file,
           "has table sizes " + std::to_string(library.struct_size) + " and " +
               std::to_string(library.descriptor_size) + ", this program has " +
               std::to_string(sizeof(mpm_plugin_library)) + " and " + std::to_string(sizeof(mpm_descriptor)),
           "rebuild the plugin against this version's headers");
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
    default:
      return 0;
  }
}

void check_descriptor(const mpm_descriptor& d, const std::filesystem::path& file) {
  const std::string remedy = "the plugin's tables are wrong: build it with plugin/sdk.hpp";
  if (!d.id || !*d.id || !d.version || !d.summary || !d.citation || !d.manual || !d.functor_name || !d.source)
    refuse(file, "has a descriptor without id, version, summary, citation, manual or functor source", remedy);
  const std::string name = std::string("descriptor `") + d.id + "` ";
  const bool known = std::any_of(kinds.begin(), kinds.end(), [&](std::uint32_t kind) { return kind == d.kind; });
  if (!known || !d.kind_table || d.kind_table_size != table_size(d.kind))
    refuse(file,
           name + "has kind " + std::to_string(d.kind) + " with a table of " + std::to_string(d.kind_table_size) +
               " bytes",
           remedy);
  for (std::uint32_t k = 0; k < d.parameter_count; ++k) {
    const mpm_parameter& p = d.parameters[k];
    if (!p.name || !p.unit || !p.doc || !p.choices || p.offset + sizeof(double) > d.parameter_bytes ||
        p.offset % sizeof(double) != 0)
      refuse(file, name + "has an incomplete parameter in row " + std::to_string(k + 1), remedy);
  }
  if (d.kind == MPM_MATERIAL &&
      std::none_of(d.parameters, d.parameters + d.parameter_count,
                   [](const mpm_parameter& p) { return std::strcmp(p.name, "density") == 0; }))
    refuse(file, name + "is a material without a parameter `density`", remedy);
}

/// Folder of the running program.
std::filesystem::path program_folder() {
  std::error_code error;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", error);
  return error ? std::filesystem::path(".") : program.parent_path();
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
  }
  return "unknown";
}

std::span<const mpm_kind> all_kinds() {
  return kinds;
}

int state_components(mpm_state_shape shape, int dimension) {
  switch (shape) {
    case MPM_STATE_SCALAR:
      return 1;
    case MPM_STATE_VECTOR:
      return dimension;
    case MPM_STATE_MATRIX:
      return dimension * dimension;
    case MPM_STATE_SYMMETRIC:
      return dimension == 2 ? 4 : 6;
    case MPM_STATE_DEFORMATION:
      return dimension == 2 ? 5 : 9;
  }
  return 0;
}

void Registry::load(const std::filesystem::path& file) {
  check_whole(file);
  void* handle = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!handle) {
    const char* reason = dlerror();
    refuse(file, std::string("cannot be loaded: ") + (reason ? reason : "unknown reason"),
           "rebuild it on this machine");
  }
  const mpm_plugin_library& library = checked_library(handle, file);
  for (std::uint32_t k = 0; k < library.descriptor_count; ++k) {
    const mpm_descriptor& d = library.descriptors[k];
    check_descriptor(d, file);
    if (const Plugin* earlier = find(static_cast<mpm_kind>(d.kind), d.id))
      refuse(file,
             "offers " + std::string(kind_name(static_cast<mpm_kind>(d.kind))) + " `" + d.id + "`, which " +
                 earlier->file.string() + " already offers",
             "rename one of them or remove a folder from MPM_PLUGIN_PATH");
  }
  for (std::uint32_t k = 0; k < library.descriptor_count; ++k) plugins_.push_back({&library.descriptors[k], file});
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
  const auto program = program_folder();
  for (const auto& folder :
       {program / "plugins", program.parent_path() / "plugins", program.parent_path() / "lib" / "mpm" / "plugins"})
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
