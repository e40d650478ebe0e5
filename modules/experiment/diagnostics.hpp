#pragma once
// What is wrong with an input, where, and how to say so.

#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace mpm {

/// One mistake in an input. Line 0 means no position in a file: the file itself (missing, unreadable), or an option
/// such as "--set".
struct Problem {
  std::string file;  ///< as the user named it, or the option the value came from
  int line = 0, column = 0;
  std::string pointer;  ///< JSON pointer; empty when there is none
  std::string message;

  /// The problem as "file:line:column: /json/pointer: message", without the parts that are empty.
  std::string text() const;
};

/// Bad input, with every problem found, in the order of the file. what() is one line a problem.
class InputError : public std::runtime_error {
 public:
  static constexpr int exit_code = 2;

  explicit InputError(std::vector<Problem> problems);
  const std::vector<Problem>& problems() const { return problems_; }

 private:
  std::vector<Problem> problems_;
};

/// Throws InputError with one problem of a whole file, folder or option.
[[noreturn]] void refuse_input(const std::string& what, const std::string& message);

/// The candidate closest to `name` in edit distance, or empty when none is close enough to be a likely slip.
std::string nearest_name(std::string_view name, std::span<const std::string> candidates);

/// The names as `"a", "b", "c"`; long lists end in `… (n in all)`.
std::string quoted_list(std::span<const std::string> names);

/// The name as `"name"`, with control characters made visible and very long text cut.
std::string in_quotes(std::string_view name);

/// The words `; did you mean "x"?` with the nearest candidate, or nothing.
std::string did_you_mean(std::string_view name, std::span<const std::string> candidates);

/// The words of did_you_mean followed by the list of what there is: `; did you mean "x"? (LIST)`, or `; LIST` when
/// nothing is near.
std::string suggestion(std::string_view name, std::span<const std::string> candidates, const std::string& list);

/// A number as a person would write it, at most 10 significant digits.
std::string number_text(double value);

}  // namespace mpm
