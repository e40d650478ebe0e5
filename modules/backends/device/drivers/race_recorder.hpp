#pragma once
// Finds races on the host: lanes of one phase, or teams of one launch, that meet on one address, of which one writes.
// Nothing orders them on a GPU, unless Team makes all of them as one (Team::add, lower, take_number, look).

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "backends/device/kernels/recording.hpp"

namespace mpm::device {

/// Two accesses to one address that nothing orders.
struct Race {
  struct Access {
    int team = -1, lane = -1;  ///< lane -1: outside of a phase, where all lanes do the same
    int phase = -1;
    bool writes = false, adds = false;
  };
  std::string kernel;  ///< name of the entry, "mpm_scatter"
  int phase = 0;       ///< phase of the kernel in which the second access came, from 0
  Access first, second;
  long argument =
      -1;  ///< byte of the kernel's arguments at which the pointer stands that leads there; -1: shared memory
  std::size_t byte = 0;  ///< distance of the address from that pointer, or from the start of shared memory

  /// "mpm_scatter, phase 2: lane 3 of team 0 writes and lane 4 of team 0 writes what FIELD holds".
  std::string text(const std::string& field) const;
};

/// What the launches of a kernel move between memory and the device: each word once a launch and direction, as if caches
/// held all that a launch uses.
struct Traffic {
  long launches = 0;
  double bytes_read = 0, bytes_written = 0;
  double bytes() const { return bytes_read + bytes_written; }
};

/// The accesses of one launch after the other. Memory is looked at in words of 4 bytes.
class RaceRecorder {
 public:
  /// Begins a launch, whose arguments are `words` with the host's addresses in place of device pointers.
  void begin_launch(const std::string& kernel, const std::vector<std::uint64_t>& words);
  /// The memory that launches share.
  void add_memory(std::uintptr_t address, std::size_t bytes);
  void remove_memory(std::uintptr_t address);

  void begin_team(int team, const void* shared, std::size_t bytes);
  void begin_lane(int lane) { now_.lane = lane; }
  void end_phase() { ++phase_, now_.lane = all_lanes; }
  void access(const void* at, std::size_t bytes, bool writes, bool adds);

  /// One race for each kernel, phase and pointer, the first that came.
  const std::vector<Race>& races() const { return races_; }
  /// The number of accesses to memory that launches share, of all launches.
  long accesses() const { return accesses_; }
  /// By the name of the entry.
  const std::map<std::string, Traffic>& traffic() const { return traffic_; }
  void forget_traffic() { traffic_.clear(); }

 private:
  static constexpr int all_lanes = -1;
  using Access = Race::Access;
  /// Who has been at a word in this launch: of reads, writes and additions the last one, the last one of another lane
  /// before it in the same team, and the last one of another team.
  struct Word {
    Access last[3], other_lane[3], other_team[3];
    std::uint32_t round = 0;
    bool read = false, written = false;  ///< by this launch; what it wrote first need not be read
  };
  struct Region {
    std::uintptr_t begin = 0;
    std::size_t bytes = 0;
    std::uint32_t round = 0;  ///< of launches, of shared memory of teams; words of another one are as new
    std::vector<Word> words;
  };

  Region* region_of(std::uintptr_t address);
  void count(Word& seen, bool writes, bool adds);
  void note(Region& region, std::size_t word, bool writes, bool adds);
  bool unordered(const Access& before) const;
  void report(const Region& region, std::size_t word, const Access& before);

  std::string kernel_;
  std::vector<std::uint64_t> arguments_;
  std::map<std::uintptr_t, Region> regions_;
  Region shared_;
  Region* last_region_ = nullptr;
  Access now_;
  int phase_ = 0;
  long accesses_ = 0;
  std::map<std::string, Traffic> traffic_;
  Traffic* of_kernel_ = nullptr;
  std::vector<Race> races_;
};

/// The table that a checking program calls; what it is told goes to the recorder that records on this thread.
AccessRecorder* access_recorder();

/// Lets a recorder take what kernels on this thread access, as long as it lives.
class Recording {
 public:
  /// Begins a launch; null for a device that does not record.
  Recording(RaceRecorder* recorder, const std::string& kernel, const std::vector<std::uint64_t>& words);
  ~Recording();
  Recording(const Recording&) = delete;
  Recording& operator=(const Recording&) = delete;
};

}  // namespace mpm::device
