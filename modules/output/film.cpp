#include "output/film.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>
#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "support/files.hpp"
#include "support/natural_order.hpp"

extern char** environ;

namespace mpm::output {
namespace {

namespace fs = std::filesystem;

std::optional<fs::path> find_on_path(const std::string& program) {
  const char* folders = std::getenv("PATH");
  std::istringstream list(folders == nullptr ? "" : folders);
  for (std::string folder; std::getline(list, folder, ':');) {
    if (folder.empty()) continue;
    fs::path candidate = fs::path(folder) / program;
    std::error_code ignored;
    if (fs::is_regular_file(candidate, ignored) && ::access(candidate.c_str(), X_OK) == 0) return candidate;
  }
  return std::nullopt;
}

/// A folder under the system's temporary one that goes away with this object.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (fs::temp_directory_path() / "mpm-film-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw support::MachineError::from_errno("create the folder", name, errno);
    path_ = name;
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

/// Numbered links let ffmpeg's plainest input pattern work whatever the frames and their folder are called.
void link_numbered(const std::vector<fs::path>& frames, const fs::path& folder) {
  for (std::size_t i = 0; i < frames.size(); ++i) {
    std::string number = std::to_string(i);
    number.insert(0, 8 - std::min<std::size_t>(8, number.size()), '0');
    fs::create_symlink(fs::absolute(frames[i]), folder / (number + ".png"));
  }
}

/// How ffmpeg is told to write the films of one ending.
struct Format {
  const char* ending;
  const char* encoder;
  const char* filter;
  std::vector<const char*> settings;
};

// Players want even sizes and 4:2:0 colour; a white rim of one pixel does less harm than rescaling.
constexpr const char* even_sizes = "pad=ceil(iw/2)*2:ceil(ih/2)*2:0:0:white";
// A page shows it while it loads and over and over: it is small, and rests for a second on what came of the scene.
constexpr const char* page_size = "scale='min(640,iw)':-1:flags=lanczos,tpad=stop_mode=clone:stop_duration=1";

const std::vector<Format>& formats() {
  static const std::vector<Format> all{
      {".mp4",
       "libx264",
       even_sizes,
       {"-pix_fmt", "yuv420p", "-crf", "18", "-preset", "medium", "-movflags", "+faststart"}},
      {".webm", "libvpx-vp9", even_sizes, {"-pix_fmt", "yuv420p", "-crf", "30", "-b:v", "0"}},
      // Blocks that stay are left transparent. The other encoder, libwebp_anim, lets slow changes pile up in them.
      {".webp", "libwebp", page_size, {"-pix_fmt", "yuva420p", "-quality", "60", "-cr_threshold", "1", "-loop", "0"}},
  };
  return all;
}

/// The endings of all formats, with `last` before the last one.
std::string list_of_endings(const char* last) {
  std::string text;
  for (const Format& format : formats()) {
    const bool is_last = &format == &formats().back();
    text += (text.empty() ? "" : is_last ? last : ", ") + std::string(format.ending);
  }
  return text;
}

/// Throws std::invalid_argument for an ending that no format has.
const Format& format_of(const fs::path& target) {
  for (const Format& format : formats())
    if (target.extension() == format.ending) return format;
  throw std::invalid_argument("a film ends in " + list_of_endings(" or ") + ", not '" + target.filename().string() +
                              "'");
}

std::vector<std::string> arguments_for(const fs::path& ffmpeg, const fs::path& target, int frames_per_second) {
  std::vector<std::string> arguments = {ffmpeg.string()};
  const auto add = [&](const std::vector<const char*>& more) {
    arguments.insert(arguments.end(), more.begin(), more.end());
  };
  const Format& format = format_of(target);
  // A damaged frame must stop it (-xerror): a film that silently skips one would lie.
  add({"-nostdin", "-hide_banner", "-loglevel", "error", "-xerror", "-y", "-framerate"});
  arguments.push_back(std::to_string(frames_per_second));
  add({"-i", "%08d.png"});
  add({"-vf", format.filter, "-c:v", format.encoder});
  add(format.settings);
  arguments.push_back(target.string());
  return arguments;
}

class FileActions {
 public:
  FileActions() { posix_spawn_file_actions_init(&actions_); }
  FileActions(const FileActions&) = delete;
  FileActions& operator=(const FileActions&) = delete;
  ~FileActions() { posix_spawn_file_actions_destroy(&actions_); }
  posix_spawn_file_actions_t* get() { return &actions_; }

 private:
  posix_spawn_file_actions_t actions_;
};

/// Runs a program without a shell in `folder`, both outputs into `log`. Returns its exit status, or 128 + signal if it
/// was killed.
int run_program(const std::vector<std::string>& arguments, const fs::path& folder, const fs::path& log) {
  FileActions actions;
  posix_spawn_file_actions_addchdir_np(actions.get(), folder.c_str());
  posix_spawn_file_actions_addopen(actions.get(), STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(actions.get(), STDOUT_FILENO, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  posix_spawn_file_actions_adddup2(actions.get(), STDOUT_FILENO, STDERR_FILENO);
  std::vector<char*> argv;
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  pid_t child = 0;
  const int error = ::posix_spawn(&child, argv[0], actions.get(), nullptr, argv.data(), environ);
  if (error != 0) throw support::MachineError::from_errno("start", arguments[0], error);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) throw support::MachineError::from_errno("wait for", arguments[0], errno);
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

std::string last_lines(const fs::path& log, int count) {
  std::error_code ignored;
  if (!fs::exists(log, ignored)) return "(it printed nothing)";
  std::string text = support::read_file(log);
  while (!text.empty() && text.back() == '\n') text.pop_back();
  if (text.empty()) return "(it printed nothing)";
  std::size_t start = text.size();
  while (count-- > 0 && start != std::string::npos && start > 0) start = text.rfind('\n', start - 1);
  return start == std::string::npos || start == 0 ? text : text.substr(start + 1);
}

/// What is to be done about what ffmpeg says.
std::string remedy(const std::string& said, const fs::path& target) {
  const std::string formats = list_of_endings(" and ");
  if (said.find("Unknown encoder") != std::string::npos)
    return "the frames are kept; this ffmpeg was built without the encoder " + std::string(format_of(target).encoder) +
           ": take another of " + formats + ", or an ffmpeg that has it";
  return "the frames are kept; if it names a damaged one, replace it, else make room, or try another of " + formats;
}

void make_film(const fs::path& ffmpeg, const std::vector<fs::path>& frames, const fs::path& target, int rate) {
  const TemporaryFolder work;
  link_numbered(frames, work.path());
  fs::path part = target.parent_path() / ".";
  (((part += target.stem()) += ".part") += target.extension());
  const fs::path log = work.path() / "log";
  std::error_code ignored;
  const int status = run_program(arguments_for(ffmpeg, part, rate), work.path(), log);
  if (status != 0 || !fs::exists(part, ignored)) {
    fs::remove(part, ignored);
    const std::string said = last_lines(log, 8);
    throw support::MachineError("cannot write " + target.string() + ": ffmpeg stopped with status " +
                                std::to_string(status) + ":\n" + said + "\n" + remedy(said, target));
  }
  fs::rename(part, target);
}

}  // namespace

std::optional<fs::path> write_film(const fs::path& frames_folder, const fs::path& target, int frames_per_second) {
  format_of(target);
  if (frames_per_second < 1) throw std::invalid_argument("a film needs at least one frame per second");
  const std::optional<fs::path> ffmpeg = find_on_path("ffmpeg");
  const std::vector<fs::path> frames = support::files_with_ending(frames_folder, {".png"});
  if (!ffmpeg || frames.empty()) return std::nullopt;
  try {
    make_film(fs::absolute(*ffmpeg), frames, fs::absolute(target), frames_per_second);
  } catch (const fs::filesystem_error& error) {
    throw support::MachineError::from_errno("write", target, error.code().value());
  }
  return target;
}

}  // namespace mpm::output
