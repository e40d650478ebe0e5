// Films, with stand-ins for ffmpeg, so that the test needs none.
#include <sys/stat.h>
#include <cstdlib>

#include "output/film.hpp"
#include "support/catch.hpp"
#include "support/files.hpp"
#include "unit/output_support.hpp"

namespace fs = std::filesystem;
using namespace mpm::output;
using namespace mpm::support;
using namespace mpm::output::testing;

namespace {

std::string path_variable() {
  const char* const value = std::getenv("PATH");
  return value ? value : "";
}

/// Sets PATH to the given folder alone while it lives; ffmpeg itself is then found or missing as the test wants.
class OnlyPath {
 public:
  explicit OnlyPath(const fs::path& folder) : old_(path_variable()) { ::setenv("PATH", folder.c_str(), 1); }
  OnlyPath(const OnlyPath&) = delete;
  OnlyPath& operator=(const OnlyPath&) = delete;
  ~OnlyPath() { ::setenv("PATH", old_.c_str(), 1); }

 private:
  std::string old_;
};

void install_stand_in(const TemporaryFolder& scratch, const std::string& script) {
  fs::create_directories(scratch / "bin");
  write_atomically(scratch / "bin/ffmpeg", "#!/bin/sh\n" + script);
  ::chmod((scratch / "bin/ffmpeg").c_str(), 0755);
}

/// Makes eleven frames in a folder whose name would trip a shell or ffmpeg's own patterns.
fs::path make_frames(const TemporaryFolder& scratch) {
  const fs::path folder = scratch / "my %d frames; *";
  fs::create_directory(folder);
  for (int i = 0; i < 11; ++i) write_atomically(folder / ("f_" + std::to_string(i) + ".png"), std::to_string(i) + " ");
  return folder;
}

}  // namespace

TEST_CASE("without ffmpeg or frames there is no film and no error", "[output][film]") {
  const TemporaryFolder scratch;
  const fs::path frames = make_frames(scratch);
  fs::create_directory(scratch / "empty");
  const OnlyPath path(scratch / "empty");
  CHECK_FALSE(write_film(frames, scratch / "film.mp4", 25));
  CHECK(message_of<std::invalid_argument>([&] { write_film(frames, scratch / "film.gif", 25); }) ==
        "a film ends in .mp4, .webm or .webp, not 'film.gif'");
  CHECK_THROWS_AS(write_film(frames, scratch / "film.mp4", 0), std::invalid_argument);
}

TEST_CASE("ffmpeg gets the frames in counting order and its film takes the target's name", "[output][film]") {
  const TemporaryFolder scratch;
  const fs::path frames = make_frames(scratch);
  install_stand_in(scratch,
                   "for last; do :; done\n"
                   "for f in 0*.png; do read -r n < $f || :; printf '%s,' \"$n\"; done > \"$last\"\n");
  const OnlyPath path(scratch / "bin");
  const auto film = write_film(frames, scratch / "a film.mp4", 25);
  REQUIRE(film);
  CHECK(read_file(*film) == "0,1,2,3,4,5,6,7,8,9,10,");
  CHECK(entries_in(scratch.path()) == 3);
}

TEST_CASE("ffmpeg is told the encoder that goes with the ending, and loops an animated picture", "[output][film]") {
  const TemporaryFolder scratch;
  const fs::path frames = make_frames(scratch);
  install_stand_in(scratch, "for last; do :; done\necho \"$@\" > \"$last\"\n");
  const OnlyPath path(scratch / "bin");
  const auto told = [&](const char* name) { return read_file(*write_film(frames, scratch / name, 20)); };
  CHECK(contains(told("film.mp4"), " -c:v libx264 "));
  CHECK(contains(told("film.webm"), " -c:v libvpx-vp9 "));
  const std::string animated = told("film.webp");
  CHECK(contains(animated, " -framerate 20 "));
  CHECK(contains(animated, " -c:v libwebp "));
  CHECK(contains(animated, " -loop 0 "));
  CHECK(contains(animated, "scale='min(640,iw)':"));
}

TEST_CASE("an ffmpeg without the encoder is told by the encoder's name", "[output][film]") {
  const TemporaryFolder scratch;
  const fs::path frames = make_frames(scratch);
  install_stand_in(scratch, "echo \"Unknown encoder 'libwebp'\" >&2\nexit 1\n");
  const OnlyPath path(scratch / "bin");
  const std::string message = message_of<MachineError>([&] { write_film(frames, scratch / "film.webp", 20); });
  CHECK(contains(message, "built without the encoder libwebp: take another of .mp4, .webm and .webp"));
  CHECK_FALSE(contains(message, "damaged"));
}

TEST_CASE("a failure of ffmpeg is told with its last lines, and leaves no half film", "[output][film]") {
  const TemporaryFolder scratch;
  const fs::path frames = make_frames(scratch);
  install_stand_in(scratch,
                   "for last; do :; done\necho half > \"$last\"\necho first\n"
                   "for i in 1 2 3 4 5 6 7; do echo line $i; done\necho Unknown encoder >&2\nexit 3\n");
  const OnlyPath path(scratch / "bin");
  const std::string message = message_of<MachineError>([&] { write_film(frames, scratch / "film.webm", 25); });
  CHECK(contains(message, "status 3"));
  CHECK(contains(message, "Unknown encoder"));
  CHECK(contains(message, "line 1\n"));
  CHECK_FALSE(contains(message, "first"));
  CHECK(entries_in(scratch.path()) == 2);
}
