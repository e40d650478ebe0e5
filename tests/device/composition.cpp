// The composed text itself: what is in it, how it is named, and what is refused.

#include <sys/time.h>

#include <csignal>
#include <fstream>

#include "backends/device/device.hpp"
#include "backends/device/drivers/nvrtc.hpp"
#include "device/device_support.hpp"
#include "support/temporary_folder.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

device::Choice usual_choice() {
  return device_choice_of(device_experiment(Mix{}.text(), "double"));
}

/// A copy of the usual shape whose functor's text is another.
struct OddShape {
  mpm_descriptor descriptor = *plugins().find(MPM_SHAPE, "bspline_quadratic")->descriptor;
  Plugin plugin;
  explicit OddShape(const char* source) {
    descriptor.source = source;
    plugin.descriptor = &descriptor;
  }
};

const device::Composition small_composition{"a small one", "int f() { return 1; }\n", "", {}, {}};

/// A compiler of a few lines for the shell.
device::HostCompiler compiler_of_shell(const TemporaryFolder& folder, const std::string& lines) {
  const std::filesystem::path file = folder / "compiler";
  std::ofstream(file) << "#!/bin/sh\n" << lines << "\n";
  std::filesystem::permissions(file, std::filesystem::perms::owner_all);
  device::HostCompiler compiler;
  compiler.program = file.string();
  return compiler;
}

/// A timer that interrupts system calls of this process every few milliseconds.
class Interruptions {
 public:
  Interruptions() {
    struct sigaction action = {};
    action.sa_handler = [](int) {};
    sigaction(SIGALRM, &action, &before_);
    every(5000);
  }
  ~Interruptions() {
    every(0);
    sigaction(SIGALRM, &before_, nullptr);
  }
  Interruptions(const Interruptions&) = delete;
  Interruptions& operator=(const Interruptions&) = delete;

 private:
  static void every(int microseconds) {
    const itimerval timer{{0, microseconds}, {0, microseconds}};
    setitimer(ITIMER_REAL, &timer, nullptr);
  }
  struct sigaction before_ = {};
};

}  // namespace

TEST_CASE("a composition is one text without directives to include", "[device]") {
  const device::Composition composition = device::compose(usual_choice());
  CHECK(composition.name == "2-D double: bspline_quadratic apic neo_hookean");
  CHECK(composition.text.find("#include") == std::string::npos);
  CHECK(composition.text.find("#pragma once") == std::string::npos);
  CHECK(composition.text.find("struct BsplineQuadratic") != std::string::npos);
  CHECK(composition.text.find("plugin/abi.h") == std::string::npos);
  for (const std::string entry : {"mpm_clear", "mpm_scatter", "mpm_gather", "mpm_move", "mpm_stress_0", "mpm_strain_0"})
    CHECK(std::count(composition.entries.begin(), composition.entries.end(), entry) == 1);
  for (const std::string entry : {"mpm_contact", "mpm_project", "mpm_stress_1"})
    CHECK(std::count(composition.entries.begin(), composition.entries.end(), entry) == 0);
}

TEST_CASE("a plugin that two materials share is in the text once", "[device]") {
  device::Choice choice = usual_choice();
  choice.materials.push_back(choice.materials[0]);
  const std::string text = device::compose(choice).text;
  const std::size_t first = text.find("struct NeoHookean : ");
  REQUIRE(first != text.npos);
  CHECK(text.find("struct NeoHookean : ", first + 1) == text.npos);
}

TEST_CASE("the hash names text and options", "[device]") {
  const device::Choice choice = usual_choice();
  const device::Composition first = device::compose(choice), again = device::compose(choice);
  CHECK(first.hash == again.hash);
  CHECK(first.hash.size() == 64);
  std::set<std::string> hashes{first.hash};
  device::Choice other = choice;
  other.dimension = 3;
  CHECK(hashes.insert(device::compose(other).hash).second);
  other = choice, other.precision = Precision::single;
  CHECK(hashes.insert(device::compose(other).hash).second);
  other = choice, other.transfer = plugins().find(MPM_TRANSFER, "mls");
  CHECK(hashes.insert(device::compose(other).hash).second);
  other = choice, other.contact = plugins().find(MPM_CONTACT, "stick");
  CHECK(hashes.insert(device::compose(other).hash).second);

  const std::string key = device::cache_key(first, "NVRTC 13.0", device::Nvrtc::options("sm_90"));
  CHECK(key == device::cache_key(again, "NVRTC 13.0", device::Nvrtc::options("sm_90")));
  CHECK(key != device::cache_key(first, "NVRTC 13.0", device::Nvrtc::options("sm_80")));
  CHECK(key != device::cache_key(first, "NVRTC 12.9", device::Nvrtc::options("sm_90")));
}

TEST_CASE("a functor that includes what a device cannot see is refused with its place", "[device]") {
  device::Choice choice = usual_choice();
  SECTION("a system header") {
    const OddShape odd("#pragma once\n#include \"kernel/functor.hpp\"\n#include <vector>\n");
    choice.shape = &odd.plugin;
    CHECK_THROWS_WITH(device::compose(choice),
                      "shape plugin bspline_quadratic, line 3 includes <vector>, which a device cannot see; a functor "
                      "includes \"kernel/...\" headers only, and others inside #if MPM_HOST");
  }
  SECTION("a header that is not there") {
    const OddShape odd("#include \"kernel/nothing.hpp\"\n");
    choice.shape = &odd.plugin;
    CHECK_THROWS_WITH(
        device::compose(choice),
        "shape plugin bspline_quadratic, line 1 includes \"kernel/nothing.hpp\", which a device cannot see; "
        "include headers of modules/kernel only");
  }
  SECTION("no text at all") {
    const OddShape odd("");
    choice.shape = &odd.plugin;
    CHECK_THROWS_WITH(device::compose(choice),
                      "shape plugin bspline_quadratic carries no text of its functor; build it "
                      "with mpm_add_plugin(... HEADER file)");
  }
  SECTION("but what only the host sees may stay") {
    const std::string text = "#if MPM_HOST\n#include <vector>\n#endif\n" +
                             std::string(plugins().find(MPM_SHAPE, "bspline_quadratic")->descriptor->source);
    const OddShape odd(text.c_str());
    choice.shape = &odd.plugin;
    CHECK_NOTHROW(device::HostCompiler{}.compile(device::compose(choice)));
  }
}

TEST_CASE("includes are looked for where a device looks, in groups within groups", "[device]") {
  device::Choice choice = usual_choice();
  const auto line_refused = [&](const char* source) {
    const OddShape odd(source);
    choice.shape = &odd.plugin;
    try {
      device::compose(choice);
    } catch (const device::ComposeError& error) {
      const std::string message = error.what(), start = "shape plugin bspline_quadratic, line ";
      REQUIRE(message.rfind(start, 0) == 0);
      return std::stoi(message.substr(start.size()));
    }
    return 0;
  };
  const std::string in_host = "#if MPM_HOST\n#include <a>\n";
  for (const auto& [source, line] : std::vector<std::pair<std::string, int>>{
           {"#include <b>\n", 1},
           {"  #  include <b>\n", 1},
           {"#include \"\n", 1},
           {"#include \"plugin/abi.h\"\n", 1},
           {"#if 1\n#include <b>\n#endif\n", 2},
           {"// include b\n# define ODD 1\nint odd = 1; // as #if MPM_HOST\n", 0},
           {in_host + "#endif\n", 0},
           {in_host + "\n#endif\n#include <b>\n", 5},
           {in_host + "#else\n#include <b>\n#endif\n", 4},
           {in_host + "#elif 1\n#include <b>\n#endif\n", 4},
           {in_host + "#if 1\n#include <a>\n#else\n#include <a>\n#endif\n#include <a>\n#endif\n", 0},
           {in_host + "  #if 1\n#endif\n#include <a>\n#endif\n#include <b>\n", 7},
           {"#if 1\n  #if MPM_HOST\n#include <a>\n#endif\n#include <b>\n#endif\n", 5}}) {
    INFO(source);
    CHECK(line_refused(source.c_str()) == line);
  }
}

TEST_CASE("a choice is named by its plugins in order, each with its file once", "[device]") {
  device::Choice choice = usual_choice();
  choice.axisymmetric = true, choice.precision = Precision::single, choice.basis_order = 2;
  choice.contact = plugins().find(MPM_CONTACT, "stick");
  choice.rigid_laws = {choice.contact, plugins().find(MPM_CONTACT, "coulomb")};
  CHECK(choice.name() ==
        "2-D axisymmetric float: bspline_quadratic apic stick stick coulomb neo_hookean, polynomials of order 2");
  std::vector<std::string> names;
  for (const auto& [name, file] : device::compose(choice).plugins) names.push_back(name);
  CHECK(names == std::vector<std::string>{"shape plugin bspline_quadratic", "transfer plugin apic",
                                          "contact plugin stick", "contact plugin coulomb",
                                          "material plugin neo_hookean"});
  Mix full;
  full.transfer = R"({"type": "polypic", "basis": "full"})";  // of stencils of three nodes: squares along each axis
  CHECK(device_choice_of(device_experiment(full.text(), "double")).name() ==
        "2-D double: bspline_quadratic polypic neo_hookean, polynomials of order 2");
}

TEST_CASE("each trait of a transfer that reads the affine moment makes kernels find it", "[device]") {
  device::Choice choice = usual_choice();
  Plugin transfer = *choice.transfer;
  mpm_descriptor descriptor = *transfer.descriptor;
  mpm_transfer table = transfer.transfer();
  transfer.descriptor = &descriptor, descriptor.kind_table = &table, choice.transfer = &transfer;
  for (const auto& [traits, affine] : {std::pair{0u, "false"},
                                       {unsigned(MPM_SCATTERS_AFFINE | MPM_GATHERS_GRADIENT), "false"},
                                       {unsigned(MPM_GATHERS_AFFINE), "true"},
                                       {unsigned(MPM_STRESS_BY_AFFINE), "true"},
                                       {unsigned(MPM_STRAIN_BY_AFFINE), "true"}}) {
    table.traits = traits;
    CHECK(device::compose(choice).text.find(std::string("  static constexpr bool affine = ") + affine + ";") !=
          std::string::npos);
  }
}

TEST_CASE("a field that a scene has not has a number below zero", "[device]") {
  const device::Choice choice = usual_choice();
  for (const std::string id : {"temperature", "melted_fraction", "size", "artificial_pressure", "initial_position"}) {
    INFO(id);
    CHECK(device::number_of(choice.particle_fields, id) < 0);
  }
  CHECK(device::first_of({}, Origin::transfer) < 0);
  CHECK(device::first_of(choice.particle_fields, Origin::transfer) > 0);
}

TEST_CASE("the host-run device says what a compiler refuses and where", "[device]") {
  device::Composition broken{"a broken one", "#line 7 \"shape plugin odd\"\nint f() { return nowhere; }\n", "", {}};
  CHECK_THROWS_WITH(device::HostCompiler{}.compile(broken), ContainsSubstring("a broken one") &&
                                                                ContainsSubstring("shape plugin odd:7") &&
                                                                ContainsSubstring("nowhere"));
  device::HostCompiler none;
  none.program = "no-such-compiler";
  CHECK_THROWS_WITH(none.compile(broken), ContainsSubstring("apt install g++"));
}

TEST_CASE("a compiler of the host is told by the words and the end of the call that fails", "[device]") {
  const TemporaryFolder folder;
  const auto said = [&](const std::string& lines, const std::string& words) {
    const device::HostCompiler compiler = compiler_of_shell(folder, lines);
    CHECK_THROWS_WITH(compiler.compile(small_composition),
                      "\"" + compiler.program + "\" does not compile the composition a small one " + words);
  };
  said("case \"$*\" in *-shared*) echo short >&2; exit 3;; esac\necho many words of the first call, which is well",
       "(status 3):\nshort\n");
  said("kill -9 $$", "(status 137):\n");  // 128 and the signal, as of shells
  const device::HostCompiler compiler = compiler_of_shell(folder, "echo it is broken\nexit 4");
  CHECK_THROWS_WITH(compiler.version(), "\"" + compiler.program + " --version\" ends with status 4");
  CHECK(compiler_of_shell(folder, "echo one 1.2\necho more").version() == "one 1.2");
}

TEST_CASE("a compiler of the host leaves nothing behind, whatever signals this process takes", "[device]") {
  const TemporaryFolder folder;
  const char* const before = std::getenv("TMPDIR");
  const std::string usual = before ? before : "";
  setenv("TMPDIR", folder.path().c_str(), 1);
  const device::HostCompiler compiler;
  const auto compiles = [&] { return compiler.compile(small_composition).starts_with("\177ELF"); };
  {
    const Interruptions interruptions;
    CHECK(compiles());
  }
  const auto usual_action = std::signal(SIGCHLD, SIG_IGN);  // as some parents leave it to their children
  // A compiler that failed would look like one that has not.
  CHECK_THROWS_WITH(compiler.compile(small_composition),
                    "it is not known how \"c++\" ended, as this process ignores SIGCHLD; set it to SIG_DFL");
  std::signal(SIGCHLD, usual_action);
  CHECK(std::filesystem::is_empty(folder.path()));
  before ? setenv("TMPDIR", usual.c_str(), 1) : unsetenv("TMPDIR");
}

TEST_CASE("the host-run device names a phase that a composition lacks", "[device]") {
  const device::Composition composition = device::compose(usual_choice());
  const device::DeviceSetup setup = device_setup();
  device::Device device(*setup.driver, setup.number);
  device.load(Programs::shared().of(composition), composition.name);
  CHECK_THROWS_WITH(device.launch("contact", device::Arguments<double>{}, 1, 1),
                    "the composition 2-D double: bspline_quadratic apic neo_hookean has no phase \"contact\"");
}
