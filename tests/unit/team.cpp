// The threads that share loops: everything is done once, by whoever is there; who waits sleeps.
#include "support/team.hpp"

#include <pthread.h>
#include <signal.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <stdexcept>

#include "support/catch.hpp"

using namespace mpm;
using namespace mpm::support;
using namespace std::chrono_literals;

namespace {

/// Sets the wait policy of the environment for a while.
class Policy {
 public:
  explicit Policy(const char* value) {
    if (const char* before = std::getenv(name)) before_ = before;
    value ? ::setenv(name, value, 1) : ::unsetenv(name);
  }
  ~Policy() { before_.empty() ? ::unsetenv(name) : ::setenv(name, before_.c_str(), 1); }

 private:
  static constexpr const char* name = "OMP_WAIT_POLICY";
  std::string before_;
};

/// Calls part(thread) on every thread of the team, however late they come.
template <class Part>
void on_all(Team& team, Part&& part) {
  std::atomic<int> came{0};
  team.share([&](int thread) {
    ++came;
    while (came < team.size()) std::this_thread::yield();
    part(thread);
  });
}

double processor_seconds(pthread_t thread) {
  clockid_t clock{};
  timespec time{};
  REQUIRE(::pthread_getcpuclockid(thread, &clock) == 0);
  REQUIRE(::clock_gettime(clock, &time) == 0);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// A signal holds the thread that receives it until a byte comes through a pipe: as if it were given no processor.
std::atomic<bool> held{false};
int gate[2];
void hold(int) {
  held = true;
  char byte;
  while (::read(gate[0], &byte, 1) < 0) {
  }
}

class Held {
 public:
  explicit Held(pthread_t thread) {
    REQUIRE(::pipe(gate) == 0);
    held = false;
    struct sigaction action {};
    action.sa_handler = hold;
    REQUIRE(::sigaction(SIGUSR1, &action, &before_) == 0);
    REQUIRE(::pthread_kill(thread, SIGUSR1) == 0);
    while (!held) std::this_thread::yield();
  }
  ~Held() {
    const char byte = 0;
    if (::write(gate[1], &byte, 1) != 1) std::abort();
    // The pipe and the handler are kept until the end: nothing tells when the thread has left them.
  }

 private:
  struct sigaction before_ {};
};

}  // namespace

TEST_CASE("a loop visits each index once, with any number of threads") {
  for (const int threads : {1, 2, 3, 8, 64}) {
    Team team(threads);
    REQUIRE(team.size() == threads);
    for (const std::size_t count : {0, 1, 2, 7, 64, 65, 1000})
      for (const std::size_t grain : {1, 4, 8, 2000}) {
        CAPTURE(threads, count, grain);
        std::vector<std::atomic<int>> visits(count), even_visits(count);
        std::atomic<int> highest{0}, lowest{0};
        team.for_each(count, grain, [&](std::size_t i, int thread) {
          ++visits[i];
          if (thread < 0) lowest = thread;
          if (thread >= threads) highest = thread;
        });
        team.for_each(count, [&](std::size_t i) { ++even_visits[i]; });
        const auto once = [](const std::atomic<int>& value) { return value == 1; };
        CHECK(std::all_of(visits.begin(), visits.end(), once));
        CHECK(std::all_of(even_visits.begin(), even_visits.end(), once));
        CHECK(lowest == 0);
        CHECK(highest == 0);
        CHECK(team.largest<double>(count, [](std::size_t i) { return i == 5 ? 1e6 : double(i) - 10; }) ==
              (count > 5 ? 1e6 : 0));
      }
  }
}

TEST_CASE("all threads of a team come where they can, call after call") {
  Team team(4);
  for (int call = 0; call < 200; ++call) {
    std::vector<int> calls(4, 0);
    on_all(team, [&](int thread) { ++calls[static_cast<std::size_t>(thread)]; });
    CHECK(calls == std::vector<int>(4, 1));
    if (call % 50 == 0) std::this_thread::sleep_for(2ms);  // the workers sleep meanwhile
  }
}

TEST_CASE("only as many threads take part as are to be used") {
  Team team(4);
  for (const int used : {2, 4, 1, 3, 0, 9}) {
    team.use(used, used != 3);
    const int expected = std::clamp(used, 1, 4);
    CAPTURE(used);
    REQUIRE(team.used() == expected);
    CHECK((team.spin() == 0us) == (used == 3 || longest_spin() == 0us));
    for (int call = 0; call < 20; ++call) {
      std::vector<std::atomic<int>> calls(4);
      std::atomic<int> came{0};
      team.share([&](int thread) {
        ++calls[static_cast<std::size_t>(thread)], ++came;
        while (came < expected) std::this_thread::yield();
      });
      for (int thread = 0; thread < 4; ++thread) CHECK(calls[static_cast<std::size_t>(thread)] == (thread < expected));
      std::vector<std::atomic<int>> visits(100);
      team.for_each(visits.size(), 3, [&](std::size_t i, int thread) { visits[i] += thread < expected ? 1 : 100; });
      CHECK(std::all_of(visits.begin(), visits.end(), [](const auto& v) { return v == 1; }));
    }
  }
}

TEST_CASE("no loop waits for a thread that is given no processor") {
  static Team team(3);  // the team outlives the handler of the signal
  std::vector<pthread_t> identities(3);
  on_all(team, [&](int thread) { identities[static_cast<std::size_t>(thread)] = ::pthread_self(); });
  {
    const Held one(identities[1]);
    std::vector<std::atomic<int>> visits(1000);
    std::atomic<int> by_the_held{0};
    for (int loop = 0; loop < 100; ++loop)
      team.for_each(visits.size(), 8, [&](std::size_t i, int thread) { ++visits[i], by_the_held += thread == 1; });
    CHECK(std::all_of(visits.begin(), visits.end(), [](const auto& v) { return v == 100; }));
    CHECK(by_the_held == 0);
  }
  std::atomic<bool> back{false};
  on_all(team, [&](int thread) {
    if (thread == 1) back = true;
  });
  CHECK(back);
}

TEST_CASE("who waits for work or for others sleeps after a short while") {
  const Policy none(nullptr);
  CHECK(longest_spin() >= 1us);
  CHECK(longest_spin() <= 1ms);
  Team team(2);
  pthread_t worker{};
  on_all(team, [&](int thread) {
    if (thread == 1) worker = ::pthread_self();
  });
  // Times of the processor, which do not grow where others use it.
  double before = processor_seconds(worker);
  std::this_thread::sleep_for(400ms);
  CHECK((processor_seconds(worker) - before < 0.1));
  before = processor_seconds(::pthread_self());
  on_all(team, [&](int thread) {
    if (thread == 0)
      before = processor_seconds(::pthread_self());
    else
      std::this_thread::sleep_for(400ms);
  });
  CHECK((processor_seconds(::pthread_self()) - before < 0.1));
}

TEST_CASE("the wait policy of the environment is heeded") {
  for (const char* passive : {"passive", "PASSIVE"}) {
    const Policy policy(passive);
    CHECK(longest_spin() == 0us);
    Team team(3);
    int sum = 0;
    std::mutex mutex;
    for (int call = 0; call < 100; ++call)
      team.for_each(10, 1, [&](std::size_t i, int) {
        const std::lock_guard lock(mutex);
        sum += static_cast<int>(i);
      });
    CHECK(sum == 4500);
  }
  const Policy policy("active");
  CHECK(longest_spin() > 1h);
}

TEST_CASE("an exception of a thread is the caller's, and the team goes on") {
  Team team(3);
  for (int call = 0; call < 20; ++call) {
    CHECK_THROWS_AS(team.for_each(100, 1,
                                  [&](std::size_t i, int) {
                                    if (i == 77) throw std::runtime_error("77");
                                  }),
                    std::runtime_error);
    std::atomic<int> sum{0};
    team.for_each(100, 1, [&](std::size_t, int) { ++sum; });
    CHECK(sum == 100);
  }
}
