#include "plugin/registry.hpp"

#include <dlfcn.h>
#include <elf.h>

#include <algorithm>
#include <array>
#include <cstddef>
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

/// A table's size as the plugin has it: not above this program's, and whole 8-byte words.
void check_size(const std::filesystem::path& file, const char* table, std::uint32_t theirs, std::size_t ours) {
  if (theirs <= ours && theirs > 0 && theirs % alignof(void*) == 0) return;
  refuse(file,
         std::string("has ") + table + " of " + std::to_string(theirs) + " bytes, this program has " +
             std::to_string(ours),
         theirs > ours ? "rebuild the plugin against this version's headers, or use the newer program it was made for"
                       : "the plugin's tables are wrong: build it with plugin/sdk.hpp");
}

/// The first `bytes` of a plugin's struct in one of this program's, whose further fields stay zero.
template <class Struct>
Struct widened(const void* source, std::size_t bytes) {
  Struct copy{};
  std::memcpy(static_cast<void*>(&copy), source, bytes);
  return copy;
}

mpm_plugin_library checked_library(const Library& loaded, const std::filesystem::path& file) {
  const void* symbol = loaded.symbol(MPM_PLUGIN_SYMBOL);
  if (!symbol)
    refuse(file, "exports no symbol `" MPM_PLUGIN_SYMBOL "`", "a plugin needs MPM_EXPORT_PLUGIN in one of its sources");
  const std::uint32_t version = *static_cast<const std::uint32_t*>(symbol);
  if (version != MPM_ABI_VERSION)
    refuse(file,
           "was built for plugin ABI version " + std::to_string(version) + ", this program has version " +
               std::to_string(MPM_ABI_VERSION),
           "rebuild the plugin against this version's headers");
  const std::uint32_t size = *(static_cast<const std::uint32_t*>(symbol) + 1);
  // The sizes and revision stand before `descriptors`, which closes revision 0: no library table is shorter.
  constexpr std::size_t least = offsetof(mpm_plugin_library, descriptors) + sizeof(void*);
  if (size < least)
    refuse(
        file,
        "has a library table of " + std::to_string(size) + " bytes, at least " + std::to_string(least) + " are needed",
        "the plugin's tables are wrong: build it with plugin/sdk.hpp");
  const auto library = widened<mpm_plugin_library>(symbol, std::min<std::size_t>(size, sizeof(mpm_plugin_library)));
  if (library.abi_revision > MPM_ABI_REVISION)
    refuse(file,
           "was built for plugin ABI revision " + std::to_string(library.abi_revision) +
               ", this program knows revisions up to " + std::to_string(MPM_ABI_REVISION),
           "rebuild the plugin against this version's headers, or use the newer program it was made for");
  check_size(file, "a library table", size, sizeof(mpm_plugin_library));
  check_size(file, "descriptors", library.descriptor_size, sizeof(mpm_descriptor));
  check_size(file, "parameter rows", library.parameter_size, sizeof(mpm_parameter));
  check_size(file, "state rows", library.state_size, sizeof(mpm_state));
  if (library.descriptor_count == 0 || !library.descriptors)
    refuse(file, "holds no descriptor", "the plugin's tables are wrong: build it with plugin/sdk.hpp");
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

/// One descriptor with its rows and its kind's table, in this program's sizes.
struct Tables {
  mpm_descriptor descriptor{};
  std::vector<mpm_parameter> parameters;
  std::vector<mpm_state> state;
  union {
    mpm_shape shape;
    mpm_transfer transfer;
    mpm_filter filter;
    mpm_contact contact;
    mpm_material material;
  } kind{};
};

/// `count` rows that lie `size` bytes apart.
template <class Row>
std::vector<Row> rows(const void* first, std::uint32_t count, std::uint32_t size) {
  std::vector<Row> copies;
  for (std::uint32_t k = 0; k < count; ++k)
    copies.push_back(widened<Row>(static_cast<const char*>(first) + static_cast<std::size_t>(k) * size, size));
  return copies;
}

/// Everything that the program takes for granted of a descriptor later on, whose rows may not be there at all.
void check_descriptor(const mpm_descriptor& d, const std::filesystem::path& file) {
  const std::string remedy = "the plugin's tables are wrong: build it with plugin/sdk.hpp";
  if (!d.id || !*d.id || !d.version || !d.summary || !d.citation || !d.manual || !d.functor_name || !d.source)
    refuse(file, "has a descriptor without id, version, summary, citation, manual or functor source", remedy);
  const std::string name = std::string("descriptor `") + d.id + "` ";
  const bool known = std::any_of(kinds.begin(), kinds.end(), [&](std::uint32_t kind) { return kind == d.kind; });
  if (!known || !d.kind_table || d.kind_table_size == 0)
    refuse(file,
           name + "has kind " + std::to_string(d.kind) + " with a table of " + std::to_string(d.kind_table_size) +
               " bytes",
           remedy);
  const std::string table = "descriptor `" + std::string(d.id) + "` with a " +
                            std::string(kind_name(static_cast<mpm_kind>(d.kind))) + " table";
  check_size(file, table.c_str(), d.kind_table_size, table_size(d.kind));
  if ((d.parameter_count > 0 && !d.parameters) || (d.state_count > 0 && !d.state))
    refuse(file,
           name + "counts " + std::to_string(d.parameter_count) + " parameters and " + std::to_string(d.state_count) +
               " state fields, and one of the tables is null",
           remedy);
}

void check_rows(const Tables& tables, const std::filesystem::path& file) {
  const std::string remedy = "the plugin's tables are wrong: build it with plugin/sdk.hpp";
  const std::string name = std::string("descriptor `") + tables.descriptor.id + "` ";
  const auto incomplete = [&](const char* what, std::size_t row) {
    refuse(file, name + "has an incomplete " + what + " in row " + std::to_string(row + 1), remedy);
  };
  bool density = false;
  for (std::size_t k = 0; k < tables.parameters.size(); ++k) {
    const mpm_parameter& p = tables.parameters[k];
    if (!p.name || !p.unit || !p.doc || !p.choices || p.type > MPM_CHOICE ||
        p.offset + sizeof(double) > tables.descriptor.parameter_bytes || p.offset % sizeof(double) != 0)
      incomplete("parameter", k);
    density |= std::strcmp(p.name, "density") == 0;
  }
  for (std::size_t k = 0; k < tables.state.size(); ++k) {
    const mpm_state& s = tables.state[k];
    if (!s.name || !*s.name || !s.unit || !s.doc || s.shape > MPM_STATE_PLANE_DEFORMATION ||
        s.initial > MPM_INITIAL_IDENTITY)
      incomplete("state field", k);
  }
  if (tables.descriptor.kind == MPM_MATERIAL && !density)
    refuse(file, name + "is a material without a parameter `density`", remedy);
}

/// The checked copy of the descriptor at `source`. @throws PluginError.
std::shared_ptr<const Tables> copied(const void* source, const mpm_plugin_library& library,
                                     const std::filesystem::path& file) {
  auto tables = std::make_shared<Tables>();
  mpm_descriptor& d = tables->descriptor = widened<mpm_descriptor>(source, library.descriptor_size);
  check_descriptor(d, file);
  tables->parameters = rows<mpm_parameter>(d.parameters, d.parameter_count, library.parameter_size);
  tables->state = rows<mpm_state>(d.state, d.state_count, library.state_size);
  std::memset(static_cast<void*>(&tables->kind), 0, sizeof tables->kind);
  std::memcpy(static_cast<void*>(&tables->kind), d.kind_table, d.kind_table_size);
  check_rows(*tables, file);
  d.parameters = tables->parameters.data();
  d.state = tables->state.data();
  d.kind_table = &tables->kind;
  d.kind_table_size = static_cast<std::uint32_t>(table_size(d.kind));
  return tables;
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
    const char* first = reinterpret_cast<const char*>(library.descriptors);
    const auto tables = copied(first + static_cast<std::size_t>(k) * library.descriptor_size, library, file);
    const mpm_descriptor& d = tables->descriptor;
    const std::string name = std::string(kind_name(static_cast<mpm_kind>(d.kind))) + " `" + d.id + "`";
    if (const Plugin* earlier = find(static_cast<mpm_kind>(d.kind), d.id))
      refuse(file, "offers " + name + ", which " + earlier->file.string() + " already offers",
             "rename one of them or remove a folder from MPM_PLUGIN_PATH");
    if (std::any_of(found.begin(), found.end(), [&](const Plugin& plugin) { return offers(plugin, d); }))
      refuse(file, "offers " + name + " twice", "rename one of them");
    found.push_back({&d, file, tables});
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
