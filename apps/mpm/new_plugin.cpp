// Verb `new`: a project of its own for a plugin, written from texts that are compiled into the program.

#include <algorithm>
#include <cctype>
#include <iostream>
#include <iterator>

#include "experiment/diagnostics.hpp"
#include "mpm/cli.hpp"
#include "support/files.hpp"

namespace mpm::app {
namespace {

namespace fs = std::filesystem;

struct Text {
  const char* name;  ///< path such as "material/my_plugin.hpp"; "common/" for every kind
  const char* text;
};
/// The texts of apps/mpm/templates, where the plugin is called my_plugin, its class MyPlugin and its kind my_kind.
constexpr Text texts[] = {
#include "templates.inc"
};

/// The classes of kernel/, which every functor sees.
constexpr std::string_view kernel_classes[] = {
#include "kernel_classes.inc"
};

[[noreturn]] void refuse(const std::string& message) {
  throw InputError({Problem{"mpm new", 0, 0, "", message}});
}

mpm_kind plugin_kind(const std::string& name) {
  std::vector<std::string> names;
  for (const mpm_kind kind : all_kinds()) {
    names.emplace_back(kind_name(kind));
    if (names.back() == name) return kind;
  }
  refuse("no kind of plugin is called " + in_quotes(name) + suggestion(name, names, "kinds are " + quoted_list(names)));
}

/// The class of an id: my_rubber becomes MyRubber.
std::string class_name(const std::string& id) {
  std::string name;
  bool first = true;
  for (const char c : id) {
    if (c != '_') name += first ? static_cast<char>(std::toupper(static_cast<unsigned char>(c))) : c;
    first = c == '_';
  }
  return name;
}

void check_id(mpm_kind kind, const std::string& id) {
  const auto allowed = [](unsigned char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_'; };
  const bool starts = !id.empty() && id[0] >= 'a' && id[0] <= 'z';
  if (!starts || id.size() > 64 || !std::all_of(id.begin(), id.end(), allowed))
    refuse("the id " + in_quotes(id) +
           " cannot be used: it starts with a lower-case letter, goes on with lower-case letters, digits and '_', and "
           "has at most 64 characters, as in \"my_rubber\"");
  const std::string functor = class_name(id);
  if (std::find(std::begin(kernel_classes), std::end(kernel_classes), functor) != std::end(kernel_classes))
    refuse("the id " + in_quotes(id) + " cannot be used: its class " + functor +
           " is one of the kernel headers; choose another id");
  const Registry registry = Registry::from_folders(Registry::default_folders());
  if (const Plugin* plugin = registry.find(kind, id))
    refuse("there is a " + std::string(kind_name(kind)) + " " + in_quotes(id) + " already (" + plugin->file.string() +
           "); choose another id");
}

void check_folder(const fs::path& folder) {
  std::error_code error;
  if (folder.empty()) refuse("the folder to write into has no name");
  if (!fs::exists(folder, error)) return;
  if (!fs::is_directory(folder, error)) refuse(folder.string() + " is there already and is no folder; name another");
  if (!fs::is_empty(folder, error)) refuse(folder.string() + " is there already and not empty; name another folder");
}

fs::path running_program() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  return error ? fs::path("mpm") : program;
}

/// The folder of this program's CMake package, in a build tree or an installed one; empty when it has none.
fs::path package_folder(const fs::path& program) {
  const fs::path root = program.parent_path().parent_path();
  for (const fs::path& folder : {root, root / "lib/cmake/mpm_sandbox"}) {
    std::error_code error;
    if (fs::exists(folder / "mpm_sandboxConfig.cmake", error)) return folder;
  }
  return {};
}

/// The word as a shell takes it for one.
std::string quoted_for_shell(const std::string& word) {
  const auto plain = [](unsigned char c) {
    return std::isalnum(c) || std::string_view("/._-+=:,@%").find(c) != std::string_view::npos;
  };
  if (!word.empty() && std::all_of(word.begin(), word.end(), plain)) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

void replace_all(std::string& text, std::string_view from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
}

struct File {
  fs::path name;
  std::string text;
};

/// The files of one project, every name filled in.
std::vector<File> project(const std::string& kind, const std::string& id, const fs::path& program,
                          const fs::path& package) {
  std::vector<File> files;
  for (const Text& text : texts) {
    const fs::path path = text.name;
    if (path.parent_path() != kind && path.parent_path() != "common") continue;
    File file{path.filename(), text.text};
    if (file.name == "experiment.json") file.name = id + ".json";
    if (file.name.stem() == "my_plugin") file.name = id + file.name.extension().string();
    replace_all(file.text, "my_plugin", id);
    replace_all(file.text, "MyPlugin", class_name(id));
    replace_all(file.text, "my_kind", kind);
    replace_all(file.text, "@package@", package.empty() ? "\"\"" : "[==[" + package.string() + "]==]");
    replace_all(file.text, "@program@", quoted_for_shell(program.string()));
    files.push_back(std::move(file));
  }
  return files;
}

/// Writes all files or none.
void write(const std::vector<File>& files, const fs::path& folder) {
  std::error_code error;
  const bool made = fs::create_directories(folder, error);
  if (error) throw support::MachineError::from_errno("make the folder", folder, error.value());
  try {
    for (const File& file : files) support::write_atomically(folder / file.name, file.text);
  } catch (...) {
    for (const File& file : files) fs::remove(folder / file.name, error);
    if (made) fs::remove(folder, error);
    throw;
  }
}

}  // namespace

int new_plugin(const std::string& kind, const std::string& id, const fs::path& folder) {
  check_id(plugin_kind(kind), id);
  check_folder(folder);
  const fs::path program = running_program(), package = package_folder(program);
  const std::vector<File> files = project(kind, id, program, package);
  write(files, folder);

  std::cout << kind << " " << in_quotes(id) << " is in " << folder.string() << ":";
  for (const File& file : files) std::cout << " " << file.name.string();
  const std::string source = quoted_for_shell(folder.string()), build = quoted_for_shell((folder / "build").string());
  std::cout << "\nconfigure, build, test, run:\n  cmake -G Ninja -S " << source << " -B " << build;
  if (!package.empty()) std::cout << " -Dmpm_sandbox_DIR=" << quoted_for_shell(package.string());
  std::cout << "\n  cmake --build " << build << "\n  ctest --test-dir " << build << " --output-on-failure\n"
            << "  MPM_PLUGIN_PATH=" << quoted_for_shell((folder / "build/plugins").string()) << " "
            << quoted_for_shell(program.string()) << " run " << quoted_for_shell((folder / (id + ".json")).string())
            << "\n";
  if (package.empty())
    std::cerr
        << "warning: no CMake package lies beside " << program.string()
        << "; configure with -Dmpm_sandbox_DIR=FOLDER (the sandbox's build folder, or lib/cmake/mpm_sandbox of an "
           "installed one)\n";
  return done;
}

}  // namespace mpm::app
