// Text that is not JSON, files that are no files, and text that somebody is still typing.
#include "config/config_support.hpp"
#include "support/catch.hpp"

using namespace mpm;
using namespace mpm::test;

TEST_CASE("syntax errors are located and say what was expected", "[config]") {
  CHECK(errors("{\"a\" 1}") == "FILE:1:6: expected ':' after the key, found '1'");
  CHECK(errors("{\"a\": 1\n \"b\": 2}") == "FILE:2:2: expected ',' or '}', found \"b\"");
  CHECK(errors("{\"a\": 1,}") == "FILE:1:9: a comma before '}' is not allowed; remove it");
  CHECK(errors("[1,, 2]") == "FILE:1:4: expected a value, found ','");
  CHECK(errors("{\"a\": [1}") == "FILE:1:9: expected ',' or ']', found '}'");
  CHECK(errors("{\"a\": 01}") == "FILE:1:8: expected ',' or '}', found '1'");
  CHECK(errors("{\"a\": +3}") == "FILE:1:7: '+3' is not a number that JSON allows (write 0.5, -1, 2e-3)");
  CHECK(errors("{\"a\": 1e999}") == "FILE:1:7: the number '1e999' is too large for double precision");
  CHECK(errors("{\"a\": tru}") == "FILE:1:7: expected a value, found 'tru'");
  CHECK(errors("{\"a\": \"x\n\"}") == "FILE:1:7: a string that starts here is not closed on its line");
  CHECK(errors("{\"a\": \"\\q\"}") == "FILE:1:7: a string here is not closed, or holds an invalid escape or byte");
  CHECK(errors("{\"a\": 'x'}") == "FILE:1:7: strings stand in double quotes, not single ones");
  CHECK(errors("{a: 1}") == "FILE:1:2: expected a key in double quotes or '}', found 'a'");
  CHECK(errors("{\"a\": 1") == "FILE:1:8: expected ',' or '}', the file ends");
  CHECK(errors("{} x") == "FILE:1:4: expected the end of the file after the closing '}', found 'x'");
  CHECK(errors("{ /* x") == "FILE:1:3: a comment that starts here is not closed by */");
  CHECK(errors("{ / x") == "FILE:1:3: expected a comment, // or /* */, after '/'");
  CHECK(errors("{\"a\": 1, \"a\": 2}") == "FILE:1:10: the key \"a\" appears twice in one object");
  CHECK(errors(std::string(100, '[')) == "FILE:1:65: nested more than 64 levels deep");
}

TEST_CASE("columns count characters, and a byte order mark counts as none", "[config]") {
  CHECK(errors("\xEF\xBB\xBF{\"\xC3\xA9\xE2\x82\xAC\": 1, x}") ==
        "FILE:1:11: expected a key in double quotes, found 'x'");
}

TEST_CASE("files that hold no experiment", "[config]") {
  CHECK(errors("") == "FILE: the file is empty; expected an experiment, an object in { }");
  CHECK(errors(" \n\t\n") == "FILE: the file is empty; expected an experiment, an object in { }");
  const TemporaryFolder folder;
  const std::string path = folder.path().string();
  CHECK_THROWS_WITH(read_experiment(folder.path(), components(), options()),
                    path + ": is a directory; expected an experiment file");
  CHECK_THROWS_WITH(read_experiment(folder / "none.json", components(), options()),
                    path + "/none.json: there is no such file");
}

namespace {
/// Whether a text is read or refused with InputError: anything else fails the test (and a crash ends it).
bool is_handled(const std::string& text) {
  try {
    read_experiment_text(text, "FILE", components(), options());
  } catch (const InputError& error) {
    return !error.problems().empty() && *error.what() != '\0';
  }
  return true;
}
}  // namespace

TEST_CASE("every prefix of a good file is an error or a success, never a crash", "[config]") {
  const std::string text = two_discs;
  for (std::size_t length = 0; length <= text.size(); ++length) {
    if (!is_handled(text.substr(0, length))) FAIL("prefix of " << length);
  }
}

TEST_CASE("every deletion and many a substitution of one byte is handled", "[config]") {
  const std::string text = two_discs;
  const std::string substitutes = "\"0-{[,\x80\x01";
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (!is_handled(text.substr(0, i) + text.substr(i + 1))) FAIL("deletion of byte " << i);
    std::string changed = text;
    changed[i] = substitutes[i % substitutes.size()];
    if (!is_handled(changed)) FAIL("substitution of byte " << i);
  }
}

TEST_CASE("any value in the place of any other is handled", "[config]") {
  const Experiment good = read_text(two_discs);
  for (const auto& [pointer, position] : good.positions) {
    if (pointer.empty()) continue;
    for (const char* value : {"null", "true", "-1e300", "1e300", "\"\"", "[]", "{}", "[[]]", "{\"type\": 3}", "0"}) {
      ReadOptions changed = options({pointer + "=" + value});
      try {
        read_experiment_text(two_discs, "FILE", components(), changed);
      } catch (const InputError& error) {
        if (error.problems().empty()) FAIL(pointer << " = " << value);
      }
    }
  }
}
