// `mpm film`: a film of a run that was recorded without one, or of another format.

#include "output/film.hpp"

#include <filesystem>
#include <iostream>
#include <string>

#include "experiment/diagnostics.hpp"
#include "mpm/cli.hpp"
#include "output/run_folder.hpp"
#include "support/natural_order.hpp"

namespace mpm::app {

int film(const std::filesystem::path& run, const std::string& format) {
  const output::RunFolder folder = output::RunFolder::open(run);
  const output::FolderLock lock(folder.root());
  const std::filesystem::path frames = folder.root() / "frames";
  if (support::files_with_ending(frames, {".png"}).size() < 2)
    refuse_input(run.string(),
                 "holds fewer than two frames: set \"frames\" of \"output\" in its experiment, and run it again");
  const auto made = output::write_film(frames, folder.root() / ("film." + format), output::frames_per_second);
  if (!made) {
    std::cerr << output::no_ffmpeg << "\n";
    return machine_failed;
  }
  std::cout << "film: " << made->lexically_relative(std::filesystem::current_path()).string() << "\n";
  return done;
}

}  // namespace mpm::app
