// Whole-or-absent files, hashes and CSV tables, also where the machine refuses.
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <cmath>
#include <csignal>
#include <cstring>
#include <fstream>
#include <limits>

#include "support/base64.hpp"
#include "support/catch.hpp"
#include "support/csv.hpp"
#include "support/files.hpp"
#include "support/hash.hpp"
#include "support/natural_order.hpp"
#include "unit/output_support.hpp"

namespace fs = std::filesystem;
using namespace mpm::support;
using namespace mpm::output::testing;

namespace {

/// Keeps every file below `bytes` while it lives: the disk that is full, without filling one.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) : old_handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &old_);
    rlimit limit = old_;
    limit.rlim_cur = bytes;
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;
  ~FileSizeLimit() {
    ::setrlimit(RLIMIT_FSIZE, &old_);
    std::signal(SIGXFSZ, old_handler_);
  }

 private:
  rlimit old_{};
  void (*old_handler_)(int);
};

bool same_bits(double a, double b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

void write_plain(const fs::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

}  // namespace

TEST_CASE("an atomic write replaces the file and leaves nothing else", "[support][atomic]") {
  const TemporaryFolder scratch;
  const fs::path path = scratch / "result.json";
  write_atomically(path, "old");
  write_atomically(path, std::string("new\0bytes", 9));
  CHECK(read_file(path) == std::string("new\0bytes", 9));
  CHECK(entries_in(scratch.path()) == 1);
}

TEST_CASE("a full disk keeps the old file, removes the temporary one and says what to do", "[support][atomic]") {
  const TemporaryFolder scratch;
  const fs::path path = scratch / "result.json";
  write_atomically(path, "old");
  std::string message;
  {
    const FileSizeLimit limit(1000);
    message = message_of<MachineError>([&] { write_atomically(path, std::string(5000, 'x')); });
  }
  CHECK(contains(message, path.string()));
  CHECK(contains(message, "too large"));
  CHECK(contains(message, "; "));
  CHECK(read_file(path) == "old");
  CHECK(entries_in(scratch.path()) == 1);
}

TEST_CASE("a file that need not be on the disk is as whole or absent, and keeps the mode the user asked for",
          "[support][atomic]") {
  const TemporaryFolder scratch;
  const fs::path path = scratch / "figure.svg";
  const mode_t old_mask = ::umask(027);
  write_atomically(path, "first, and long", Durability::of_program);
  ::umask(old_mask);
  CHECK(fs::status(path).permissions() == fs::perms(0640));
  write_atomically(path, "second", Durability::of_program);
  CHECK(read_file(path) == "second");
  {
    const FileSizeLimit limit(1000);
    CHECK_THROWS_AS(write_atomically(path, std::string(5000, 'x'), Durability::of_program), MachineError);
  }
  CHECK(read_file(path) == "second");
  CHECK(entries_in(scratch.path()) == 1);
}

TEST_CASE("a stem may hold a dot", "[support]") {
  CHECK(with_suffix("run_0.5", ".png") == fs::path("run_0.5.png"));
}

TEST_CASE("a path through a file, a missing folder and a folder as target are refused by name", "[support][atomic]") {
  const TemporaryFolder scratch;
  write_atomically(scratch / "file", "text");
  fs::create_directory(scratch / "folder");
  CHECK(contains(message_of<MachineError>([&] { write_atomically(scratch / "file" / "below", "x"); }), "is a file"));
  CHECK(
      contains(message_of<MachineError>([&] { write_atomically(scratch / "missing" / "x", "x"); }), "does not exist"));
  CHECK(
      contains(message_of<MachineError>([&] { write_atomically(scratch / "folder", "x"); }), "a folder has this name"));
  CHECK(read_file(scratch / "file") == "text");
  CHECK(entries_in(scratch.path()) == 2);
}

TEST_CASE("the hash of a file is the published SHA-256", "[support][hash]") {
  const TemporaryFolder scratch;
  write_atomically(scratch / "abc", "abc");
  write_atomically(scratch / "empty", "");
  CHECK(sha256_of_file(scratch / "abc") == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  CHECK(sha256_of_file(scratch / "empty") == "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  CHECK(sha256("abc") == sha256_of_file(scratch / "abc"));
  CHECK_THROWS_AS(sha256_of_file(scratch / "absent"), MachineError);
}

TEST_CASE("a CSV table reads back bit for bit", "[support][csv]") {
  using limits = std::numeric_limits<double>;
  const std::vector<double> hard = {0.0,
                                    -0.0,
                                    0.1,
                                    1.0 / 3.0,
                                    limits::denorm_min(),
                                    -4.9406564584124654e-322,
                                    limits::max(),
                                    limits::lowest(),
                                    limits::min(),
                                    limits::infinity(),
                                    -limits::infinity(),
                                    1e22,
                                    123456789012345678.0,
                                    limits::epsilon()};
  const TemporaryFolder scratch;
  {
    CsvAppender csv(scratch / "metrics.csv", {"time (s)", "kinetic energy (J)"});
    for (const double value : hard) csv.row(std::vector<double>{value, -value});
    csv.row(std::vector<double>{limits::quiet_NaN(), 1.0});
  }
  const Table table = read_csv(scratch / "metrics.csv");
  REQUIRE(table.rows() == hard.size() + 1);
  for (std::size_t i = 0; i < hard.size(); ++i) {
    CHECK(same_bits(table.columns[0][i], hard[i]));
    CHECK(same_bits(table.columns[1][i], -hard[i]));
  }
  CHECK(std::isnan(table.columns[0].back()));
  write_csv(scratch / "copy.csv", table);
  CHECK(read_file(scratch / "copy.csv") == read_file(scratch / "metrics.csv"));
}

TEST_CASE("tables of words quote what must be quoted, and a row stays one line", "[support][csv]") {
  CsvText table;
  table.row({"plain", "with, comma", "say \"so\"", "two\nlines", ""});
  CHECK(table.text() == "plain,\"with, comma\",\"say \"\"so\"\"\",\"two lines\",\n");
}

TEST_CASE("a column is found with or without its unit, and by quoted names", "[support][csv]") {
  const TemporaryFolder scratch;
  CsvAppender(scratch / "t.csv", {"time (s)", "angle, \"tilt\" (rad)", "f(x)"}).row(std::vector<double>{1, 2, 3});
  const Table table = read_csv(scratch / "t.csv");
  REQUIRE(table.find("time") != nullptr);
  CHECK(table.find("time") == table.find("time (s)"));
  REQUIRE(table.find("angle, \"tilt\"") != nullptr);
  CHECK(table.find("angle, \"tilt\"")->front() == 2);
  CHECK(table.find("f(x)")->front() == 3);
  CHECK(table.find("mass") == nullptr);
}

TEST_CASE("a cut last line is left out, a malformed row is named by its line", "[support][csv]") {
  const TemporaryFolder scratch;
  write_plain(scratch / "cut.csv", "a,b\n1,2\n3,4.5");
  const Table table = read_csv(scratch / "cut.csv");
  CHECK(table.rows() == 1);
  CHECK(table.last_line_was_cut);
  write_plain(scratch / "windows.csv",
              "\xEF\xBB\xBF"
              "a , b\r\n 1 ,+2\r\n\r\n3,\r\n");
  const Table windows = read_csv(scratch / "windows.csv");
  REQUIRE(windows.rows() == 2);
  CHECK(windows.header == std::vector<std::string>{"a", "b"});
  CHECK(windows.columns[1][0] == 2);
  CHECK(std::isnan(windows.columns[1][1]));
  write_plain(scratch / "bad.csv", "a,b\n1,2\n3,four\n");
  CHECK(contains(message_of<std::runtime_error>([&] { read_csv(scratch / "bad.csv"); }), "bad.csv:3: 'four'"));
  write_plain(scratch / "short.csv", "a,b\n1\n");
  CHECK(contains(message_of<std::runtime_error>([&] { read_csv(scratch / "short.csv"); }), "short.csv:2:"));
  write_plain(scratch / "none.csv", "");
  CHECK(read_csv(scratch / "none.csv").rows() == 0);
}

TEST_CASE("a table with words reads back as its cells", "[support][csv]") {
  const TemporaryFolder scratch;
  CsvText table;
  const std::vector<std::vector<std::string>> rows{{"series", "y (m, s)"}, {"say \"so\"", "0.5"}, {"", "-1"}};
  for (const auto& row : rows) table.row(row);
  write_plain(scratch / "words.csv", table.text() + "cut,0.2");
  CHECK(read_csv_cells(scratch / "words.csv") == rows);
}

TEST_CASE("a full disk takes the row back whole, and writing can go on later", "[support][csv]") {
  const TemporaryFolder scratch;
  CsvAppender csv(scratch / "m.csv", {"a", "b"});
  csv.row(std::vector<double>{1.5, 2.5});
  const std::string before = read_file(scratch / "m.csv");
  std::string message;
  {
    const FileSizeLimit limit(before.size() + 3);  // room for a part of the row only
    message = message_of<MachineError>([&] { csv.row(std::vector<double>{3.25, 4.25}); });
  }
  CHECK(contains(message, "m.csv"));
  CHECK(read_file(scratch / "m.csv") == before);
  csv.row(std::vector<double>{3.25, 4.25});
  CHECK(read_file(scratch / "m.csv") == before + "3.25,4.25\n");
}

TEST_CASE("a process killed while it writes leaves whole rows", "[support][csv]") {
  const TemporaryFolder scratch;
  const fs::path path = scratch / "m.csv";
  const pid_t child = ::fork();
  if (child == 0) {
    ::alarm(60);  // ends the child, should the test itself die first
    CsvAppender csv(path, {"a", "b"});
    for (double i = 0;; ++i) csv.row(std::vector<double>{i, i / 3.0});
  }
  REQUIRE(child > 0);
  // On a busy machine the child may begin late: it is killed in the midst of rows, however long the first ones take.
  std::error_code not_there;
  for (int wait = 0; wait < 3000 && !(fs::file_size(path, not_there) > 10000 && !not_there); ++wait) ::usleep(10000);
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  const Table table = read_csv(path);
  CHECK_FALSE(table.last_line_was_cut);
  CHECK(table.rows() > 0);
}

TEST_CASE("a resumed run continues its table, other columns are refused", "[support][csv]") {
  const TemporaryFolder scratch;
  const fs::path path = scratch / "m.csv";
  write_plain(path, "time (s),x\n0,1\n0.5,2\n1,3\n1.5");
  CsvAppender(path, {"time (s)", "x"}).row(std::vector<double>{2, 4});
  CHECK(read_file(path) == "time (s),x\n0,1\n0.5,2\n1,3\n2,4\n");
  drop_rows_after(path, 0.5);
  CHECK(read_file(path) == "time (s),x\n0,1\n0.5,2\n");
  CHECK_THROWS_AS(CsvAppender(path, {"time (s)", "y"}), std::invalid_argument);
  CHECK_THROWS_AS(CsvAppender(path, {"time (s)", "x"}).row(std::vector<double>{1}), std::invalid_argument);
  CHECK_NOTHROW(drop_rows_after(scratch / "absent.csv", 1.0));
}

TEST_CASE("files are ordered as people count", "[support]") {
  CHECK(naturally_less("frame_2.png", "frame_10.png"));
  CHECK_FALSE(naturally_less("frame_10.png", "frame_2.png"));
  CHECK(naturally_less("frame_009.png", "frame_10.png"));
  CHECK(naturally_less("a", "ab"));
  CHECK_FALSE(naturally_less("a1", "a1"));
  CHECK(naturally_less("a01", "a1") != naturally_less("a1", "a01"));
}

TEST_CASE("base64 is that of RFC 4648", "[support]") {
  CHECK(base64("") == "");
  CHECK(base64("f") == "Zg==");
  CHECK(base64("foobar") == "Zm9vYmFy");
  const std::string large(4 << 20, 'x');  // longer than one piece
  CHECK(base64(large) == [&] {
    std::string expected;
    for (std::size_t i = 0; i < large.size() / 3; ++i) expected += "eHh4";
    return expected + "eA==";
  }());
}
