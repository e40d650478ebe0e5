#include "experiment/json_cursor.hpp"

namespace mpm {
namespace {

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}
bool is_digit(char c) {
  return c >= '0' && c <= '9';
}
bool ends_word(char c) {
  return is_blank(c) || c == ',' || c == ':' || c == '{' || c == '}' || c == '[' || c == ']' || c == '"' || c == '/';
}

/// Says why a string, number or word that stands where a value may stand was refused.
std::string malformed(const JsonCursor& cursor, bool out_of_range) {
  const char first = cursor.peek();
  if (out_of_range) return "the number " + cursor.token() + " is too large for double precision";
  if (first == '"') {
    JsonCursor end = cursor;
    end.skip_token();
    const bool closed = end.position().line == cursor.position().line && !(end.at_end() && end.token() != "\"");
    return closed ? "a string here is not closed, or holds an invalid escape or byte"
                  : "a string that starts here is not closed on its line";
  }
  if (first == '\'') return "strings stand in double quotes, not single ones";
  if (first == '-' || first == '+' || first == '.' || is_digit(first)) {
    return cursor.token() + " is not a number that JSON allows (write 0.5, -1, 2e-3)";
  }
  return {};
}

std::string found(const JsonCursor& cursor) {
  return cursor.at_end() ? "the file ends" : "found " + cursor.token();
}

std::string expected_value(const JsonCursor& cursor, const char* expected, bool out_of_range) {
  const std::string reason = malformed(cursor, out_of_range);
  return reason.empty() ? std::string("expected ") + expected + ", " + found(cursor) : reason;
}

std::string expected_key(const JsonCursor& cursor, const char* expected) {
  if (cursor.peek() == '"') return malformed(cursor, false);
  return std::string("expected ") + expected + ", " + found(cursor);
}

}  // namespace

void JsonCursor::advance() {
  if (at_end()) return;
  const char c = text_[at_++];
  if (c == '\n') {
    ++line_;
    column_ = 1;
  } else if (at_ >= text_.size() || (static_cast<unsigned char>(text_[at_]) & 0xC0) != 0x80) {
    ++column_;  // the next byte starts a new character, not the rest of a UTF-8 sequence
  }
}

bool JsonCursor::skip_comment() {
  const JsonCursor start = *this;
  advance();
  if (peek() == '/') {
    while (!at_end() && peek() != '\n' && peek() != '\r') advance();
    return true;
  }
  if (peek() == '*') {
    advance();
    for (; !at_end(); advance()) {
      if (peek() == '*' && peek(1) == '/') {
        advance();
        advance();
        return true;
      }
    }
  }
  *this = start;
  return false;
}

bool JsonCursor::skip_blank() {
  while (!at_end()) {
    if (peek() == '/') {
      if (!skip_comment()) return false;
    } else if (is_blank(peek())) {
      advance();
    } else {
      return true;
    }
  }
  return true;
}

void JsonCursor::skip_separators() {
  while (skip_blank() && (peek() == ',' || peek() == ':')) advance();
}

void JsonCursor::skip_string() {
  advance();
  for (; !at_end() && peek() != '"' && peek() != '\n'; advance()) {
    if (peek() == '\\' && peek(1) != '\n') advance();
  }
  advance();
}

void JsonCursor::skip_number() {
  const auto digits = [this] {
    while (is_digit(peek())) advance();
  };
  if (peek() == '-') advance();
  if (peek() == '0') {
    advance();  // nothing may follow a leading zero but a fraction or power
  } else {
    digits();
  }
  if (peek() == '.' && is_digit(peek(1))) {
    advance();
    digits();
  }
  const bool has_sign = peek(1) == '-' || peek(1) == '+';
  if ((peek() == 'e' || peek() == 'E') && is_digit(peek(has_sign ? 2 : 1))) {
    advance();
    if (has_sign) advance();
    digits();
  }
}

void JsonCursor::skip_token() {
  const char first = peek();
  if (first == '"') return skip_string();
  if (first == '-' || is_digit(first)) return skip_number();
  const int length = first == 'f' ? 5 : first == 't' || first == 'n' ? 4 : 1;  // false, true, null, or a bracket
  for (int i = 0; i < length; ++i) advance();
}

void JsonCursor::skip_word() {
  if (peek() == '"') return skip_string();
  const bool alone = ends_word(peek());
  advance();
  while (!alone && !at_end() && !ends_word(peek())) advance();
}

std::string JsonCursor::token() const {
  JsonCursor end = *this;
  end.skip_word();
  std::string word(text_.substr(at_, end.at_ - at_));
  while (!word.empty() && is_blank(word.back())) word.pop_back();
  if (!word.empty() && word.front() == '"') return word.size() > 40 ? word.substr(0, 40) + "…" : word;
  if (word.size() > 40) word = word.substr(0, 40) + "…";
  for (const char c : word) {
    if (static_cast<unsigned char>(c) < 0x20) return "a control character";
  }
  return "'" + word + "'";
}

JsonFault describe_fault(JsonCursor cursor, JsonState state, bool in_object, bool nested, bool out_of_range) {
  const auto fault = [&](std::string message) { return JsonFault{cursor.position(), std::move(message)}; };
  const auto bad_comment = [&] {
    return fault(cursor.peek(1) == '*' ? "a comment that starts here is not closed by */"
                                       : "expected a comment, // or /* */, after '/'");
  };
  if (!cursor.skip_blank()) return bad_comment();
  const bool key_wanted = in_object && state == JsonState::after_open;
  if (key_wanted) return fault(expected_key(cursor, "a key in double quotes or '}'"));
  if (state == JsonState::after_open) return fault(expected_value(cursor, "a value or ']'", out_of_range));
  if (state == JsonState::start) return fault(expected_value(cursor, "an object in { }", out_of_range));

  const char separator = state == JsonState::after_key ? ':' : ',';
  if (!nested) return fault("expected the end of the file after the closing '}', " + found(cursor));
  if (cursor.peek() != separator) {
    if (state == JsonState::after_key) return fault("expected ':' after the key, " + found(cursor));
    return fault(std::string("expected ',' or ") + (in_object ? "'}'" : "']'") + ", " + found(cursor));
  }
  cursor.advance();
  if (!cursor.skip_blank()) return bad_comment();
  if (state == JsonState::after_value && (cursor.peek() == '}' || cursor.peek() == ']')) {
    return fault(std::string("a comma before '") + cursor.peek() + "' is not allowed; remove it");
  }
  if (state == JsonState::after_value && in_object) return fault(expected_key(cursor, "a key in double quotes"));
  return fault(expected_value(cursor, "a value", out_of_range));
}

}  // namespace mpm
