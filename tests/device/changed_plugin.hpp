#pragma once
// A plugin of the build whose text, which a device compiles, differs from its file's in chosen places.

#include <string>

#include "device/device_support.hpp"

namespace mpm::test {

class ChangedPlugin {
 public:
  ChangedPlugin(mpm_kind kind, const std::string& id)
      : plugin_(*plugins().find(kind, id)), descriptor_(*plugin_.descriptor), text_(descriptor_.source) {
    plugin_.descriptor = &descriptor_;
  }
  ChangedPlugin(const ChangedPlugin&) = delete;
  ChangedPlugin& operator=(const ChangedPlugin&) = delete;

  /// Puts other words in the place of the first such ones. The test ends where there are none.
  void replace(const std::string& from, const std::string& to) {
    const std::size_t at = text_.find(from);
    REQUIRE(at != std::string::npos);
    text_.replace(at, from.size(), to);
    descriptor_.source = text_.c_str();
  }
  /// Takes another table, which hosts call, in the place of its file's.
  void set_table(const void* table) { descriptor_.kind_table = table; }
  const Plugin& plugin() const { return plugin_; }

 private:
  Plugin plugin_;
  mpm_descriptor descriptor_;
  std::string text_;
};

}  // namespace mpm::test
