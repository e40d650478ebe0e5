// The figures and particle frames of the report, embedded so that the page is one file.
#include <algorithm>
#include <array>
#include <string_view>

#include "output/report_parts.hpp"
#include "output/rounding.hpp"
#include "support/base64.hpp"
#include "support/files.hpp"
#include "support/natural_order.hpp"

namespace mpm::output::report {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_frames = 8;
constexpr std::uintmax_t largest_vector_figure = 2 << 20;  ///< a scatter of many particles is smaller as pixels

std::string image(const fs::path& path, const std::string& description) {
  const char* type = path.extension() == ".svg" ? "image/svg+xml" : "image/png";
  std::string html = "<img alt=\"" + escape_html(description) + "\" src=\"data:" + type + ";base64,";
  support::append_base64(html, support::read_file(path));
  return html + "\">";
}

std::string caption_of(const fs::path& path) {
  std::string words = path.stem().string();
  std::replace(words.begin(), words.end(), '_', ' ');
  return words;
}

/// The order of figures: what a reader asks first comes first; figures of other names follow as people count.
constexpr std::array<std::string_view, 15> reading_order{
    "energy",        "dissipation", "contact",          "contact_pairs", "contact_pair_impulses",
    "contact_nodes", "reactions",   "reaction_moments", "error",         "ledger",
    "heat",          "heat_held",   "volume_ratio",     "momentum",      "angular_momentum"};

std::size_t place_of(const fs::path& figure) {
  return static_cast<std::size_t>(std::find(reading_order.begin(), reading_order.end(), figure.stem().string()) -
                                  reading_order.begin());
}

/// The picture of each figure: the vector twin, which is sharp at every width, unless it is very large and there are
/// pixels.
std::vector<fs::path> chosen_figures(const fs::path& folder) {
  std::vector<fs::path> chosen;
  for (const fs::path& path : support::files_with_ending(folder, {".svg", ".png"})) {
    const fs::path pixels = fs::path(path).replace_extension(".png"), vector = fs::path(path).replace_extension(".svg");
    std::error_code error;
    const bool take_pixels = fs::exists(pixels, error) &&
                             (!fs::exists(vector, error) || fs::file_size(vector, error) > largest_vector_figure);
    if (path == (take_pixels ? pixels : vector)) chosen.push_back(path);
  }
  std::stable_sort(chosen.begin(), chosen.end(),
                   [](const fs::path& a, const fs::path& b) { return place_of(a) < place_of(b); });
  return chosen;
}

/// Links to the files of the same name: the numbers behind the figure, and its other forms.
std::string twin_links(const fs::path& figure) {
  std::string html;
  for (const char* ending : {".csv", ".svg", ".png", ".pdf"}) {
    const fs::path twin = fs::path(figure).replace_extension(ending);
    std::error_code ignored;
    if (!fs::exists(twin, ignored)) continue;
    const std::string name = twin.filename().string();
    html += std::string(html.empty() ? "" : " · ") + "<a href=\"" + relative_link("figures/" + name) + "\">" +
            escape_html(name) + "</a>";
  }
  return html;
}

std::vector<fs::path> spread_evenly(const std::vector<fs::path>& all, std::size_t most) {
  if (all.size() <= most) return all;
  std::vector<fs::path> some;
  for (std::size_t i = 0; i < most; ++i) some.push_back(all[(i * (all.size() - 1) + (most - 1) / 2) / (most - 1)]);
  return some;
}

}  // namespace

std::string figures(const Run& run) {
  const RoundingRule rule(run);
  std::string html, folded;
  for (const fs::path& path : chosen_figures(run.folder / "figures")) {
    const std::string caption = caption_of(path);
    const std::string figure = "<figure>" + image(path, caption) + "<figcaption><b>" + escape_html(caption) +
                               "</b><span>" + twin_links(path) + "</span></figcaption></figure>";
    if (const auto remark = rule.remark(path.stem().string()))
      folded +=
          "<details><summary><b>" + escape_html(caption) + "</b>: " + *remark + "</summary>" + figure + "</details>\n";
    else
      html += figure + "\n";
  }
  return section("Figures", html + folded);
}

std::string frames(const Run& run) {
  const std::vector<fs::path> all = support::files_with_ending(run.folder / "frames", {".png"});
  if (all.empty()) return {};
  const std::vector<fs::path> shown = spread_evenly(all, most_frames);
  std::string html;
  if (shown.size() < all.size()) {
    html += "<p class=\"soft\">" + std::to_string(shown.size()) + " of " + std::to_string(all.size()) +
            " frames, from the first to the last; the others are in <code>frames/</code>.</p>";
  }
  html += "<div class=\"strip\">\n";
  for (const fs::path& path : shown) {
    const std::string caption = caption_of(path);
    html += "<figure>" + image(path, caption) + "<figcaption>" + escape_html(caption) + "</figcaption></figure>\n";
  }
  return section("Particle frames", html + "</div>");
}

}  // namespace mpm::output::report
