#include "experiment/diagnostics.hpp"

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <numeric>
#include <tuple>

namespace mpm {
namespace {

std::vector<Problem> in_file_order(std::vector<Problem> problems) {
  // Options come after the file, as they act on it.
  const auto key = [](const Problem& p) {
    return std::make_tuple(p.line == 0 && !p.pointer.empty(), p.line, p.column);
  };
  std::stable_sort(problems.begin(), problems.end(),
                   [&](const Problem& a, const Problem& b) { return key(a) < key(b); });
  const auto same = [](const Problem& a, const Problem& b) { return a.text() == b.text(); };
  problems.erase(std::unique(problems.begin(), problems.end(), same), problems.end());
  return problems;
}

std::string joined(const std::vector<Problem>& problems) {
  std::string all;
  for (const Problem& problem : problems) all += (all.empty() ? "" : "\n") + problem.text();
  return all;
}

char lower(char c) {
  return static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
}

/// Edit distance with transpositions of neighbours, ignoring case.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1), previous(b.size() + 1), row(b.size() + 1);
  std::iota(previous.begin(), previous.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const bool equal = lower(a[i - 1]) == lower(b[j - 1]);
      row[j] = std::min({previous[j] + 1, row[j - 1] + 1, previous[j - 1] + (equal ? 0 : 1)});
      const bool swapped = i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) && lower(a[i - 2]) == lower(b[j - 1]);
      if (swapped) row[j] = std::min(row[j], before[j - 2] + 1);
    }
    before.swap(previous);
    previous.swap(row);
  }
  return previous[b.size()];
}

}  // namespace

std::string Problem::text() const {
  std::string where = file;
  if (line > 0) where += ":" + std::to_string(line) + ":" + std::to_string(column);
  return where + ": " + (pointer.empty() ? "" : pointer + ": ") + message;
}

InputError::InputError(std::vector<Problem> problems)
    : std::runtime_error(joined(in_file_order(problems))), problems_(in_file_order(std::move(problems))) {}

void refuse_input(const std::string& what, const std::string& message) {
  throw InputError({Problem{what, 0, 0, "", message}});
}

std::string nearest_name(std::string_view name, std::span<const std::string> candidates) {
  if (name.size() > 100) return {};
  std::string best;
  // A third of the letters may be wrong: enough for slips and plurals, not for unrelated words.
  std::size_t closest = std::max<std::size_t>(1, (name.size() + 2) / 3) + 1;
  for (const std::string& candidate : candidates) {
    const std::size_t distance = edit_distance(name, candidate);
    if (distance < closest && distance < std::max(name.size(), candidate.size())) {
      closest = distance;
      best = candidate;
    }
  }
  if (!best.empty() || name.size() < 3) return best;
  for (const std::string& candidate : candidates) {
    if (candidate.find(name) != std::string::npos || (candidate.size() > 2 && name.find(candidate) != name.npos)) {
      return candidate;
    }
  }
  return {};
}

std::string in_quotes(std::string_view name) {
  constexpr std::size_t longest = 80;
  std::string text = "\"";
  for (std::size_t i = 0; i < std::min(name.size(), longest); ++i) {
    const auto byte = static_cast<unsigned char>(name[i]);
    if (byte >= 0x20 && byte != 0x7f) {
      text += name[i];
    } else {
      char escape[8];
      std::snprintf(escape, sizeof escape, "\\u%04x", byte);
      text += escape;
    }
  }
  return text + (name.size() > longest ? "…\"" : "\"");
}

std::string quoted_list(std::span<const std::string> names) {
  constexpr std::size_t most = 40;
  std::string list;
  for (std::size_t i = 0; i < std::min(names.size(), most); ++i) list += (i ? ", " : "") + in_quotes(names[i]);
  if (names.size() > most) list += ", … (" + std::to_string(names.size()) + " in all)";
  return list;
}

std::string did_you_mean(std::string_view name, std::span<const std::string> candidates) {
  const std::string nearest = nearest_name(name, candidates);
  return nearest.empty() ? "" : "; did you mean " + in_quotes(nearest) + "?";
}

std::string suggestion(std::string_view name, std::span<const std::string> candidates, const std::string& list) {
  const std::string nearest = did_you_mean(name, candidates);
  return nearest.empty() ? "; " + list : nearest + " (" + list + ")";
}

std::string number_text(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.10g", value);
  return text;
}

}  // namespace mpm
