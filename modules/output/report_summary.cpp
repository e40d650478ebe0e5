// The parts of the report that come from summary.json: outcome, headline numbers, expectations, measurements.
#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "output/report_parts.hpp"
#include "output/summary_value.hpp"

namespace mpm::output::report {
namespace {

std::string banner(const char* kind, const std::string& title, const std::string& body) {
  return std::string("<div class=\"banner ") + kind + "\"><strong>" + title + "</strong>" + body + "</div>\n";
}

const char* meaning_of(std::int64_t exit_code, bool broke_a_limit) {
  switch (exit_code) {
    case 0:
      return "Done: the run finished and every expectation held";
    case 2:
      return "Not run: the input is wrong";
    case 3:
      return "Failed: the run became unstable or invalid";
    case 4:
      return broke_a_limit ? "Finished, but broke a limit" : "Finished, but an expectation failed";
    case 5:
      return "Failed: the machine could not go on";
    default:
      return "Failed";
  }
}

bool broke_a_limit(const Run& run) {
  const Json* status = member(run.summary, {"outcome", "status"});
  return status != nullptr && *status == limit_broken;
}

std::string warnings_banner(const Run& run) {
  const Json* warnings = member(run.summary, {"warnings"});
  if (warnings == nullptr || !warnings->is_array() || warnings->empty()) return {};
  std::string list = "<ul>";
  for (const Json& warning : *warnings) list += "<li>" + value_html({}, warning) + "</li>";
  return banner("warn", warnings->size() == 1 ? "One warning" : std::to_string(warnings->size()) + " warnings",
                list + "</ul>");
}

/// The limits that the run broke, where the outcome does not name them already.
std::string flags_banner(const Run& run) {
  const Json* flags = member(run.summary, {"flags"});
  if (flags == nullptr || !flags->is_array() || flags->empty() || broke_a_limit(run)) return {};
  std::string list = "<ul>";
  for (const Json& flag : *flags) list += "<li>" + value_html({}, flag) + "</li>";
  return banner("bad", "Flagged", list + "</ul>");
}

std::string unreadable_banner(const Run& run) {
  if (run.unreadable.empty()) return {};
  std::string names;
  for (const std::string& name : run.unreadable) names += (names.empty() ? "" : ", ") + escape_html(name);
  return banner("warn", "Not all of the record could be read", "<span>Cut or malformed: " + names + "</span>");
}

std::string outcome_banner(const Run& run) {
  const Json* outcome = member(run.summary, {"outcome"});
  const Json* code = member(run.summary, {"outcome", "exit_code"});
  if (code == nullptr || !code->is_number_integer()) {
    return banner("bad", "No outcome was recorded",
                  "<span>The run was cut off before its end, or is still going on. What it had written by then "
                  "follows.</span>");
  }
  const bool good = code->get<std::int64_t>() == 0;
  std::string body;
  const Json* reason = member(*outcome, {"reason"});
  if (reason != nullptr && reason->is_string() && !reason->get_ref<const std::string&>().empty()) {
    body = "<span>" + escape_html(reason->get_ref<const std::string&>()) + "</span>";
  }
  Json rest = *outcome;
  for (const char* shown : {"exit_code", "reason"}) rest.erase(shown);
  if (good) rest.erase("status");
  if (!rest.empty()) body += "<span>" + table_html(rest) + "</span>";
  const std::string code_text = good ? "" : " (exit code " + integer_html(code->get<std::int64_t>()) + ")";
  return banner(good ? "good" : "bad", meaning_of(code->get<std::int64_t>(), broke_a_limit(run)) + code_text, body);
}

/// Finds a value by the end of its dotted path: "dt_min" or "time_step.min", wherever its group is, nearest to the top.
const Json* find_by_path(const Json& root, std::initializer_list<const char*> names) {
  std::vector<std::pair<std::string, const Json*>> level = {{"", &root}};
  while (!level.empty()) {
    std::vector<std::pair<std::string, const Json*>> next;
    for (const auto& [path, value] : level) {
      for (const char* name : names) {
        if (path.ends_with(std::string(".") + name)) return value;
      }
      if (!value->is_object()) continue;
      for (const auto& item : value->items()) next.emplace_back(path + "." + item.key(), &item.value());
    }
    level = std::move(next);
  }
  return nullptr;
}

std::string card(const char* label, const std::string& value, const std::string& note = {}) {
  const std::string small = note.empty() ? "" : "<small>" + note + "</small>";
  return std::string("<div class=\"card\"><dt>") + label + "</dt><dd>" + value + small + "</dd></div>\n";
}

std::string time_step_card(const Json& summary) {
  const Json* least = find_by_path(summary, {"dt_min", "min_dt", "time_step_min", "time_step.min", "dt.min"});
  const Json* most = find_by_path(summary, {"dt_max", "max_dt", "time_step_max", "time_step.max", "dt.max"});
  const Json* reason = find_by_path(summary, {"time_step.limited_by"});
  const Json* limiting = find_by_path(summary, {"limiting_particle"});
  if (least == nullptr && most == nullptr) return {};
  std::string range = inline_html({}, least != nullptr ? *least : *most);
  if (least != nullptr && most != nullptr && *least != *most) range += " to " + inline_html({}, *most);
  // A particle says by itself that its wave limits the step.
  std::string limit = reason == nullptr || (limiting != nullptr && *reason == "wave") ? "" : inline_html({}, *reason);
  if (limiting != nullptr) limit += (limit.empty() ? "" : ", ") + inline_html({}, *limiting);
  return card("time step", range + "\xC2\xA0s", limit.empty() ? "" : "limited by " + limit);
}

std::string simple_cards(const Json& summary) {
  struct Entry {
    const char* label;
    std::initializer_list<const char*> names;
    const char* unit;
  };
  static const Entry entries[] = {
      {"particles", {"particles", "particle_count"}, ""},
      {"steps", {"steps", "step_count"}, ""},
      {"simulated time", {"simulated_time", "end_time", "final_time", "time"}, "\xC2\xA0s"},
      {"particle-steps per second", {"particle_steps_per_second"}, ""},
      {"wall time", {"wall_seconds", "wall_time", "seconds"}, "\xC2\xA0s"},
      {"per particle", {"bytes_per_particle"}, ""},
      {"peak memory", {"peak_memory", "peak_memory_bytes"}, ""},
      {"total energy, final / initial", {"total.final_over_initial"}, ""},
  };
  std::string html;
  for (const Entry& entry : entries) {
    const Json* value = find_by_path(summary, entry.names);
    if (value == nullptr || value->is_structured() || value->is_null()) continue;
    html += card(entry.label, inline_html(*entry.names.begin(), *value) + entry.unit);
  }
  return html;
}

std::string requirement(const Json& expectation) {
  static constexpr std::pair<const char*, const char*> kinds[] = {
      {"at_least", "at least "}, {"at_most", "at most "}, {"equals", "equal to "}};
  std::string html;
  for (const auto& [key, words] : kinds) {
    const Json* bound = member(expectation, {key});
    if (bound != nullptr) html += (html.empty() ? "" : ", ") + std::string(words) + inline_html({}, *bound);
  }
  const Json* why_not = member(expectation, {"not_judged"});
  if (why_not != nullptr) html += (html.empty() ? "" : "; ") + inline_html({}, *why_not);
  return html;
}

/// What an expectation says beyond the known keys (a tolerance, a note), to be kept beside its requirement.
std::string other_terms(const Json& expectation) {
  static const std::set<std::string> known = {"metric", "at_least", "at_most", "equals", "value", "held", "not_judged"};
  std::string html;
  for (const auto& item : expectation.items()) {
    if (known.count(item.key()) == 0)
      html += ", " + label_html(item.key()) + " " + inline_html(item.key(), item.value());
  }
  return html;
}

std::string verdict(const Json& expectation) {
  const Json* held = member(expectation, {"held"});
  if (held == nullptr || !held->is_boolean()) return "<span class=\"verdict warn\">? not judged</span>";
  return held->get<bool>() ? "<span class=\"verdict good\">✓ held</span>"
                           : "<span class=\"verdict bad\">✗ not held</span>";
}

/// A bar from a common zero; the scale leaves room on the negative side only when something is negative.
std::string bar(double value, double least, double most) {
  const double span = most - least;
  if (!(span > 0.0) || !std::isfinite(span) || !std::isfinite(value)) return "<span class=\"track\"></span>";
  const auto percent = [&](double x) { return number_html(100.0 * x / span) + "%"; };
  const double left = std::min(value, 0.0) - least;
  const std::string zero = least < 0.0 ? "<b style=\"left:" + percent(-least) + "\"></b>" : "";
  // A share below 0.0001 % would be written as a power of ten, which no style sheet reads.
  const double width = std::max(std::abs(value), 1e-4 * span);
  return "<span class=\"track\"><i class=\"" + std::string(value < 0.0 ? "minus" : "plus") +
         "\" style=\"left:" + (left <= 1e-4 * span ? "0" : percent(left)) + ";width:" + percent(width) + "\"></i>" +
         zero + "</span>";
}

struct Share {
  std::string name;
  double value;
  bool closes;  ///< what the others leave unexplained
};

/// The numbers of an object; `closing` is the key of the one that closes the sum, if any.
std::vector<Share> shares_of(const Json& object, const std::string& closing = "") {
  std::vector<Share> shares;
  for (const auto& item : object.items()) {
    if (item.value().is_number()) shares.push_back({item.key(), item.value().get<double>(), item.key() == closing});
  }
  return shares;
}

/// Members that are not numbers, for a plain table after the bars.
std::string remainder_html(const Json& object) {
  Json rest = Json::object();
  for (const auto& item : object.items()) {
    if (!item.value().is_number()) rest[item.key()] = item.value();
  }
  return rest.empty() ? "" : table_html(rest);
}

std::string bars_table(const std::vector<Share>& shares, const char* heads, const char* unit, bool with_percent) {
  double least = 0.0, most = 0.0, sum = 0.0;
  for (const Share& share : shares) {
    least = std::min(least, share.value);
    most = std::max(most, share.value);
    sum += share.value;
  }
  std::string html =
      std::string("<div class=\"scroll\"><table class=\"bars\"><thead><tr>") + heads + "</tr></thead><tbody>";
  for (const Share& share : shares) {
    html += share.closes ? "<tr class=\"total\">" : "<tr>";
    html += "<th scope=\"row\">" + label_html(share.name) + "</th><td class=\"number\">" + number_html(share.value) +
            "\xC2\xA0" + unit + "</td>";
    if (with_percent) {
      const double tenths = sum > 0.0 ? std::round(1000.0 * share.value / sum) / 10.0 : 0.0;
      html += "<td class=\"number\">" + number_html(tenths) + "\xC2\xA0%</td>";
    }
    html += "<td class=\"bar\">" + bar(share.value, least, most) + "</td></tr>";
  }
  return html + "</tbody></table></div>";
}

std::string ledger(const Json& energy) {
  const Json* causes = member(energy, {"ledger"});
  if (causes == nullptr) return {};
  if (!causes->is_object()) return "<h3>Ledger</h3>" + table_html(*causes);
  const Json* closing = member(energy, {"ledger_closed_by"});
  std::vector<Share> shares =
      shares_of(*causes, closing != nullptr && closing->is_string() ? closing->get<std::string>() : "");
  std::stable_partition(shares.begin(), shares.end(), [](const Share& share) { return !share.closes; });
  const Json* every = member(energy, {"ledger_every"});
  const std::string sampled = every == nullptr || !every->is_number()
                                  ? ""
                                  : " After the first step one in " + number_html(every->get<double>()) +
                                        " is entered and counts for all of them: the residual holds that error too.";
  return "<h3>Ledger: where the energy went, by cause</h3>"
         "<p class=\"soft\">The closing residual is what no cause accounts for; it should be small beside the "
         "rest." +
         sampled + "</p>" + bars_table(shares, "<th>cause</th><th class=\"number\">energy</th><th></th>", "J", false) +
         remainder_html(*causes);
}

/// What the books of the ledger are off by.
std::string books(const Json& energy) {
  const Json* found = member(energy, {"books"});
  if (found == nullptr) return {};
  return "<h3>Books of the ledger</h3><p class=\"soft\">What recorded and measured values differ by: kinetic energy of "
         "the grid against the works of all impulses (J) and mass and momentum of the nodes against those of the "
         "particles (kg, kg m/s) by rounding, stress power against stored and dissipated energy (J) the less the "
         "shorter the step.</p>" +
         table_html(*found);
}

std::string passes(const Json& performance) {
  const Json* seconds = member(performance, {"seconds_by_pass"});
  if (seconds == nullptr) return {};
  if (!seconds->is_object()) return "<h3>Time by pass</h3>" + table_html(*seconds);
  return "<h3>Time by pass</h3>" +
         bars_table(shares_of(*seconds),
                    "<th>pass</th><th class=\"number\">time</th><th class=\"number\">share</th><th></th>", "s", true) +
         remainder_html(*seconds);
}

/// A group of the summary as a plain table, without the members that another table shows.
std::string group(const Run& run, const char* name, std::initializer_list<const char*> shown) {
  const Json* found = member(run.summary, {name});
  if (found == nullptr || found->is_null()) return {};
  if (!found->is_object()) return value_html(name, *found);
  Json rest = *found;
  for (const char* key : shown) rest.erase(key);
  return rest.empty() ? "" : table_html(rest);
}

std::string energy_section(const Run& run) {
  const Json* energy = member(run.summary, {"energy"});
  if (energy == nullptr) return {};
  return section("Energy", "<p class=\"soft\">In J; this page keeps to SI units throughout.</p>" +
                               group(run, "energy", {"ledger", "ledger_closed_by", "books"}) + ledger(*energy) +
                               books(*energy));
}

std::string performance_section(const Run& run) {
  const Json* performance = member(run.summary, {"performance"});
  if (performance == nullptr) return {};
  return section("Performance", group(run, "performance", {"seconds_by_pass"}) + passes(*performance));
}

/// Tables of groups and values that no other section knows: nothing that was recorded is hidden.
std::string other_groups(const Run& run) {
  static const std::set<std::string> known = {"outcome",  "warnings", "expect", "limits",    "flags",      "energy",
                                              "momentum", "contact",  "error",  "stability", "performance"};
  Json loose = Json::object();
  std::string html;
  for (const auto& item : run.summary.items()) {
    if (known.count(item.key()) > 0) continue;
    if (item.value().is_structured()) {
      html += "<h3>" + label_html(item.key()) + "</h3>" + value_html(item.key(), item.value());
    } else {
      loose[item.key()] = item.value();
    }
  }
  return section("Also recorded", (loose.empty() ? "" : table_html(loose)) + html);
}

/// Table of what the run was held against: a group of the summary with a verdict for each of its entries.
std::string judged(const Run& run, const char* group, const char* title) {
  const Json* list = member(run.summary, {group});
  if (list == nullptr || list->empty()) return {};
  const bool known_form = list->is_array() && std::all_of(list->begin(), list->end(), [](const Json& e) {
                            return e.is_object() && e.contains("metric");
                          });
  if (!known_form) return section(title, value_html(group, *list));
  // The verdict comes first, so that a narrow screen shows it without scrolling.
  std::string html =
      "<div class=\"scroll\"><table><thead><tr><th>verdict</th><th>metric</th><th>expected</th>"
      "<th class=\"number\">found</th></tr></thead><tbody>";
  for (const Json& e : *list) {
    html += "<tr><td>" + verdict(e) + "</td><td><code>" + inline_html({}, e["metric"]) + "</code></td><td>" +
            requirement(e) + other_terms(e) + "</td><td class=\"number\">" +
            (e.contains("value") ? inline_html({}, e["value"]) : "—") + "</td></tr>";
  }
  return section(title, html + "</tbody></table></div>");
}

}  // namespace

std::string outcome(const Run& run) {
  return outcome_banner(run) + flags_banner(run) + warnings_banner(run) + unreadable_banner(run);
}

std::string headline_numbers(const Run& run) {
  const std::string cards = simple_cards(run.summary) + time_step_card(run.summary);
  return cards.empty() ? "" : "<dl class=\"cards\">\n" + cards + "</dl>\n";
}

std::string expectations(const Run& run) {
  return judged(run, "expect", "Expectations") + judged(run, "limits", "Limits");
}

std::string measurements(const Run& run) {
  return energy_section(run) + section("Momentum", group(run, "momentum", {})) +
         section("Contact", group(run, "contact", {})) +
         section("Errors against the exact solution", group(run, "error", {})) +
         section("Stability", group(run, "stability", {})) + performance_section(run) + other_groups(run);
}

}  // namespace mpm::output::report
