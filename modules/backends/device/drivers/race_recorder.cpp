#include "backends/device/drivers/race_recorder.hpp"

#include <algorithm>

namespace mpm::device {
namespace {

constexpr std::size_t word_bytes = 4;

std::size_t words_in(std::size_t bytes) {
  return (bytes + word_bytes - 1) / word_bytes;
}

std::string in_words(const Race::Access& access) {
  return (access.lane < 0 ? "every lane" : "lane " + std::to_string(access.lane)) + " of team " +
         std::to_string(access.team) +
         (access.adds     ? " adds to"
          : access.writes ? " writes"
                          : " reads");
}

thread_local RaceRecorder* recording = nullptr;

int kind_of(bool writes, bool adds) {
  return adds ? 2 : writes ? 1 : 0;
}

}  // namespace

std::string Race::text(const std::string& field) const {
  return kernel + ", phase " + std::to_string(phase) + ": " + in_words(first) + " and " + in_words(second) + " " +
         field + ", byte " + std::to_string(byte);
}

void RaceRecorder::begin_launch(const std::string& kernel, const std::vector<std::uint64_t>& words) {
  kernel_ = kernel, arguments_ = words;
  of_kernel_ = &traffic_[kernel];
  ++of_kernel_->launches;
  for (auto& [address, region] : regions_) ++region.round;
}

void RaceRecorder::add_memory(std::uintptr_t address, std::size_t bytes) {
  regions_[address] = {address, bytes, 0, std::vector<Word>(words_in(bytes))};
}
void RaceRecorder::remove_memory(std::uintptr_t address) {
  last_region_ = nullptr;
  regions_.erase(address);
}

void RaceRecorder::begin_team(int team, const void* shared, std::size_t bytes) {
  now_ = {team};
  phase_ = 0;
  shared_.begin = reinterpret_cast<std::uintptr_t>(shared), shared_.bytes = bytes;
  shared_.words.resize(words_in(bytes));
  ++shared_.round;
}

RaceRecorder::Region* RaceRecorder::region_of(std::uintptr_t address) {
  const auto holds = [&](const Region* region) {
    return region && address >= region->begin && address - region->begin < region->bytes;
  };
  if (holds(&shared_)) return &shared_;
  if (holds(last_region_)) return last_region_;
  auto found = regions_.upper_bound(address);
  if (found == regions_.begin()) return nullptr;
  --found;
  if (!holds(&found->second)) return nullptr;
  return last_region_ = &found->second;
}

void RaceRecorder::access(const void* at, std::size_t bytes, bool writes, bool adds) {
  if (now_.lane == all_lanes && !writes) return;
  const auto address = reinterpret_cast<std::uintptr_t>(at);
  Region* const region = region_of(address);
  if (!region) return;  // the kernel's own variables
  ++accesses_;
  const std::size_t first = (address - region->begin) / word_bytes,
                    last = std::min((address - region->begin + bytes - 1) / word_bytes, region->words.size() - 1);
  for (std::size_t word = first; word <= last; ++word) note(*region, word, writes, adds);
}

void RaceRecorder::count(Word& seen, bool writes, bool adds) {
  if ((!writes || adds) && !seen.read && !seen.written) seen.read = true, of_kernel_->bytes_read += word_bytes;
  if (writes && !seen.written) seen.written = true, of_kernel_->bytes_written += word_bytes;
}

void RaceRecorder::note(Region& region, std::size_t word, bool writes, bool adds) {
  Word& seen = region.words[word];
  if (seen.round != region.round) seen = {}, seen.round = region.round;
  if (&region != &shared_) count(seen, writes, adds);
  now_.writes = writes, now_.adds = adds, now_.phase = phase_;
  if (now_.lane == all_lanes) return report(region, word, now_);
  const int kind = kind_of(writes, adds);
  for (int before = 0; before < 3; ++before) {
    const bool both_read = before == 0 && kind == 0, both_add = before == 2 && kind == 2;
    if (both_read || both_add) continue;
    for (const Access* access : {&seen.last[before], &seen.other_lane[before], &seen.other_team[before]})
      if (unordered(*access)) report(region, word, *access);
  }
  Access& last = seen.last[kind];
  if (last.team >= 0 && last.team != now_.team)
    seen.other_team[kind] = last, seen.other_lane[kind] = {};
  else if (last.team >= 0 && last.lane != now_.lane)
    seen.other_lane[kind] = last;
  last = now_;
}

/// Whether nothing orders an access before the one of now: a barrier ends each phase, but for its own team alone.
bool RaceRecorder::unordered(const Access& before) const {
  if (before.team < 0) return false;
  return before.team != now_.team || (before.phase == now_.phase && before.lane != now_.lane);
}

void RaceRecorder::report(const Region& region, std::size_t word, const Access& before) {
  Race race{kernel_, phase_, before, now_, -1, word * word_bytes};
  if (&region != &shared_) {
    const std::uintptr_t address = region.begin + word * word_bytes;
    std::uint64_t nearest = 0;
    for (std::size_t k = 0; k < arguments_.size(); ++k)
      if (arguments_[k] >= region.begin && arguments_[k] <= address && arguments_[k] >= nearest) {
        nearest = arguments_[k];
        race.argument = static_cast<long>(k * sizeof(std::uint64_t)), race.byte = address - nearest;
      }
  }
  const bool known = std::any_of(races_.begin(), races_.end(), [&](const Race& other) {
    return other.kernel == race.kernel && other.phase == race.phase && other.argument == race.argument;
  });
  if (!known) races_.push_back(race);
}

AccessRecorder* access_recorder() {
  static AccessRecorder table{[](int team, const void* shared, unsigned long bytes) {
                                if (recording) recording->begin_team(team, shared, bytes);
                              },
                              [](int lane) {
                                if (recording) recording->begin_lane(lane);
                              },
                              [] {
                                if (recording) recording->end_phase();
                              },
                              [](const void* at, unsigned long bytes, bool writes, bool adds) {
                                if (recording) recording->access(at, bytes, writes, adds);
                              }};
  return &table;
}

Recording::Recording(RaceRecorder* recorder, const std::string& kernel, const std::vector<std::uint64_t>& words) {
  recording = recorder;
  if (recorder) recorder->begin_launch(kernel, words);
}
Recording::~Recording() {
  recording = nullptr;
}

}  // namespace mpm::device
