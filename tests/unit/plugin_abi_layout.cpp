// The layout of the plugin boundary, as the record in fixtures and the page in docs tell it, is that which compilers of
// C and of C++ make of the headers. The fields are read from the headers themselves, so that none is forgotten. A
// change is a new MPM_ABI_VERSION: then MPM_RECORD_ABI=1 writes the record anew, for review.

#include <cstdlib>
#include <fstream>
#include <regex>
#include <sstream>

#include "fixtures/mpm_fixture.hpp"
#include "plugin/abi.h"
#include "support/catch.hpp"

namespace {

struct Struct {
  std::string name;
  std::vector<std::string> fields;
};

/// The text of a header without its comments.
std::string header(const std::string& name) {
  const std::string text = fixture::contents(std::string(MPM_SOURCE_DIR) + "/modules/plugin/" + name);
  return std::regex_replace(text, std::regex(R"(/\*[^*]*\*+([^/*][^*]*\*+)*/)"), "");
}

std::vector<std::smatch> matches(const std::string& text, const std::string& pattern) {
  const std::regex regex(pattern);
  return {std::sregex_iterator(text.begin(), text.end(), regex), std::sregex_iterator()};
}

/// The names declared by one declaration of a struct: f of "void (*f[3])(int)", a and b of "int a, b[2]".
std::vector<std::string> declared(const std::string& declaration) {
  std::smatch pointer;
  if (std::regex_search(declaration, pointer, std::regex(R"(\(\*(\w+))"))) return {pointer[1]};
  std::vector<std::string> names;
  for (const std::smatch& name : matches(declaration, R"((\w+)\s*(\[[^\]]*\])*\s*(,|$))")) names.push_back(name[1]);
  return names;
}

std::vector<Struct> structs(const std::string& text) {
  std::vector<Struct> found;
  for (const std::smatch& one : matches(text, R"(typedef struct (\w+) \{([^}]*)\} \w+;)")) {
    Struct read{one[1], {}};
    const std::string body = one[2];
    for (const std::smatch& declaration : matches(body, R"(([^;]+);)"))
      for (const std::string& field : declared(declaration[1])) read.fields.push_back(field);
    found.push_back(read);
  }
  return found;
}

/// The names of numbers: of enumerations, and of macros that are one.
std::vector<std::string> numbers(const std::string& text) {
  std::vector<std::string> names;
  for (const std::smatch& one : matches(text, R"(#define (MPM_\w+) \d+u)")) names.push_back(one[1]);
  for (const std::smatch& one : matches(text, R"((MPM_\w+) = \d+)")) names.push_back(one[1]);
  return names;
}

/// A program in the common part of C and C++ that prints the layout.
std::string printer() {
  std::ostringstream out;
  out << "#include <stddef.h>\n#include <stdio.h>\n#include \"plugin/extensions.h\"\nint main(void) {\n";
  for (const char* name : {"abi.h", "extensions.h"}) {
    const std::string text = header(name);
    for (const std::string& number : numbers(text))
      out << "  printf(\"" << number << " = %ld\\n\", (long)" << number << ");\n";
    for (const Struct& one : structs(text)) {
      out << "  printf(\"" << one.name << ", %zu bytes\\n\", sizeof(" << one.name << "));\n";
      for (const std::string& field : one.fields)
        out << "  printf(\"  " << field << " at %zu, %zu bytes\\n\", offsetof(" << one.name << ", " << field
            << "), sizeof(((" << one.name << "*)0)->" << field << "));\n";
    }
  }
  out << "  return 0;\n}\n";
  return out.str();
}

std::string layout(const std::string& language) {
  const fixture::TemporaryFolder folder;
  std::ofstream(folder / "print.c") << printer();
  const int status = fixture::compile(
      "-x " + language + " '" + (folder / "print.c").string() + "' -o '" + (folder / "print").string() + "'",
      folder / "log");
  INFO(fixture::contents(folder / "log"));
  REQUIRE(status == 0);
  REQUIRE(std::system(("'" + (folder / "print").string() + "' > '" + (folder / "out").string() + "'").c_str()) == 0);
  return fixture::contents(folder / "out");
}

}  // namespace

TEST_CASE("the boundary is laid out as its record and its page tell, in C and in C++", "[abi]") {
  const std::string compiled = layout("c");
  CHECK(compiled == layout("c++"));
  const std::string record = std::string(MPM_SOURCE_DIR) + "/tests/unit/fixtures/abi_layout.txt";
  if (std::getenv("MPM_RECORD_ABI")) std::ofstream(record) << compiled;
  INFO("A changed boundary is a new MPM_ABI_VERSION: see docs/design/plugin_boundary.md, \"Versions\"");
  CHECK(fixture::contents(record) == compiled);

  const std::string page = fixture::contents(std::string(MPM_SOURCE_DIR) + "/docs/design/plugin_boundary.md");
  CHECK(page.find("# The plugin boundary, version " + std::to_string(MPM_ABI_VERSION) + "\n") != page.npos);
  const auto sizes = matches(compiled, R"((mpm_\w+), (\d+) bytes\n)");
  CHECK(sizes.size() >= 31);
  for (const std::smatch& size : sizes) {
    INFO("| `" << size[1] << "` | " << size[2] << " |");
    CHECK(page.find("| `" + size[1].str() + "` | " + size[2].str() + " |") != page.npos);
  }
}
