#include "output/checkpoint_file.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstring>

#include "support/files.hpp"
#include "support/hash.hpp"

namespace mpm::output {
namespace {

namespace fs = std::filesystem;

constexpr std::array<char, 16> magic{'M', 'P', 'M', ' ', 'c', 'h', 'e',  'c',
                                     'k', 'p', 'o', 'i', 'n', 't', '\n', '\x1a'};
constexpr std::uint32_t format_version = 1, order_of_bytes = 0x01020304;
constexpr std::size_t digest_digits = 64;

struct Header {
  std::array<char, 16> magic;
  std::uint32_t format, order;
  std::uint64_t identity_bytes, state_bytes;
};
static_assert(sizeof(Header) == 40, "written as it lies in memory");

std::string_view bytes_of(const Header& header) {
  return {reinterpret_cast<const char*>(&header), sizeof header};
}

}  // namespace

void write_checkpoint(const fs::path& path, const nlohmann::ordered_json& identity, std::string_view state) {
  const std::string text = identity.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
  const Header header{magic, format_version, order_of_bytes, text.size(), state.size()};
  const std::string digest = support::sha256({bytes_of(header), text, state});
  support::write_atomically(path, {bytes_of(header), digest, text, state});
}

CheckpointFile read_checkpoint(const fs::path& path) {
  const std::string bytes = support::read_file(path);
  const auto refuse = [&](const std::string& reason) { throw CheckpointDamaged(path, reason); };
  const std::size_t shared = std::min(bytes.size(), magic.size());
  if (!std::equal(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(shared), magic.begin()))
    refuse("is not a checkpoint of this program");
  constexpr std::size_t head = sizeof(Header) + digest_digits;
  if (bytes.size() < head) refuse("is cut short: " + std::to_string(bytes.size()) + " bytes");
  Header header;
  std::memcpy(&header, bytes.data(), sizeof header);
  if (header.order != order_of_bytes) refuse("was written on a machine with another order of bytes, or is damaged");
  if (header.format != format_version)
    refuse("has format " + std::to_string(header.format) + "; this program reads format " +
           std::to_string(format_version));
  const std::uint64_t body = bytes.size() - head;
  if (header.identity_bytes > body || header.state_bytes != body - header.identity_bytes)
    refuse("is cut short or damaged: its length is not the one it names");
  const std::string_view all(bytes);
  const std::string_view text = all.substr(head, header.identity_bytes), state = all.substr(head + text.size());
  if (all.substr(sizeof header, digest_digits) != support::sha256({bytes_of(header), text, state}))
    refuse("is damaged: its content does not match its SHA-256");
  CheckpointFile file{nlohmann::ordered_json::parse(text, nullptr, false), std::string(state)};
  if (!file.identity.is_object()) refuse("does not say what it belongs to");
  return file;
}

std::string checkpoint_name(long step) {
  char name[64];
  std::snprintf(name, sizeof name, "step_%012ld.checkpoint", step);
  return name;
}

std::vector<fs::path> checkpoints_in(const fs::path& folder) {
  std::vector<fs::path> paths;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("step_") && name.ends_with(".checkpoint")) paths.push_back(entry.path());
  }
  // Names that are longer are of later steps, should twelve digits not do.
  std::sort(paths.begin(), paths.end(), [](const fs::path& a, const fs::path& b) {
    const std::string first = a.filename().string(), second = b.filename().string();
    return first.size() != second.size() ? first.size() > second.size() : first > second;
  });
  return paths;
}

}  // namespace mpm::output
