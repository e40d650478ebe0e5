// What the loader says of every kind of file that cannot be used, word for word.

#include <dlfcn.h>

#include <cstdlib>
#include <fstream>

#include "conformance/conformance.hpp"
#include "fixtures/mpm_fixture.hpp"
#include "plugin/extension_of.hpp"
#include "plugin/registry.hpp"
#include "support/catch.hpp"

namespace {

namespace fs = std::filesystem;

/// The loader's message for a file, or nothing when it loads.
std::string message_for(const fs::path& file) {
  mpm::Registry registry;
  try {
    registry.load(file);
  } catch (const mpm::PluginError& error) {
    return error.what();
  }
  return "";
}

std::string start(const fs::path& file) {
  return "plugin " + file.string() + ": ";
}

const std::string rebuild = "; rebuild the plugin against this version's headers";
const std::string wrong_tables = "; the plugin's tables are wrong: build it with plugin/sdk.hpp";

}  // namespace

TEST_CASE("a whole plugin in plain C loads and is found by kind and id") {
  const fixture::TemporaryFolder folder;
  const fs::path file = folder / "whole.so";
  fixture::build_plugin(file);
  mpm::Registry registry;
  registry.load(file);
  REQUIRE(registry.plugins().size() == 1);
  const mpm::Plugin* plugin = registry.find(MPM_SHAPE, "fixture");
  REQUIRE(plugin);
  CHECK(plugin->file == file);
  CHECK(plugin->shape().width == 2);
  CHECK(plugin->parameters().size() == 1);
  CHECK(plugin->state().empty());
  CHECK(registry.find(MPM_MATERIAL, "fixture") == nullptr);
  CHECK(registry.of_kind(MPM_SHAPE).size() == 1);
  CHECK(registry.of_kind(MPM_CONTACT).empty());
}

TEST_CASE("a plugin of another ABI version is refused before anything else of it is read") {
  const fixture::TemporaryFolder folder;
  for (const int version : {1, 77}) {
    // What stands behind the version would be refused, or crash, if it were looked at.
    const fs::path file = folder / ("version" + std::to_string(version) + ".so");
    fixture::build_plugin(file, "-DFIXTURE_ABI=" + std::to_string(version) +
                                    " -DFIXTURE_SIZE=0 '-DFIXTURE_DESCRIPTORS=(const mpm_descriptor*)8'");
    CHECK(message_for(file) == start(file) + "was built for plugin ABI version " + std::to_string(version) +
                                   ", this program has version " + std::to_string(MPM_ABI_VERSION) + rebuild);
  }
}

TEST_CASE("tables of another size than this version's are refused with both") {
  const fixture::TemporaryFolder folder;
  const auto refused = [&](const std::string& name, const std::string& define, const std::string& message) {
    const fs::path file = folder / name;
    fixture::build_plugin(file, define);
    CHECK(message_for(file) == start(file) + message + wrong_tables);
  };
  refused("library.so", "-DFIXTURE_SIZE=12",
          "has a library table of 12 bytes, this program has " + std::to_string(sizeof(mpm_plugin_library)));
  refused("table.so", "-DFIXTURE_TABLE_SIZE=800",
          "has descriptor `fixture` with a shape table of 800 bytes, this program has " +
              std::to_string(sizeof(mpm_shape)));
}

TEST_CASE("extensions are found by id, and refused when their version or kind is another") {
  const fixture::TemporaryFolder folder;
  const auto with = [&](const std::string& name, const std::string& table, const std::string& id) {
    const fs::path file = folder / name;
    std::ofstream(folder / "answer.h") << "#include <string.h>\nstatic const mpm_costs costs = {" << table
                                       << "};\n#define FIXTURE_EXTENSION(id) strcmp(id, \"" << id
                                       << "\") == 0 ? &costs : NULL\n";
    fixture::build_plugin(file, "-include plugin/extensions.h -include '" + (folder / "answer.h").string() + "'");
    return file;
  };
  const fs::path good = with("good.so", "1, 0, 0", MPM_COSTS_ID);
  mpm::Registry registry;
  registry.load(good);
  const mpm::Plugin& plugin = registry.plugins().front();
  CHECK(plugin.extension(MPM_COSTS_ID) != nullptr);
  CHECK(plugin.extension("mpm.something.else") == nullptr);
  CHECK(mpm::extension_of<mpm_costs>(plugin)->version == 1);
  CHECK(mpm::extension_of<mpm_shape_boxes>(plugin) == nullptr);

  const fs::path newer = with("newer.so", "9, 0, 0", MPM_COSTS_ID);
  CHECK(message_for(newer) ==
        start(newer) +
            "descriptor `fixture` offers the extension `mpm.costs` of version 9, this program has "
            "version 1" +
            rebuild);
  const fs::path other = with("other.so", "1, 0, 0", MPM_MATERIAL_TRIAL_ID);
  CHECK(message_for(other) == start(other) +
                                  "descriptor `fixture` is a shape and offers the extension `mpm.material.trial` of a "
                                  "material" +
                                  wrong_tables);
}

TEST_CASE("missing tables and incomplete rows are refused before anything reads them") {
  const fixture::TemporaryFolder folder;
  const auto refused = [&](const std::string& name, const std::string& define, const std::string& message) {
    const fs::path file = folder / name;
    fixture::build_plugin(file, define);
    CHECK(message_for(file) == start(file) + message + wrong_tables);
  };
  refused("descriptors.so", "-DFIXTURE_DESCRIPTORS=NULL", "holds no descriptor");
  refused("none.so", "-DFIXTURE_COUNT=0", "holds no descriptor");
  refused("parameters.so", "-DFIXTURE_PARAMETERS=NULL",
          "descriptor `fixture` counts 1 parameters and 0 state fields, and one of the tables is null");
  refused("state.so", "-DFIXTURE_HAS_STATE -DFIXTURE_STATE=NULL",
          "descriptor `fixture` counts 1 parameters and 1 state fields, and one of the tables is null");
  refused("name.so", "-DFIXTURE_HAS_STATE -DFIXTURE_STATE_NAME=NULL",
          "descriptor `fixture` has an incomplete state field in row 1");
}

TEST_CASE("a contact law's state that nodes could not average is refused by name") {
  const fixture::TemporaryFolder folder;
  const std::string law = "-DFIXTURE_KIND=MPM_CONTACT '-DFIXTURE_TABLE_SIZE=sizeof(mpm_contact)' -DFIXTURE_HAS_STATE ";
  const auto refused = [&](const std::string& name, const std::string& define, const std::string& message) {
    const fs::path file = folder / name;
    fixture::build_plugin(file, law + define);
    CHECK(message_for(file) == start(file) + message + wrong_tables);
  };
  refused("three.so", "-DFIXTURE_STATE_COUNT=3",
          "descriptor `fixture` is a contact law with 3 state fields; there is room for 2");
  const std::string scalar =
      "descriptor `fixture` is a contact law whose state field `first` is not a scalar that begins at zero";
  refused("vector.so", "-DFIXTURE_STATE_SHAPE=MPM_STATE_VECTOR", scalar);
  refused("one.so", "-DFIXTURE_STATE_INITIAL=MPM_INITIAL_ONE", scalar);
  const fs::path two = folder / "two.so";
  fixture::build_plugin(two, law + "-DFIXTURE_STATE_COUNT=2");
  CHECK(message_for(two).empty());
}

TEST_CASE("one file that offers an id twice is refused whole") {
  const fixture::TemporaryFolder folder;
  const fs::path file = folder / "twice.so";
  fixture::build_plugin(file, "-DFIXTURE_COUNT=2");
  CHECK(message_for(file) == start(file) + "offers shape `fixture` twice; rename one of them");
}

TEST_CASE("a refused library is not kept loaded, an accepted one is") {
  const fixture::TemporaryFolder folder;
  const auto loaded = [](const fs::path& file) {
    void* handle = dlopen(file.c_str(), RTLD_NOW | RTLD_NOLOAD);
    if (handle) dlclose(handle);
    return handle != nullptr;
  };
  const fs::path bad = folder / "bad.so", good = folder / "good.so";
  fixture::build_plugin(bad, "-DFIXTURE_COUNT=2");
  fixture::build_plugin(good);
  CHECK(!message_for(bad).empty());
  CHECK(!loaded(bad));
  CHECK(message_for(good).empty());
  CHECK(loaded(good));
}

TEST_CASE("a shared object without the plugin symbol is refused") {
  const fixture::TemporaryFolder folder;
  const fs::path file = folder / "symbol.so";
  fixture::build_plugin(file, "-DFIXTURE_SYMBOL=another_name");
  CHECK(message_for(file) ==
        start(file) +
            "exports no symbol `mpm_plugin_library_v`; a plugin needs MPM_EXPORT_PLUGIN in one of its sources");
}

TEST_CASE("a truncated plugin is refused before it is mapped") {
  const fixture::TemporaryFolder folder;
  const fs::path file = folder / "truncated.so";
  fixture::build_plugin(file);
  const auto whole = fs::file_size(file);
  fs::resize_file(file, whole / 2);
  const std::string message = message_for(file);
  // The section table stands at the end of the file, so what is needed is what there was.
  CHECK(message == start(file) + "is truncated (" + std::to_string(whole / 2) + " of at least " +
                       std::to_string(whole) + " bytes); rebuild or copy it again");
  fs::resize_file(file, 10);
  CHECK(message_for(file) == start(file) + "is not a shared object; rebuild it or remove it from the plugin folder");
}

TEST_CASE("a file that is not a shared object is refused") {
  const fixture::TemporaryFolder folder;
  const fs::path file = folder / "text.so";
  std::ofstream(file)
      << "This is a text of more than sixty-four bytes, which is what the header of an ELF file takes.\n";
  CHECK(message_for(file) == start(file) + "is not a shared object; rebuild it or remove it from the plugin folder");
  const fs::path missing = folder / "missing.so";
  CHECK(message_for(missing) ==
        start(missing) + "is not a shared object; rebuild it or remove it from the plugin folder");
}

TEST_CASE("a plugin that needs a symbol nobody defines is refused with its name") {
  const fixture::TemporaryFolder folder;
  const fs::path file = folder / "undefined.so";
  fixture::build_plugin(file, "-DFIXTURE_CALLS_NOTHING_DEFINED");
  CHECK(message_for(file) == start(file) + "cannot be loaded: " + file.string() +
                                 ": undefined symbol: mpm_fixture_defined_nowhere; rebuild it on this machine");
}

TEST_CASE("a descriptor that makes no sense is refused") {
  const fixture::TemporaryFolder folder;
  const std::string table = std::to_string(sizeof(mpm_shape));
  const fs::path kind = folder / "kind.so", unit = folder / "unit.so", id = folder / "id.so",
                 material = folder / "material.so";
  fixture::build_plugin(kind, "-DFIXTURE_KIND=9");
  CHECK(message_for(kind) ==
        start(kind) + "descriptor `fixture` has kind 9 with a table of " + table + " bytes" + wrong_tables);
  fixture::build_plugin(unit, "-DFIXTURE_UNIT=NULL");
  CHECK(message_for(unit) == start(unit) + "descriptor `fixture` has an incomplete parameter in row 1" + wrong_tables);
  fixture::build_plugin(id, "-DFIXTURE_ID=NULL");
  CHECK(message_for(id) ==
        start(id) + "has a descriptor without id, version, summary, citation, manual or functor source" + wrong_tables);
  fixture::build_plugin(material, "-DFIXTURE_KIND=MPM_MATERIAL");
  CHECK(message_for(material) == start(material) + "has descriptor `fixture` with a material table of " + table +
                                     " bytes, this program has " + std::to_string(sizeof(mpm_material)) + wrong_tables);
}

TEST_CASE("two files with one kind and id: the first folder wins, the second is named") {
  const fixture::TemporaryFolder first, second;
  fixture::build_plugin(first / "one.so");
  fixture::build_plugin(second / "two.so");
  const fs::path folders[] = {first.path(), second.path()};
  const mpm::Registry registry = mpm::Registry::from_folders(folders);
  REQUIRE(registry.plugins().size() == 1);
  CHECK(registry.plugins()[0].file == first / "one.so");
  REQUIRE(registry.rejected().size() == 1);
  CHECK(registry.rejected()[0] == start(second / "two.so") + "offers shape `fixture`, which " +
                                      (first / "one.so").string() +
                                      " already offers; rename one of them or remove a folder from MPM_PLUGIN_PATH");
}

TEST_CASE("a folder with one bad file still gives its good ones") {
  const fixture::TemporaryFolder folder;
  fixture::build_plugin(folder / "good.so");
  std::ofstream(folder / "bad.so") << "no";
  std::ofstream(folder / "notes.txt") << "not looked at";
  const fs::path folders[] = {folder.path(), folder / "absent"};
  const mpm::Registry registry = mpm::Registry::from_folders(folders);
  CHECK(registry.plugins().size() == 1);
  REQUIRE(registry.rejected().size() == 1);
  CHECK(registry.rejected()[0] ==
        start(folder / "bad.so") + "is not a shared object; rebuild it or remove it from the plugin folder");
}

TEST_CASE("MPM_PLUGIN_PATH comes before the folders of the program") {
  const char* before = std::getenv("MPM_PLUGIN_PATH");
  const std::string kept = before ? before : "";
  setenv("MPM_PLUGIN_PATH", "/first/folder::/second", 1);
  const auto folders = mpm::Registry::default_folders();
  before ? setenv("MPM_PLUGIN_PATH", kept.c_str(), 1) : unsetenv("MPM_PLUGIN_PATH");
  REQUIRE(folders.size() >= 2);
  CHECK(folders[0] == "/first/folder");
  CHECK(folders[1] == "/second");
}
