#include "output/report.hpp"

#include "output/report_parts.hpp"
#include "support/files.hpp"

namespace mpm::output {
namespace report {
namespace {

/// Cut or malformed files are named on the page instead of costing the page.
Json read_object(Run& run, const char* name) {
  std::error_code ignored;
  const std::filesystem::path path = run.folder / name;
  if (!std::filesystem::is_regular_file(path, ignored)) return Json::object();
  constexpr bool throw_on_error = false, ignore_comments = true;
  Json value = Json::parse(support::read_file(path), nullptr, throw_on_error, ignore_comments);
  if (value.is_object()) return value;
  run.unreadable.emplace_back(name);
  return Json::object();
}

}  // namespace

Run read_run(const std::filesystem::path& folder) {
  Run run;
  run.folder = folder;
  run.experiment = read_object(run, "experiment.json");
  run.manifest = read_object(run, "manifest.json");
  run.summary = read_object(run, "summary.json");
  run.plan = read_object(run, "plan.json");
  return run;
}

const Json* member(const Json& value, std::initializer_list<const char*> keys) {
  const Json* current = &value;
  for (const char* key : keys) {
    if (!current->is_object()) return nullptr;
    const auto found = current->find(key);
    if (found == current->end()) return nullptr;
    current = &*found;
  }
  return current;
}

std::string section(const char* title, const std::string& body) {
  if (body.empty()) return {};
  return std::string("<section>\n<h2>") + title + "</h2>\n" + body + "\n</section>\n";
}

}  // namespace report

void write_report(const std::filesystem::path& run_folder) {
  const report::Run run = report::read_run(run_folder);
  std::string page =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta name=\"color-scheme\" content=\"light dark\">\n<title>";
  page += report::title_text(run) + "</title>\n<style>" + report::style() + "</style>\n</head>\n<body>\n<main>\n";
  for (const auto part :
       {report::heading, report::outcome, report::headline_numbers, report::expectations, report::frames,
        report::figures, report::measurements, report::methods, report::plan, report::reproduction, report::files}) {
    page += part(run);
  }
  page += "</main>\n</body>\n</html>\n";
  support::write_atomically(run_folder / "report.html", page);
}

}  // namespace mpm::output
