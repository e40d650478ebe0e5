#pragma once
// What the conformance suite says of a plugin with a planted mistake.

#include <set>
#include <string>
#include <vector>

#include "conformance/conformance.hpp"
#include "support/catch.hpp"

namespace mpm::test {

inline std::vector<ConformanceFinding> findings(const mpm_descriptor& descriptor) {
  return check_plugin(Plugin{&descriptor, "test"});
}

/// The name of a check, without precision and dimension.
inline std::string name_of(const ConformanceFinding& finding) {
  return finding.check.substr(0, finding.check.find(" ["));
}

/// Names of the failed checks.
inline std::set<std::string> failures(const mpm_descriptor& descriptor) {
  std::set<std::string> names;
  for (const ConformanceFinding& finding : findings(descriptor))
    if (!finding.passed) names.insert(name_of(finding));
  return names;
}

/// One of the failed checks is the one that names the mistake.
inline void check_caught(const mpm_descriptor& descriptor, const std::string& check) {
  const std::set<std::string> failed = failures(descriptor);
  CAPTURE(failed);
  CHECK(failed.count(check) == 1);
}

}  // namespace mpm::test
