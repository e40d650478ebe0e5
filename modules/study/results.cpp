#include "study/results.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "experiment/diagnostics.hpp"
#include "support/csv.hpp"
#include "support/numbers.hpp"

namespace mpm::study {
namespace {

constexpr const char* format_name = "mpm study";
constexpr int format_version = 1;
constexpr const char* status_names[] = {"not run", "done",    "expectation failed", "failed",
                                        "refused", "crashed", "machine failed",     "interrupted"};

Json number_or_null(const std::optional<double>& value) {
  return value ? Json(*value) : Json(nullptr);
}

std::optional<double> number_in(const Json& json, const char* key) {
  return json.contains(key) && json[key].is_number() ? std::optional<double>(json[key].get<double>()) : std::nullopt;
}

Json json_of_axis(const Axis& axis) {
  Json json{{"name", axis.name}, {"label", axis.label}, {"unit", axis.unit}, {"values", Json::array()}};
  for (const Choice& choice : axis.choices)
    json["values"].push_back(
        {{"label", choice.label}, {"number", number_or_null(choice.number)}, {"set", choice.overrides}});
  return json;
}

Json json_of_result(const Study& study, const Result& result) {
  Json json{{"name", result.combination.name}};
  for (std::size_t k = 0; k < study.axes.size(); ++k)
    json["axes"][study.axes[k].name] = study.axes[k].choices[result.combination.choices[k]].label;
  json["choices"] = result.combination.choices;
  json["status"] = name_of(result.outcome.status);
  json["reason"] = result.outcome.reason;
  if (!result.outcome.cause.empty()) json["cause"] = result.outcome.cause;
  json["flags"] = result.flags;
  json["reused"] = result.outcome.reused;
  json["folder"] = result.folder;
  json["measures"] = Json::object();
  for (const auto& [name, value] : result.measures) json["measures"][name] = value;
  if (!study.bisection) return json;
  json["bisection"] = {{"stable", number_or_null(result.stable)}, {"unstable", number_or_null(result.unstable)}};
  json["bisection"]["runs"] = Json::array();
  for (const Probe& probe : result.probes)
    json["bisection"]["runs"].push_back(
        {{"value", probe.value}, {"stable", probe.is_stable}, {"folder", probe.folder}, {"reason", probe.reason}});
  return json;
}

Result result_from(const Json& json) {
  Result result;
  result.combination.name = json.at("name").get<std::string>();
  result.combination.choices = json.at("choices").get<std::vector<std::size_t>>();
  result.outcome = {status_named(json.at("status")), json.at("reason"), json.at("reused"), json.value("cause", "")};
  result.flags = json.at("flags").get<std::vector<std::string>>();
  result.folder = json.at("folder").get<std::string>();
  for (const auto& [name, value] : json.at("measures").items()) result.measures[name] = value.get<double>();
  if (!json.contains("bisection")) return result;
  result.stable = number_in(json["bisection"], "stable");
  result.unstable = number_in(json["bisection"], "unstable");
  return result;
}

Axis axis_from(const Json& json) {
  Axis axis{json.at("name"), json.at("label"), json.at("unit"), {}, {}};
  for (const Json& value : json.at("values"))
    axis.choices.push_back({value.at("label"), number_in(value, "number"), value.at("set")});
  return axis;
}

std::string number_or_nothing(double value) {
  return std::isfinite(value) ? support::shortest(value) : "";
}

std::string joined(const std::vector<std::string>& texts, const char* between) {
  std::string all;
  for (const std::string& text : texts) all += (all.empty() ? "" : between) + text;
  return all;
}

}  // namespace

const char* name_of(Status status) {
  return status_names[static_cast<std::size_t>(status)];
}

Status status_named(const std::string& name) {
  for (std::size_t k = 0; k < std::size(status_names); ++k)
    if (name == status_names[k]) return static_cast<Status>(k);
  throw std::runtime_error("no status is called " + in_quotes(name));
}

bool is_finished(Status status) {
  return status == Status::done || status == Status::expectation_failed;
}

double Result::value(const std::string& measure) const {
  const auto found = measures.find(measure);
  return found == measures.end() ? not_measured : found->second;
}

std::string label_of(const Study& study, const Combination& combination, const std::vector<std::string>& without) {
  std::vector<std::string> labels;
  for (std::size_t k = 0; k < study.axes.size(); ++k)
    if (std::find(without.begin(), without.end(), study.axes[k].name) == without.end())
      labels.push_back(study.axes[k].choices[combination.choices[k]].label);
  return joined(labels, ", ");
}

std::string counted(const std::vector<Result>& results) {
  std::vector<std::string> parts;
  for (std::size_t k = 0; k < std::size(status_names); ++k) {
    const auto count = std::count_if(results.begin(), results.end(), [&](const Result& result) {
      return result.outcome.status == static_cast<Status>(k);
    });
    if (count > 0) parts.push_back(std::to_string(count) + " " + status_names[k]);
  }
  return joined(parts, ", ");
}

std::vector<std::string> objections(const Results& results) {
  std::vector<std::string> sentences;
  for (const Result& result : results.results) {
    const Status status = result.outcome.status;
    for (const std::string& flag : result.flags) sentences.push_back(result.combination.name + ": " + flag);
    if (status == Status::expectation_failed || status == Status::crashed)
      sentences.push_back(result.combination.name + ": " + name_of(status) + ": " + result.outcome.reason);
  }
  return sentences;
}

Json json_of(const Results& results, const Json& machine, const std::string& version) {
  const Study& study = results.study;
  Json json{{"format", format_name},
            {"format_version", format_version},
            {"title", study.title},
            {"description", study.description},
            {"note", study.note},
            {"study_file", study.file.filename().string()},
            {"base", study.base.filename().string()},
            {"command", results.command},
            {"version", version},
            {"machine", machine},
            {"status", results.interrupted ? "interrupted" : "complete"},
            {"counts", counted(results.results)},
            {"set", study.overrides}};
  json["axes"] = Json::array();
  for (const Axis& axis : study.axes) json["axes"].push_back(json_of_axis(axis));
  if (study.bisection) {
    const Bisection& b = *study.bisection;
    json["bisect"] = {{"pointer", b.pointer}, {"label", b.label},  {"unit", b.unit},
                      {"from", b.from},       {"to", b.to},        {"relative_tolerance", b.relative_tolerance},
                      {"scale", b.scale},     {"set", b.overrides}};
  }
  json["measures"] = Json::array();
  for (const Measure& m : study.measures)
    json["measures"].push_back(
        {{"name", m.name}, {"value", m.path}, {"label", m.label}, {"unit", m.unit}, {"formula", m.formula}});
  json["error"] = study.error;
  json["cost"] = study.cost;
  json["objections"] = objections(results);
  json["runs"] = Json::array();
  for (const Result& result : results.results) json["runs"].push_back(json_of_result(study, result));
  return json;
}

bool is_study_json(const Json& json) {
  return json.is_object() && json.contains("format") && json["format"] == format_name;
}

Results results_from(const Json& json) {
  if (!is_study_json(json) || json.value("format_version", 0) != format_version)
    throw std::runtime_error("is no study.json of this version of the program");
  Results results;
  try {
    results.study.title = json.at("title").get<std::string>();
    results.study.note = json.value("note", "");  // studies of before there were notes have none
    results.study.error = json.at("error").get<std::string>();
    results.study.cost = json.at("cost").get<std::string>();
    results.interrupted = json.at("status") != "complete";
    results.command = json.at("command").get<std::string>();
    for (const Json& axis : json.at("axes")) results.study.axes.push_back(axis_from(axis));
    for (const Json& m : json.at("measures"))
      results.study.measures.push_back({m.at("name"), m.at("value"), m.at("label"), m.at("unit"), m.at("formula")});
    for (const Json& run : json.at("runs")) results.results.push_back(result_from(run));
  } catch (const Json::exception& error) {
    throw std::runtime_error(std::string("is damaged: ") + error.what());
  }
  for (const Result& result : results.results) {
    bool fits = result.combination.choices.size() == results.study.axes.size();
    for (std::size_t k = 0; fits && k < result.combination.choices.size(); ++k)
      fits = result.combination.choices[k] < results.study.axes[k].choices.size();
    if (!fits) throw std::runtime_error("is damaged: " + in_quotes(result.combination.name) + " does not fit the axes");
  }
  return results;
}

std::string table_csv(const Results& results) {
  const Study& study = results.study;
  std::vector<std::string> line{"run"};
  for (const Axis& axis : study.axes) line.push_back(axis.title());
  for (const char* word : {"status", "reason", "flags"}) line.emplace_back(word);
  for (const Measure& measure : study.measures) line.push_back(measure.title());
  if (study.bisection) line.push_back("first unstable " + study.bisection->title());
  support::CsvText table;
  table.row(line);
  for (const Result& result : results.results) {
    line = {result.combination.name};
    for (std::size_t k = 0; k < study.axes.size(); ++k)
      line.push_back(study.axes[k].choices[result.combination.choices[k]].label);
    line.emplace_back(name_of(result.outcome.status));
    line.push_back(result.outcome.reason);
    line.push_back(joined(result.flags, "; "));
    for (const Measure& measure : study.measures) line.push_back(number_or_nothing(result.value(measure.name)));
    if (study.bisection) line.push_back(number_or_nothing(result.unstable.value_or(not_measured)));
    table.row(line);
  }
  return table.text();
}

}  // namespace mpm::study
