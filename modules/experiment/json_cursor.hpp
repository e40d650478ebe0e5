#pragma once
// A cursor over JSON text that knows its line and column, and says in plain words what is wrong where parsing stopped.

#include <string>
#include <string_view>

#include "experiment/located_json.hpp"

namespace mpm {

/// What the parser saw last.
enum class JsonState { start, after_open, after_key, after_value };

class JsonCursor {
 public:
  explicit JsonCursor(std::string_view text) : text_(text) {}

  bool at_end() const { return at_ >= text_.size(); }
  char peek(std::size_t ahead = 0) const { return at_ + ahead < text_.size() ? text_[at_ + ahead] : '\0'; }
  Position position() const { return {line_, column_, {}}; }
  void advance();

  /// Passes white space and comments. Returns false, standing on its start, at a comment that is never closed or no
  /// comment.
  bool skip_blank();
  /// Passes white space, comments, ',' and ':'.
  void skip_separators();
  /// Passes one token of JSON: a bracket, string, number, or true, false, null.
  void skip_token();
  /// Passes what a person would take for one token: up to the next blank or bracket, or one string.
  void skip_word();
  /// The word that skip_word would pass as text, shortened, for messages.
  std::string token() const;

 private:
  bool skip_comment();
  void skip_string();
  void skip_number();

  std::string_view text_;
  std::size_t at_ = 0;
  int line_ = 1, column_ = 1;
};

struct JsonFault {
  Position at;
  std::string message;
};

/// Why a strict parser stopped after what `cursor` has passed. `nested` says that it was inside an object or array.
JsonFault describe_fault(JsonCursor cursor, JsonState state, bool in_object, bool nested, bool out_of_range);

}  // namespace mpm
