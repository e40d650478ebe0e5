// Pictures of a step: the page shows what the command draws, and its table of the step is what the plan says.

#include <map>
#include <regex>

#include "cli/program.hpp"

using namespace mpm::test;

namespace {

const fs::path sources = MPM_SOURCE_DIR;

std::string method_page() {
  return slurp(sources / "docs/method.md");
}

/// Scene and picture of each command of the page that draws one.
std::vector<std::pair<std::string, std::string>> commands_of_the_page() {
  const std::string page = method_page();
  const std::regex command(R"(\n    \./mpm plan (\S+) --graph (\S+)\n)");
  std::vector<std::pair<std::string, std::string>> found;
  for (std::sregex_iterator match(page.begin(), page.end(), command), end; match != end; ++match)
    found.emplace_back((*match)[1], (*match)[2]);
  return found;
}

std::string drawn(const std::string& scene) {
  const Folder folder;
  const Result result = call(folder, {"plan", (sources / scene).string(), "--graph", "step.svg"});
  INFO(result.err);
  REQUIRE(result.code == 0);
  CHECK(result.out == "step.svg\n");
  CHECK(folder.names() == Words{"step.svg"});
  return slurp(folder / "step.svg");
}

/// The names of open elements are empty at the end, quotes of attributes are paired, and nothing is left unescaped.
void check_well_formed(const std::string& svg) {
  const std::regex attributes(R"re(( [a-z0-9:-]+="[^"<&]*")*)re"), texts(R"(([^&]|&(lt|gt|amp|quot|apos);)*)");
  Words open;
  std::size_t at = 0;
  while (at < svg.size()) {
    const std::size_t tag = svg.find('<', at), end = svg.find('>', tag);
    CHECK(std::regex_match(svg.substr(at, tag - at), texts));
    if (tag == std::string::npos) break;
    REQUIRE(end != std::string::npos);
    std::string inside = svg.substr(tag + 1, end - tag - 1);
    at = end + 1;
    INFO(inside);
    if (inside.starts_with('/')) {
      REQUIRE(!open.empty());
      CHECK(inside == "/" + open.back());
      open.pop_back();
      continue;
    }
    const bool closed = inside.ends_with('/');
    if (closed) inside.pop_back();
    const std::string name = inside.substr(0, inside.find(' '));
    CHECK(std::regex_match(inside.substr(name.size()), attributes));
    if (!closed) open.push_back(name);
  }
  CHECK(open.empty());
}

/// The texts of the picture, in order.
Words texts_of(const std::string& svg) {
  const std::regex text(R"(<text[^>]*>([^<]*)</text>)");
  Words found;
  for (std::sregex_iterator match(svg.begin(), svg.end(), text), end; match != end; ++match)
    found.push_back((*match)[1]);
  return found;
}

Json plan_of(const Words& words) {
  const Folder folder;
  Words all{"plan"};
  all.insert(all.end(), words.begin(), words.end());
  all.push_back("--json");
  const Result result = call(folder, all);
  INFO(result.err);
  REQUIRE(result.code == 0);
  return Json::parse(result.out);
}

/// Rows of the page's table of the step: the names of a pass, and the place of it in each order.
struct TableRow {
  std::string names;
  Words places;
};
std::vector<TableRow> table_of_the_page() {
  std::istringstream page(method_page());
  std::vector<TableRow> rows;
  bool inside = false;
  for (std::string line; std::getline(page, line);) {
    if (inside && !line.starts_with('|')) break;
    Words cells;
    std::istringstream text(line);
    for (std::string cell; std::getline(text, cell, '|');) cells.push_back(cell);
    if (inside && !line.starts_with("|---")) {
      REQUIRE(cells.size() == 7);
      TableRow row{cells[1], {}};
      for (std::size_t order = 3; order < 7; ++order)
        row.places.push_back(cells[order].substr(1, cells[order].size() - 2));
      rows.push_back(row);
    }
    inside = inside || line.starts_with("| pass | what it does | USL ");
  }
  return rows;
}

}  // namespace

TEST_CASE("the page's pictures are what its commands draw") {
  const auto commands = commands_of_the_page();
  std::map<std::string, std::string> pictures;
  for (const auto& [scene, picture] : commands) {
    INFO(scene);
    CHECK(has(method_page(), "](" + fs::path(picture).lexically_relative("docs").string() + ")"));
    const std::string svg = drawn(scene);
    CHECK(svg == slurp(sources / picture));
    check_well_formed(svg);
    pictures[fs::path(picture).stem().string()] = svg;
  }
  CHECK(pictures.size() == 4);
  CHECK(has(pictures["fused"], ">gather, strain and scatter</text>"));
  CHECK(has(pictures["filtered"], ">repeat up to 7 times</text>"));
  CHECK(has(pictures["contact"], ">volume gradient</text>"));
  CHECK(has(pictures["temperature"], ">heat to temperature</text>"));
  Words kept;
  for (const auto& entry : fs::directory_iterator(sources / "docs/graphs"))
    kept.push_back(entry.path().stem().string());
  std::sort(kept.begin(), kept.end());
  CHECK(kept == Words{"contact", "filtered", "fused", "temperature"});
}

TEST_CASE("a picture has a row for each pass, a mark for each use of a field, and the reason") {
  const Folder folder;
  Json scene = ball();
  scene["title"] = "A <ball> & \"wall\"";
  scene["solver"]["passes"] = "separate";
  spill(folder / "scene.json", scene.dump());
  REQUIRE(call(folder, {"plan", "scene.json", "--graph", "step.svg"}).code == 0);
  const std::string svg = slurp(folder / "step.svg");
  check_well_formed(svg);
  const Words texts = texts_of(svg);
  const auto holds = [&](const std::string& text) {
    return std::find(texts.begin(), texts.end(), text) != texts.end();
  };
  CHECK(texts.front() == "One step of: A &lt;ball&gt; &amp; \"wall\"");
  std::map<std::string, std::size_t> uses{{"reads", 0}, {"writes", 0}, {"adds", 0}};
  const Json plan = plan_of({(folder / "scene.json").string()});
  for (const Json& pass : plan["passes"]) {
    INFO(pass["name"]);
    CHECK(holds(pass["name"]));
    CHECK(holds(pass["because"]));
    for (auto& [key, count] : uses) count += pass.contains(key) ? pass[key].size() : 0;
  }
  const auto drawn_as = [&](const std::string& mark) {
    std::size_t count = 0;
    for (std::size_t at = svg.find(mark); at != std::string::npos; at = svg.find(mark, at + 1)) ++count;
    return count - 1;  // the legend has one of each
  };
  CHECK(drawn_as("r=\"8\"") == uses["reads"]);
  CHECK(drawn_as("r=\"4.5\"") == uses["writes"]);
  CHECK(drawn_as("<path ") == uses["adds"]);
  CHECK(uses["reads"] > 5);
}

TEST_CASE("the page's table of the step has the plan's passes in their places") {
  const std::vector<TableRow> table = table_of_the_page();
  REQUIRE(table.size() > 5);
  const Words orders{"last", "first", "modified_last", "averaged"};
  for (std::size_t order = 0; order < orders.size(); ++order) {
    INFO(orders[order]);
    const Json passes = plan_of({(sources / "experiments/quickstart.json").string(), "--set",
                                 "/solver/stress_update=\"" + orders[order] + "\"", "--set",
                                 "/shape={\"type\": \"cpdi\"}"})["passes"];  // which is not fused
    std::size_t numbered = 0;
    for (const TableRow& row : table) numbered += row.places[order] != "–";
    CHECK(numbered == passes.size());
    for (std::size_t pass = 0; pass < passes.size(); ++pass) {
      INFO(passes[pass]["name"]);
      CHECK(std::any_of(table.begin(), table.end(), [&](const TableRow& row) {
        return has(row.names, "`" + passes[pass]["name"].get<std::string>() + "`") &&
               row.places[order] == std::to_string(pass + 1);
      }));
    }
  }
}

TEST_CASE("a picture that cannot be written is an error that names it") {
  const Folder folder;
  spill(folder / "scene.json", ball().dump());
  const Result result = call(folder, {"plan", "scene.json", "--graph", "none/step.svg"});
  CHECK(result.code == 5);
  CHECK(result.out.empty());
  CHECK(has(result.err, "cannot write none/step.svg: No such file or directory"));
  CHECK(folder.names() == Words{"scene.json"});
}
