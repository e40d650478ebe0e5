// The parts of the report that say what was computed, with which methods and plan, and how to do it again.
#include <cctype>

#include "output/report_parts.hpp"
#include "support/film_formats.hpp"
#include "support/natural_order.hpp"

namespace mpm::output::report {
namespace {

std::string text_at(const Json& value, std::initializer_list<const char*> keys) {
  const Json* found = member(value, keys);
  return found != nullptr && found->is_string() ? found->get<std::string>() : std::string();
}

/// The id of a method whether it is written "flip" or {"type": "flip", …}.
std::string type_of(const Json& experiment, const char* key) {
  const std::string direct = text_at(experiment, {key});
  return direct.empty() ? text_at(experiment, {key, "type"}) : direct;
}

/// Ids stay as they are written in files and on the command line.
std::string id_html(const std::string& id) {
  return "<code>" + escape_html(id) + "</code>";
}

std::string joined(const std::vector<std::string>& parts, const char* separator) {
  std::string text;
  for (const std::string& part : parts) text += (text.empty() ? "" : separator) + part;
  return text;
}

std::string opening_sentence(const Json& experiment) {
  const Json* dimension = member(experiment, {"dimension"});
  const std::string precision = text_at(experiment, {"precision"}), backend = type_of(experiment, "backend");
  std::string sentence = "A material point simulation";
  if (dimension != nullptr) sentence = "A " + inline_html({}, *dimension) + "-D material point simulation";
  if (!precision.empty()) sentence += " in " + label_html(precision) + " precision";
  if (!backend.empty()) sentence += " on the " + label_html(backend) + " backend";
  return sentence + ". ";
}

std::string method_sentence(const Json& experiment) {
  static constexpr std::pair<const char*, const char*> kinds[] = {
      {"shape", "shape function"}, {"transfer", "transfer"}, {"filter", "filter"}, {"contact", "contact"}};
  std::vector<std::string> parts;
  for (const auto& [key, word] : kinds) {
    const std::string id = type_of(experiment, key);
    if (!id.empty()) parts.push_back(std::string(word) + " " + id_html(id));
  }
  return parts.empty() ? "" : "Methods: " + joined(parts, ", ") + ". ";
}

std::string material_sentence(const Json& experiment) {
  const Json* materials = member(experiment, {"materials"});
  if (materials == nullptr || !materials->is_object()) return {};
  std::vector<std::string> parts;
  for (const auto& item : materials->items()) {
    const std::string type = type_of(*materials, item.key().c_str());
    parts.push_back(label_html(item.key()) + (type.empty() ? "" : " (" + id_html(type) + ")"));
  }
  return parts.empty() ? "" : "Materials: " + joined(parts, ", ") + ". ";
}

std::string body_sentence(const Json& experiment) {
  const Json* bodies = member(experiment, {"bodies"});
  if (bodies == nullptr || !bodies->is_array() || bodies->empty()) return {};
  std::vector<std::string> names;
  for (const Json& body : *bodies) {
    const std::string name = text_at(body, {"name"});
    if (!name.empty()) names.push_back(label_html(name));
  }
  const std::string count = bodies->size() == 1 ? "One body" : std::to_string(bodies->size()) + " bodies";
  const bool worth_listing = !names.empty() && names.size() <= 8;
  return count + (worth_listing ? ": " + joined(names, ", ") : "") + ". ";
}

std::string length_in_metres(const Json& value) {
  return inline_html({}, value) + (value.is_number() ? " m" : "");
}

std::string grid_sentence(const Json& experiment) {
  const Json* cell = member(experiment, {"grid", "cell_size"});
  const Json* end = member(experiment, {"solver", "end_time"});
  std::string sentence;
  if (cell != nullptr) sentence += "Cells of " + length_in_metres(*cell);
  if (end != nullptr) {
    sentence += sentence.empty() ? "Run" : ", run";
    sentence += " to t = " + inline_html({}, *end) + (end->is_number() ? " s" : "");
  }
  return sentence.empty() ? "" : sentence + ". ";
}

std::string method_html(const Json& plugin) {
  if (!plugin.is_object()) return "<div class=\"method\">" + value_html({}, plugin) + "</div>";
  const std::string kind = text_at(plugin, {"kind"});
  const Json* version = member(plugin, {"version"});
  std::string html = "<div class=\"method\"><h3>" + escape_html(text_at(plugin, {"id"})) + " <span>" + label_html(kind);
  if (version != nullptr) html += ", version " + inline_html({}, *version);
  html += "</span></h3>";
  const std::string summary = text_at(plugin, {"summary"}), citation = text_at(plugin, {"citation"});
  if (!summary.empty()) html += "<p>" + escape_html(summary) + "</p>";
  if (!citation.empty()) html += "<p class=\"soft\">" + escape_html(citation) + "</p>";
  Json rest = plugin;
  for (const char* shown : {"id", "kind", "version", "summary", "citation"}) rest.erase(shown);
  if (!rest.empty()) html += "<details><summary>Identity of the file</summary>" + table_html(rest) + "</details>";
  return html + "</div>\n";
}

bool is_plain(const std::string& word) {
  constexpr std::string_view safe = "-_./=:,+@%^";
  if (word.empty()) return false;
  for (const char c : word) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x80 && !std::isalnum(byte) && safe.find(c) == std::string_view::npos) return false;
  }
  return true;
}

std::string shell_quoted(const std::string& word) {
  if (is_plain(word)) return word;
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

/// The command as a line that can be pasted, whether it was recorded as one string or as a list of words.
std::string command_line(const Json& command) {
  if (command.is_string()) return command.get<std::string>();
  if (!command.is_array()) return {};
  std::vector<std::string> words;
  for (const Json& word : command)
    words.push_back(shell_quoted(word.is_string() ? word.get<std::string>() : word.dump()));
  return joined(words, " ");
}

std::string provenance(const Json& manifest) {
  Json rest = manifest;
  for (const char* shown : {"plugins", "command"}) rest.erase(shown);
  return rest.empty() ? "" : "<h3>Program and machine</h3>" + table_html(rest);
}

std::string resolved_experiment(const Json& experiment) {
  if (experiment.empty()) return {};
  const std::string text = experiment.dump(2, ' ', false, Json::error_handler_t::replace);
  return "<details><summary>The full experiment, every default written out (experiment.json)</summary><pre>" +
         escape_html(text) + "</pre></details>";
}

}  // namespace

std::string title_text(const Run& run) {
  const std::string title = text_at(run.experiment, {"title"});
  return title.empty() ? "MPM Sandbox run" : escape_html(title);
}

std::string heading(const Run& run) {
  std::string html = "<header>\n<h1>" + title_text(run) + "</h1>\n";
  const std::string description = text_at(run.experiment, {"description"});
  if (!description.empty()) html += "<p>" + escape_html(description) + "</p>\n";
  if (!run.experiment.empty()) {
    html += "<p>" + opening_sentence(run.experiment) + body_sentence(run.experiment) +
            material_sentence(run.experiment) + method_sentence(run.experiment) + grid_sentence(run.experiment) +
            "</p>\n";
  }
  return html + "</header>\n";
}

std::string methods(const Run& run) {
  const Json* plugins = member(run.manifest, {"plugins"});
  if (plugins == nullptr || plugins->empty()) return {};
  if (!plugins->is_array()) return section("Methods and sources", value_html("plugins", *plugins));
  std::string html;
  for (const Json& plugin : *plugins) html += method_html(plugin);
  return section("Methods and sources", html);
}

std::string plan(const Run& run) {
  std::string tables;
  Json loose = Json::object();
  for (const auto& item : run.plan.items()) {
    if (item.value().is_structured() && !item.value().empty()) {
      tables += "<h3>" + label_html(item.key()) + "</h3>" + value_html(item.key(), item.value());
    } else {
      loose[item.key()] = item.value();
    }
  }
  return section("Plan: what the scene held, and why", (loose.empty() ? "" : table_html(loose)) + tables);
}

std::string reproduction(const Run& run) {
  std::string html;
  const Json* command = member(run.manifest, {"command"});
  const std::string line = command == nullptr ? "" : command_line(*command);
  if (!line.empty()) {
    html += "<p>The command that made this run:</p><pre>" + escape_html(line) + "</pre>";
  }
  if (!run.experiment.empty()) {
    html += "<p>The resolved experiment in this folder runs by itself as well:</p><pre>mpm run experiment.json</pre>";
  }
  return section("How to reproduce", html + resolved_experiment(run.experiment) + provenance(run.manifest));
}

std::string files(const Run& run) {
  std::vector<std::filesystem::path> found = support::files_with_ending(run.folder, {".json", ".csv", ".pvd", ".txt"});
  for (const std::string& format : support::film_formats())
    for (auto& film : support::files_with_ending(run.folder, {"." + format})) found.push_back(std::move(film));
  for (auto& collection : support::files_with_ending(run.folder / "vtk", {".pvd"}))
    found.push_back(std::move(collection));
  std::string html;
  for (const auto& path : found) {
    const std::string name = path.lexically_relative(run.folder).generic_string();
    html += "<li><a href=\"" + relative_link(name) + "\">" + escape_html(name) + "</a></li>";
  }
  return section("Files beside this page", html.empty() ? "" : "<ul class=\"files\">" + html + "</ul>");
}

}  // namespace mpm::output::report
