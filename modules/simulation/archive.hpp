#pragma once
// A flat run of bytes that a simulation is written to and read back from, bit for bit. Every value carries a tag, so
// that a reader that has lost its place says so instead of taking garbage for numbers.

#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace mpm {

/// Thrown when the bytes are not those that the reader expects: another version, another experiment, or damage.
class ArchiveError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class ArchiveWriter {
 public:
  template <class T>
  requires std::is_trivially_copyable_v<T>
  void put(std::string_view tag, const T& value) { put_bytes(tag, &value, sizeof(T), 1); }
  template <class T>
  requires std::is_trivially_copyable_v<T>
  void put(std::string_view tag, const T* values, std::size_t count) { put_bytes(tag, values, sizeof(T), count); }
  template <class T>
  void put(std::string_view tag, const std::vector<T>& values) {
    put(tag, values.data(), values.size());
  }
  void put(std::string_view tag, const std::string& text) { put(tag, text.data(), text.size()); }

  const std::vector<char>& bytes() const { return bytes_; }

 private:
  // This is not inlined, as g++ 12 warns of writes beyond the end of a vector whose growth it has lost track of.
  [[gnu::noinline]] void put_bytes(std::string_view tag, const void* data, std::size_t size, std::size_t count) {
    const std::uint64_t head[3] = {tag.size(), size, count};
    append(head, sizeof head);
    append(tag.data(), tag.size());
    append(data, size * count);
  }
  void append(const void* data, std::size_t size) {
    const char* const first = static_cast<const char*>(data);
    bytes_.insert(bytes_.end(), first, first + size);
  }
  std::vector<char> bytes_;
};

class ArchiveReader {
 public:
  explicit ArchiveReader(std::span<const char> bytes) : bytes_(bytes) {}

  /// Reads what was put. All overloads throw ArchiveError when the next value has another tag, size or count.
  template <class T>
  requires std::is_trivially_copyable_v<T>
  void get(std::string_view tag, T& value) {
    if (get_head(tag, sizeof(T)) != 1) fail(tag, "is not a single value");
    take(&value, sizeof(T));
  }
  template <class T>
  requires std::is_trivially_copyable_v<T>
  void get(std::string_view tag, T* values, std::size_t count) {
    if (get_head(tag, sizeof(T)) != count) fail(tag, "has another length");
    take(values, count * sizeof(T));
  }
  template <class T>
  void get(std::string_view tag, std::vector<T>& values) {
    const std::size_t count = get_head(tag, sizeof(T));
    values.resize(count);
    take(values.data(), count * sizeof(T));
  }
  void get(std::string_view tag, std::string& text) {
    const std::size_t count = get_head(tag, 1);
    text.resize(count);
    take(text.data(), count);
  }
  bool at_end() const { return bytes_.empty(); }

 private:
  [[noreturn]] static void fail(std::string_view tag, const char* what) {
    throw ArchiveError("value \"" + std::string(tag) + "\" " + what);
  }
  std::size_t get_head(std::string_view tag, std::size_t size) {
    std::uint64_t head[3];
    take(head, sizeof head);
    if (head[0] != tag.size() || head[0] > bytes_.size() || std::memcmp(bytes_.data(), tag.data(), tag.size()) != 0)
      fail(tag, "is not what comes next");
    bytes_ = bytes_.subspan(tag.size());
    if (head[1] != size) fail(tag, "has another type");
    if (head[2] > bytes_.size() / (size ? size : 1)) fail(tag, "is cut short");
    return static_cast<std::size_t>(head[2]);
  }
  void take(void* to, std::size_t size) {
    if (size > bytes_.size()) throw ArchiveError("the bytes end too early");
    if (size) std::memcpy(to, bytes_.data(), size);
    bytes_ = bytes_.subspan(size);
  }
  std::span<const char> bytes_;
};

}  // namespace mpm
