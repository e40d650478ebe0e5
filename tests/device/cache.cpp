// Programs of compositions, and the cache that keeps them.

#include "backends/device/cache.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <fstream>

#include "backends/device/program.hpp"
#include "device/device_support.hpp"
#include "support/files.hpp"
#include "support/hash.hpp"
#include "support/temporary_folder.hpp"

using namespace mpm;
using namespace mpm::test;
namespace fs = std::filesystem;

namespace {

/// The cache of this process lies in a folder for the time of a test.
struct CacheIn {
  explicit CacheIn(const fs::path& folder) { setenv("MPM_CACHE", folder.c_str(), 1); }
  ~CacheIn() { unsetenv("MPM_CACHE"); }
};

/// A compiler that counts, and gives what it was told to.
struct Counting final : device::Compiler {
  std::string name = "one";
  mutable int times = 0;
  std::string identity(const std::string&) const override { return name; }
  std::string compile(const device::Composition& composition, const std::string& architecture) const override {
    ++times;
    return "program of " + composition.name + " for " + architecture;
  }
};

/// A compiler that refuses a functor's text.
struct Refusing final : device::Compiler {
  std::string identity(const std::string&) const override { return "refusing"; }
  std::string compile(const device::Composition& composition, const std::string&) const override {
    return device::HostCompiler{}.compile(composition);
  }
};

/// A compiler that says what it was told to.
struct Saying final : device::Compiler {
  std::string words;
  std::string identity(const std::string&) const override { return "saying"; }
  std::string compile(const device::Composition&, const std::string&) const override {
    throw device::CompilerError(words);
  }
};

/// A variable of the environment for the time of a test; null where there is none.
class Variable {
 public:
  Variable(const char* name, const char* value) : name_(name) {
    if (const char* before = std::getenv(name)) before_ = before;
    set(value);
  }
  ~Variable() { set(before_ ? before_->c_str() : nullptr); }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  void set(const char* value) { value ? setenv(name_, value, 1) : unsetenv(name_); }
  const char* name_;
  std::optional<std::string> before_;
};

/// A compiler of large programs, whose bytes take a while to be written.
struct Large final : device::Compiler {
  std::string identity(const std::string&) const override { return "large"; }
  std::string compile(const device::Composition&, const std::string&) const override {
    std::string program(8 << 20, '\0');
    for (std::size_t k = 0; k < program.size(); ++k) program[k] = static_cast<char>(k * k >> 7);
    return program;
  }
};

/// Runs `body` in so many processes, all of which begin at once, and calls look() here until they have ended; returns how
/// many of them ended with code 0.
template <class Body, class Look>
int processes_at_once(int count, Body body, Look look) {
  std::array<int, 2> gate{};
  REQUIRE(pipe(gate.data()) == 0);
  std::vector<pid_t> children;
  for (int k = 0; k < count; ++k) {
    const pid_t child = fork();
    REQUIRE(child >= 0);
    if (child == 0) {
      close(gate[1]);
      char ignored = 0;
      const bool opened = read(gate[0], &ignored, 1) == 0;  // the end of the pipe
      _exit(opened && body() ? 0 : 1);
    }
    children.push_back(child);
  }
  close(gate[0]), close(gate[1]);
  int succeeded = 0;
  for (const pid_t child : children) {
    int status = 0;
    pid_t ended = 0;
    while ((ended = waitpid(child, &status, WNOHANG)) == 0) look();
    REQUIRE(ended == child);
    succeeded += WIFEXITED(status) && WEXITSTATUS(status) == 0;
  }
  return succeeded;
}

fs::path only_file_in(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder)) files.push_back(entry.path());
  REQUIRE(files.size() == 1);
  return files[0];
}

}  // namespace

TEST_CASE("a program is compiled once for its text, compiler and architecture", "[device][cache]") {
  const TemporaryFolder folder;
  const CacheIn here(folder / "cache");
  const device::Composition composition{"a scene", "text", "hash of text", {}, {}};
  Counting compiler;
  CHECK(device::program_of(composition, compiler, "sm_90") == "program of a scene for sm_90");
  CHECK(device::program_of(composition, compiler, "sm_90") == "program of a scene for sm_90");
  CHECK(compiler.times == 1);
  CHECK(device::program_of(composition, compiler, "sm_80") == "program of a scene for sm_80");
  CHECK(compiler.times == 2);
  compiler.name = "another version";
  device::program_of(composition, compiler, "sm_90");
  CHECK(compiler.times == 3);
  device::Composition other = composition;
  other.hash = "hash of another text";
  device::program_of(other, compiler, "sm_90");
  CHECK(compiler.times == 4);
  CHECK(device::ProgramCache::of_user().contents().programs == 4);
}

TEST_CASE("a program in the cache that is damaged is compiled again", "[device][cache]") {
  const TemporaryFolder folder;
  const CacheIn here(folder / "cache");
  const device::Composition composition{"a scene", "text", "hash of text", {}, {}};
  const Counting compiler;
  const std::string program = device::program_of(composition, compiler, "sm_90");
  const fs::path file = only_file_in(folder / "cache");
  const std::string whole = support::read_file(file);
  std::string changed = whole;
  changed.back() ^= 1;
  for (const std::string& damaged : {changed, whole.substr(0, whole.size() - 1), whole.substr(0, 10), std::string()}) {
    std::ofstream(file, std::ios::binary) << damaged;
    const int before = compiler.times;
    CHECK(device::program_of(composition, compiler, "sm_90") == program);
    CHECK(compiler.times == before + 1);
    CHECK(support::read_file(file) == whole);
  }
}

TEST_CASE("the cache drops what was used longest ago", "[device][cache]") {
  const TemporaryFolder folder;
  const device::ProgramCache cache(folder / "cache", 1000);
  const std::string program(300, 'x');  // and 64 bytes of its hash
  for (const std::string key : {"a", "b"}) cache.keep(key, program);
  const auto now = fs::file_time_type::clock::now();
  fs::last_write_time(folder / "cache/a.program", now - std::chrono::hours(2));
  fs::last_write_time(folder / "cache/b.program", now - std::chrono::hours(1));
  CHECK(cache.find("a") == program);  // which is a use
  cache.keep("c", program);
  CHECK(cache.find("a") == program);
  CHECK(!cache.find("b"));
  CHECK(cache.find("c") == program);
  CHECK(cache.contents().bytes == 728);
  cache.keep("large", std::string(2000, 'x'));
  CHECK(!cache.find("large"));
  CHECK(cache.clear().programs == 2);
  CHECK(cache.contents().programs == 0);
}

TEST_CASE("several processes may fill one cache at once", "[device][cache]") {
  const TemporaryFolder folder;
  const CacheIn here(folder / "cache");
  const device::Composition composition{"a scene", "text", "hash of text", {}, {}};
  const Large compiler;
  const std::string program = compiler.compile(composition, "");
  constexpr int count = 8;
  for (int round = 0; round < 3; ++round) {
    fs::remove_all(folder / "cache");
    bool whole = true;  // whenever an entry is there
    const auto fill = [&] {
      for (int k = 0; k < 4; ++k)
        if (device::program_of(composition, compiler, "sm_90") != program) return false;
      return true;
    };
    const auto look = [&] {
      std::error_code gone;
      for (const auto& entry : fs::directory_iterator(folder / "cache", gone))
        if (entry.path().extension() == ".program")
          whole = whole && fs::file_size(entry.path(), gone) == program.size() + 64;
    };
    CHECK(processes_at_once(count, fill, look) == count);
    CHECK(whole);
    const std::string kept = support::read_file(only_file_in(folder / "cache"));
    CHECK(kept.size() == program.size() + 64);
    CHECK(kept.substr(64) == program);
    CHECK(kept.substr(0, 64) == support::sha256(program));
  }
}

TEST_CASE("without a folder for it nothing is kept, and nothing fails", "[device][cache]") {
  const device::Composition composition{"a scene", "text", "hash of text", {}, {}};
  for (const std::string folder : {"", "/proc/no/such/folder"}) {
    const CacheIn here(folder);
    const Counting compiler;
    for (int k = 0; k < 2; ++k) CHECK(device::program_of(composition, compiler, "sm_90").size() > 10);
    CHECK(compiler.times == 2);
  }
}

TEST_CASE("a functor that does not compile is said with its plugin, its line and its file", "[device][cache]") {
  const CacheIn nowhere("");
  mpm_descriptor descriptor = *plugins().find(MPM_SHAPE, "bspline_quadratic")->descriptor;
  const std::string text =
      "#include \"kernel/functor.hpp\"\n" + std::string("int wrong() { return nowhere; }\n") + descriptor.source;
  descriptor.source = text.c_str();
  Plugin odd;
  odd.descriptor = &descriptor, odd.file = "/somewhere/shape_odd.so";
  device::Choice choice = device_choice_of(device_experiment(Mix{}.text(), "double"));
  choice.shape = &odd;
  CHECK_THROWS_WITH(
      device::program_of(device::compose(choice), Refusing{}, "host"),
      ContainsSubstring("shape plugin bspline_quadratic:2") && ContainsSubstring("nowhere") &&
          ContainsSubstring("the text of shape plugin bspline_quadratic comes from /somewhere/shape_odd.so"));
}

TEST_CASE("files of plugins are told where a compiler names their text, in the ways of GCC and NVRTC",
          "[device][cache]") {
  const CacheIn nowhere("");
  device::Composition composition{"a scene", "text", "hash of text", {}, {}};
  composition.plugins = {{"material plugin a", "/a.so"}, {"shape plugin b", "/b.so"}, {"contact plugin c", "/c.so"}};
  Saying compiler;
  compiler.words =
      "material plugin a:7: error: no\nshape plugin b(9): error: nor this; contact plugin c, which is right";
  CHECK_THROWS_WITH(
      device::program_of(composition, compiler, "host"),
      compiler.words + "\nthe text of material plugin a comes from /a.so\nthe text of shape plugin b comes from /b.so");
}

TEST_CASE("a program of the host is kept by its compiler's name, version and options", "[device][cache]") {
  const TemporaryFolder folder;
  const CacheIn here(folder / "cache");
  const device::Composition composition{"a scene", "int f() { return 1; }\n", "hash of text", {}, {}};
  const std::string program = device::setup_for("host").compile(composition, "host");
  const device::HostCompiler compiler;
  std::string identity = "c++\n" + compiler.version();
  for (const std::string& option : compiler.all_options()) identity += "\n" + option;
  const device::ProgramCache cache = device::ProgramCache::of_user();
  CHECK(cache.find(device::cache_key(composition, identity, {"host"})) == program);
  CHECK(cache.contents().programs == 1);
}

TEST_CASE("the cache lies where the environment says, and keeps up to 256 MiB", "[device][cache]") {
  // XDG Base Directory Specification: XDG_CACHE_HOME, or $HOME/.cache where that is not set or empty.
  const auto folder_with = [](const char* chosen, const char* caches, const char* home) {
    const Variable first("MPM_CACHE", chosen), second("XDG_CACHE_HOME", caches), third("HOME", home);
    const device::ProgramCache cache = device::ProgramCache::of_user();
    CHECK(cache.most_bytes() == 268435456);
    return cache.folder().string();
  };
  CHECK(folder_with("/mine", "/caches", "/home/me") == "/mine");
  CHECK(folder_with("", "/caches", "/home/me").empty());
  CHECK(folder_with(nullptr, "/caches", "/home/me") == "/caches/mpm/programs");
  CHECK(folder_with(nullptr, "", "/home/me") == "/home/me/.cache/mpm/programs");
  CHECK(folder_with(nullptr, nullptr, "/home/me") == "/home/me/.cache/mpm/programs");
  CHECK(folder_with(nullptr, nullptr, "").empty());
  CHECK(folder_with(nullptr, nullptr, nullptr).empty());
}
