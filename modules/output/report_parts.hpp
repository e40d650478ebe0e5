// The sections of report.html, in their order of appearance. Each returns "" when there is nothing to show.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "output/html.hpp"

namespace mpm::output::report {

/// What a run folder holds, read once. A missing file is an empty object.
struct Run {
  std::filesystem::path folder;
  Json experiment, manifest, summary, plan;
  std::vector<std::string> unreadable;  ///< names of files that exist but are cut or malformed
};

Run read_run(const std::filesystem::path& folder);

/// The member at a path of keys, or nullptr; never throws whatever the types on the way are.
const Json* member(const Json& value, std::initializer_list<const char*> keys);

/// A heading and its body, or "" for an empty body.
std::string section(const char* title, const std::string& body);

/// The style sheet, inside <style>.
const char* style();

std::string title_text(const Run& run);
std::string heading(const Run& run);
std::string outcome(const Run& run);
std::string headline_numbers(const Run& run);
std::string expectations(const Run& run);
std::string figures(const Run& run);
std::string frames(const Run& run);
std::string measurements(const Run& run);
std::string methods(const Run& run);
std::string plan(const Run& run);
std::string reproduction(const Run& run);
std::string files(const Run& run);

}  // namespace mpm::output::report
