#pragma once
// A build tree need not hold everything that it can build: the launcher ./mpm builds what an experiment asks for, when it
// does. An installed tree holds everything.

#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "plugin/abi.h"

namespace mpm {

/// Folders of a name that may hold a part of this program, nearest first: beside the program, in its build tree, in an
/// installed tree (lib/mpm). They need not exist.
std::vector<std::filesystem::path> folders_beside_program(std::string_view name);

/// A target of the build tree that makes a plugin.
struct PluginTarget {
  mpm_kind kind;
  std::string id;

  std::string name() const;
};

/// The plugins that this program's build tree can build and does not hold; none in an installed tree. They stand in the file
/// `on_demand` of the build folder, a line each: its target and its file.
std::vector<PluginTarget> plugins_not_built();

/// A part of the program that is not there and cannot be built now.
class NotBuilt : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Has the launcher that started this program (MPM_LAUNCHER) build targets, which takes seconds to a minute each; the compiler's
/// progress goes to standard error. Throws NotBuilt, with the remedy, where no launcher started it or the build fails.
void build_missing(const std::vector<std::string>& targets);

}  // namespace mpm
