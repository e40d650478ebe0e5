#pragma once
// Numbers that a page of the docs prints, so that a test compares a run with what is printed and not with a copy of it.

#include <cmath>
#include <map>
#include <regex>
#include <stdexcept>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/files.hpp"

namespace mpm::test {

/// The text with each run of blanks and ends of lines as one blank.
inline std::string in_one_line(const std::string& text) {
  return std::regex_replace(text, std::regex("\\s+"), " ");
}

/// A number as it is printed.
struct PrintedNumber {
  double value;
  double half_unit;  ///< half of what one in its last digit is worth: what rounding may have taken from it

  /// Equal to every number that is printed so.
  Approx rounded() const { return Approx(value).epsilon(0).margin(half_unit * (1 + 1e-9)); }
};

/// The number that a text like "−0.03", "1740", "1.3·10⁷" or "10⁻¹²" is; a bare power of ten stands for a bound and has no
/// last digit.
inline PrintedNumber printed_number(std::string text) {
  static const std::map<std::string, std::string> raised{{"⁰", "0"}, {"¹", "1"}, {"²", "2"}, {"³", "3"},
                                                         {"⁴", "4"}, {"⁵", "5"}, {"⁶", "6"}, {"⁷", "7"},
                                                         {"⁸", "8"}, {"⁹", "9"}, {"⁻", "-"}, {"−", "-"}};
  for (const auto& [sign, plain] : raised)
    for (std::size_t at = text.find(sign); at != std::string::npos; at = text.find(sign))
      text.replace(at, sign.size(), plain);
  static const std::regex power("(?:(-?[0-9.]+)·)?10(-?[0-9]+)"), plain("-?[0-9]+(?:\\.([0-9]+))?");
  std::smatch match;
  const auto decimals = [](const std::string& digits) {
    const std::size_t point = digits.find('.');
    return point == std::string::npos ? 0 : static_cast<int>(digits.size() - point - 1);
  };
  if (text.find("·") != std::string::npos || text.starts_with("10-")) {
    if (!std::regex_match(text, match, power)) throw std::runtime_error("no printed number: " + text);
    const double scale = std::pow(10.0, std::stoi(match[2]));
    if (!match[1].matched) return {scale, 0};
    return {std::stod(match[1]) * scale, 0.5 * std::pow(10.0, -decimals(match[1])) * scale};
  }
  if (!std::regex_match(text, match, plain)) throw std::runtime_error("no printed number: " + text);
  return {std::stod(text), 0.5 * std::pow(10.0, -decimals(text))};
}

/// A page of the docs, and what tests know of its numbers. Numbers in blocks of commands, in `code` and in links are not
/// counted: they are what a reader types, not what comes out.
class Page {
 public:
  explicit Page(const std::string& file)
      : file_(file),
        lines_(mpm::support::read_file(std::string(MPM_SOURCE_DIR "/") + file)),
        text_(in_one_line(lines_)) {}

  /// Leaves the first table after these words out: another test compares it.
  void leave_out_table_after(const std::string& words) {
    const std::size_t at = lines_.find(words), first = at == std::string::npos ? at : lines_.find("\n|", at);
    if (first == std::string::npos) throw std::runtime_error(file_ + " has no table after: " + words);
    std::size_t end = first;
    while (lines_.compare(end + 1, 1, "|") == 0) end = lines_.find('\n', end + 1);
    lines_.replace(first, end - first, "\n~\n");
    text_ = in_one_line(lines_);
  }
  /// Keeps only what stands from one of these words up to the other.
  void keep_from_to(const std::string& from, const std::string& to) {
    const std::size_t first = lines_.find(from), last = first == std::string::npos ? first : lines_.find(to, first);
    if (last == std::string::npos) throw std::runtime_error(file_ + " does not say: " + from + " ... " + to);
    lines_ = lines_.substr(first, last - first);
    text_ = in_one_line(lines_);
  }

  /// The numbers at the # of the sentence, which the page must hold once.
  std::vector<PrintedNumber> read(const std::string& sentence) const {
    const std::regex pattern = pattern_of(sentence);
    std::smatch match;
    if (!std::regex_search(text_, match, pattern)) throw std::runtime_error(file_ + " does not say: " + sentence);
    std::vector<PrintedNumber> numbers;
    for (std::size_t k = 1; k < match.size(); ++k) numbers.push_back(printed_number(match[k]));
    const std::string rest = match.suffix();
    if (std::regex_search(rest, pattern)) throw std::runtime_error(file_ + " says twice: " + sentence);
    return numbers;
  }

  void add_measured(const std::string& sentence) { measured_.push_back(sentence); }
  /// Sentences whose numbers the reader gives, or that follow by arithmetic from those: nothing that a run decides.
  void add_given(const std::vector<std::string>& sentences) {
    given_.insert(given_.end(), sentences.begin(), sentences.end());
  }
  /// Patterns of names that have digits in them ("FMPM(4)").
  void add_names(const std::vector<std::string>& patterns) { names_ = patterns; }

  /// What is left of the page around numbers that no test has read and that are not given.
  std::vector<std::string> numbers_of_nobody() const { return left_around("(?:[0-9]|½|¾|¼)"); }

  /// The same around words that state a quantity: shares, multiples and what becomes half or double. Not counted are the times
  /// and steps of the scenes, by the names that all pages give them.
  std::vector<std::string> words_of_nobody() const {
    static const std::string number =
        "(?:two|three|four|five|six|seven|eight|nine|ten|twelve|fifteen|twenty|thirty|forty|fifty|sixty|hundred|"
        "thousand|million|few)";
    static const std::string shares =
        "half|thirds?|quarters?|fifths?|sixths?|sevenths?|eighths?|ninths?|tenths?|twelfths?|twentieths?|hundredths?|"
        "thousandths?|millionths?|one per ?cent|" +
        number + " per ?cent";
    static const std::string multiples =
        "twice|thrice|times as|" + number + " times|(?:two|three|four|five|ten|hundred)fold";
    static const std::string changes = "double[sd]|doubling|halve[sd]?|halving|treble[sd]?|orders? of magnitude";
    return left_around("(?:\\b(?:" + shares + "|" + multiples + "|" + changes + ")\\b|⅓|⅔|⅛)",
                       {"half a (?:step|period|cell)", "a quarter of a period",
                        "(?:a|three) tenths? of the estimated?(?: step)?", "half their difference", "half-widths?"});
  }

 private:
  /// Pieces of the page that hold what a pattern says, without sentences that a test has read or that are given, without what a
  /// reader types and without names.
  std::vector<std::string> left_around(const std::string& pattern,
                                       const std::vector<std::string>& more_names = {}) const {
    std::string left = text_;
    for (const auto* sentences : {&measured_, &given_})
      for (const std::string& sentence : *sentences) {
        read(sentence);
        left = std::regex_replace(left, pattern_of(sentence), "\n");
      }
    for (const char* typed : {"```.*?```", "`[^`]*`", "!\\[[^\\]]*\\]\\([^)]*\\)", "\\]\\([^)]*\\)",
                              "[Ll]essons? [0-9]( to [0-9])?", "exit code [0-9]"})
      left = std::regex_replace(left, std::regex(typed), " ");
    for (const auto* names : {&names_, &more_names})
      for (const std::string& name : *names) left = std::regex_replace(left, std::regex(name), " ");
    std::vector<std::string> found;
    const std::regex wanted("[^\n]{0,40}" + pattern + "[^\n]{0,20}");
    for (std::sregex_iterator match(left.begin(), left.end(), wanted), end; match != end; ++match)
      found.push_back(match->str());
    return found;
  }

  static std::regex pattern_of(const std::string& sentence) {
    const std::string quoted = std::regex_replace(in_one_line(sentence), std::regex(R"([.*+?^${}()|\[\]\\])"), "\\$&");
    static const std::string number =
        "((?:−|-)?[0-9]+(?:\\.[0-9]+)?(?:·10(?:⁻|⁰|¹|²|³|⁴|⁵|⁶|⁷|⁸|⁹)+|(?:⁻|⁰|¹|²|³|⁴|⁵|⁶|⁷|⁸|⁹)+)?)";
    return std::regex(std::regex_replace(quoted, std::regex("#"), number));
  }

  std::string file_, lines_, text_;
  std::vector<std::string> measured_, given_, names_;
};

/// A sentence of a page with a # in place of each number that a run decides.
class Claim {
 public:
  Claim(Page& page, const std::string& sentence) : page_(page), sentence_(sentence) { page.add_measured(sentence); }

  /// The number in the place of one #, as rounded as it is printed.
  Approx operator[](std::size_t k) const { return page_.read(sentence_).at(k).rounded(); }
  double number(std::size_t k) const { return page_.read(sentence_).at(k).value; }

 private:
  const Page& page_;
  std::string sentence_;
};

}  // namespace mpm::test
