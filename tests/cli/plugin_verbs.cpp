// `mpm new` refuses what it cannot write; `mpm test-plugin` names what a broken plugin did, with its exit code.

#include "cli/program.hpp"
#include "unit/fixtures/mpm_fixture.hpp"

using namespace mpm::test;

namespace {

/// Compiles tests/unit/fixtures/whole.c, spoiled by a macro, to plugin.so in a folder.
fs::path broken(const Folder& folder, const std::string& define) {
  const fs::path file = folder / "plugin.so";
  fixture::build_plugin(file, define.empty() ? "" : "'" + define + "'");
  fs::remove(file.string() + ".log");
  return file;
}

Result tested(const std::string& define, Words more = {}) {
  const Folder folder;
  broken(folder, define);
  Words words{"test-plugin", "plugin.so", "--no-device"};  // the text that the fixture carries is no functor
  words.insert(words.end(), more.begin(), more.end());
  return call(folder, words);
}

/// Restricts a statement to 3-D, so that it is the fifth group of checks that does not return.
std::string in_space(const std::string& statement) {
  return "-DFIXTURE_EVALUATES=if (q->dimension == 3) " + statement;
}

}  // namespace

TEST_CASE("new: what cannot be written is refused, and nothing is written") {
  const Folder folder;
  fs::create_directory(folder / "full");
  spill(folder / "full/notes.txt", "mine");
  spill(folder / "file", "mine");
  const auto refused = [&](const Words& words, const std::string& message) {
    const auto before = folder.names();
    const Result result = call(folder, words);
    INFO(result.err);
    INFO("expected: " << message);
    CHECK(result.code == 2);
    CHECK(has(result.err, message));
    CHECK(has(result.err, "nothing was written"));
    CHECK(result.out.empty());
    CHECK(folder.names() == before);
  };
  refused({"new", "matrial", "a", "out"}, "no kind of plugin is called \"matrial\"; did you mean \"material\"?");
  refused({"new", "solver", "a", "out"},
          "kinds are \"shape\", \"transfer\", \"filter\", \"contact\", \"normal\", \"detection\", \"material\"");
  for (const char* id : {"MyRubber", "my-rubber", "2nd", "_a", "", "a b", "a/b", "r\xc3\xa9sine"})
    refused({"new", "material", id, "out"}, " cannot be used: it starts with a lower-case letter");
  refused({"new", "material", std::string(65, 'a'), "out"}, "at most 64 characters");
  refused({"new", "material", "lanes", "out"}, "its class Lanes is one of the kernel headers");
  refused({"new", "material", "neo_hookean", "out"}, "there is a material \"neo_hookean\" already (");
  refused({"new", "material", "a", "full"}, "full is there already and not empty; name another folder");
  refused({"new", "material", "a", "file"}, "file is there already and is no folder");
  CHECK(slurp(folder / "full/notes.txt") == "mine");

  const Result short_of_words = call(folder, {"new", "material", "a"});
  CHECK(short_of_words.code == 2);
  CHECK(has(short_of_words.err, "DIR"));
}

TEST_CASE("new: a folder that cannot be made is the machine's fault") {
  const Folder folder;
  spill(folder / "file", "mine");
  const Result result = call(folder, {"new", "material", "a", "file/below"});
  INFO(result.err);
  CHECK(result.code == 5);
  CHECK(has(result.err, "cannot make the folder file/below"));
}

TEST_CASE("new: no class of the kernel headers can be an id") {
  // Each `struct Name` or `enum class Name` that begins a line of kernel/ is given as the id that would make it.
  const Folder folder;
  int found = 0;
  for (const auto& header : fs::directory_iterator(MPM_SOURCE_DIR "/modules/kernel")) {
    std::istringstream lines(slurp(header.path()));
    for (std::string line; std::getline(lines, line);) {
      std::istringstream words(line);
      std::string word, before;
      if (line.rfind("struct ", 0) == 0) words >> before >> word;  // a class within another is none of the headers'
      if (line.rfind("enum class ", 0) == 0) words >> before >> before >> word;
      if (word.empty() || !std::isupper(static_cast<unsigned char>(word[0]))) continue;
      std::string id;
      for (const char c :
           word.substr(0, word.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789"))) {
        if (std::isupper(static_cast<unsigned char>(c)) && !id.empty()) id += '_';
        id += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
      }
      INFO(word << " of " << header.path());
      CHECK(has(call(folder, {"new", "shape", id, "out"}).err, "is one of the kernel headers"));
      ++found;
    }
  }
  CHECK(found >= 8);
  CHECK(folder.names().empty());
}

TEST_CASE("test-plugin: a plugin that conforms") {
  const Result result = tested("");
  INFO(result.err);
  CHECK(result.code == 0);
  CHECK(has(result.out, "shape fixture: "));
  CHECK(has(result.out, " checks passed\n"));
  CHECK(std::count(result.out.begin(), result.out.end(), '\n') == 1);
  CHECK(result.err.empty());
  const Result verbose = tested("", {"--verbose"});
  CHECK(has(verbose.out, "passed partition_of_unity [scalar double, 3-D]: measured "));
}

TEST_CASE("test-plugin: wrong answers are the checks that fail, with what was measured") {
  const std::string wrong =
      "-DFIXTURE_EVALUATES=for (uint32_t i = 0; i < q->count; ++i) ((double*)q->position)[i] += 1e-3";
  const Result result = tested(wrong);
  INFO(result.out);
  CHECK(result.code == 3);
  CHECK(has(result.out, "FAILED inputs_untouched [scalar double, 2-D]: measured 1, bound 0 ("));
  CHECK(has(result.out, " checks FAILED\n"));
  CHECK(!has(result.out, "passed"));

  const Result as_json = tested(wrong, {"--json"});
  CHECK(as_json.code == 3);
  const Json json = Json::parse(as_json.out);
  CHECK(json["outcome"] == "failed");
  REQUIRE(json["plugins"].size() == 1);
  CHECK(json["plugins"][0]["kind"] == "shape");
  CHECK(json["plugins"][0]["id"] == "fixture");
  CHECK(json["plugins"][0]["failed"].get<int>() > 0);
  CHECK(json["plugins"][0]["checks"] == json["plugins"][0]["findings"].size());
}

TEST_CASE("test-plugin: a crash is named with its signal and the check that ran") {
  const Result result = tested(in_space("abort()"));
  INFO(result.out);
  CHECK(result.code == 3);
  CHECK(has(result.out, "CRASHED in shape fixture: sums and stencil [lanes double, 3-D]; unused=1\n"));
  CHECK(has(result.out, "it crashed with SIGABRT (Aborted)"));
  const Result null = tested(in_space("*(volatile int*)0 = 1"));
  CHECK(null.code == 3);
  CHECK(has(null.out, "it crashed with SIGSEGV (Segmentation fault)"));
  const Json json = Json::parse(tested(in_space("abort()"), {"--json"}).out);
  CHECK(json["outcome"] == "crashed");
  CHECK(json["signal"] == SIGABRT);
  CHECK(json["running"] == "shape fixture: sums and stencil [lanes double, 3-D]; unused=1");
}

TEST_CASE("test-plugin: a plugin that ends the process itself has not passed") {
  const Result result = tested(in_space("exit(0)"));
  INFO(result.out);
  CHECK(result.code == 3);
  CHECK(has(result.out, "it ended the process with exit code 0"));
}

TEST_CASE("test-plugin: an endless loop is stopped and named with the check that ran") {
  const Result result = tested(in_space("for (volatile int i = 0;; ++i) {}"), {"--seconds", "3"});
  INFO(result.out);
  CHECK(result.code == 3);
  CHECK(has(result.out, "HUNG in shape fixture: sums and stencil [lanes double, 3-D]; unused=1\n"));
  CHECK(has(result.out, "it did not end within 3 s and was stopped"));
  CHECK(result.seconds >= 3);
}

TEST_CASE("test-plugin: a crash while the file is loaded") {
  const Result result = tested("-DFIXTURE_LOADS=abort()");
  INFO(result.out);
  CHECK(result.code == 3);
  CHECK(has(result.out, "CRASHED in loading the file\n"));
}

TEST_CASE("test-plugin: what is no plugin, and wrong usage") {
  const Folder folder;
  const auto refused = [&](const Words& words, const std::string& message) {
    const Result result = call(folder, words);
    INFO(result.err);
    INFO("expected: " << message);
    CHECK(result.code == 2);
    CHECK(has(result.err, message));
    CHECK(result.out.empty());
  };
  refused({"test-plugin", "missing.so"}, "missing.so: there is no such file");
  spill(folder / "text.so", std::string(200, 'a'));
  refused({"test-plugin", "text.so"}, "plugin text.so: is not a shared object");
  refused({"test-plugin", "."}, "is not a shared object");
  broken(folder, "-DFIXTURE_ABI=9");
  refused({"test-plugin", "plugin.so"}, "plugin plugin.so: was built for plugin ABI version 9, this program has");
  refused({"test-plugin"}, "FILE");
  refused({"test-plugin", "plugin.so", "--seconds", "0"}, "--seconds");
  refused({"test-plugin", "plugin.so", "--second", "5"},
          "mpm test-plugin takes no \"--second\"; did you mean \"--seconds\"?");
  const Result as_json = call(folder, {"test-plugin", "plugin.so", "--json"});
  CHECK(as_json.code == 2);
  CHECK(Json::parse(as_json.out)["outcome"] == "refused");
}

// Forces over the masses of nodes that particles barely reach are unbounded with this shape, and rounding grows with them: in
// space by more than the usual bound of 1e4 epsilons.
TEST_CASE("test-plugin: the linear shape passes, as the device may differ by what rounding grows to") {
  const Folder folder;
  const Result result = call(folder, {"test-plugin", MPM_BUILD_DIR "/plugins/shape_linear.so", "--json"});
  INFO(result.err);
  CHECK(result.code == 0);
  CHECK(has(result.out, "device [host, double, 3-D]"));
}
