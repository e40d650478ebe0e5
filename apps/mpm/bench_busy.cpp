// Section `busy`: what other programs leave of the speed. Loops keep 0 to all processors busy while the same scene runs
// on several numbers of threads and on the number that is found, in turns; that must come near the best of them.

#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <set>

#include "backends/make_backend.hpp"
#include "mpm/bench_sections.hpp"
#include "support/files.hpp"

namespace mpm::app {
namespace {

/// Processes that each keep a processor busy, as far as the system gives them one.
class BusyLoops {
 public:
  explicit BusyLoops(int count) {
    for (int k = 0; k < count; ++k) {
      const pid_t id = ::fork();
      if (id < 0) throw support::MachineError::from_errno("start a process for", "a busy loop", errno);
      if (id == 0) spin();
      loops_.push_back(id);
    }
  }
  ~BusyLoops() {
    for (const pid_t id : loops_) ::kill(id, SIGKILL);
    for (const pid_t id : loops_) ::waitpid(id, nullptr, 0);
  }
  BusyLoops(const BusyLoops&) = delete;
  BusyLoops& operator=(const BusyLoops&) = delete;

 private:
  [[noreturn]] static void spin() {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    for (volatile bool on = true; on;) {
    }
    ::_exit(0);
  }

  std::vector<pid_t> loops_;
};

/// Numbers of threads to compare with the one that is found: powers of two, the processors left over, and all.
std::vector<int> numbers_of_threads(int all, int busy) {
  std::set<int> numbers{all};
  for (int threads = 1; threads < all; threads *= 2) numbers.insert(threads);
  if (busy > 0 && busy < all) numbers.insert(all - busy);
  return {numbers.begin(), numbers.end()};
}

struct BusyScene {
  std::string name;
  const BenchSuite& suite;
};

void measure(BenchContext& context, const BusyScene& scene, int busy, bench::SectionResult& result) {
  context.say("busy: " + scene.name + " beside " + std::to_string(busy));
  const BusyLoops loops(busy);
  const auto experiment = [&] { return scene.suite.experiment(scene.suite.scene("cube_3d"), "deforming", {}); };
  std::vector<std::unique_ptr<Product>> products;
  for (const int threads : numbers_of_threads(context.threads, busy))
    products.push_back(std::make_unique<Product>(experiment(), threads));
  products.push_back(std::make_unique<Product>(experiment(), context.threads, backend_factory(context.threads, true)));
  std::vector<bench::Contender*> contenders;
  for (const auto& product : products) contenders.push_back(product.get());
  // The machine is busy on purpose: the shares of its time that contenders are given say nothing.
  const bench::Rates rates = bench::run_in_turns(contenders, context.protocol);
  const std::size_t found = products.size() - 1;
  std::size_t best = 0;
  for (std::size_t c = 1; c < found; ++c)
    if (rates.rate(c) > rates.rate(best)) best = c;
  for (std::size_t c = 0; c < products.size(); ++c)
    result.tables[0].rows.push_back({scene.name, static_cast<double>(busy),
                                     c == found ? std::string("default") : std::to_string(products[c]->threads()),
                                     rates.rate(c) / 1e6, 100 * rates.spread(c), rates.ratio(c, best)});
  result.targets.push_back({"busy_" + scene.name + "_" + std::to_string(busy),
                            scene.name + " beside " + std::to_string(busy) + " busy loops: default over the best",
                            rates.ratio(found, best), 0.8, true});
}

}  // namespace

bench::SectionResult bench_busy(BenchContext& context) {
  bench::SectionResult result{"busy",
                              {{"busy",
                                "Beside programs that keep processors busy (cube deforming, float)",
                                {{"scene", "scene"},
                                 {"busy", "busy loops"},
                                 {"threads", "threads"},
                                 {"rate", "rate (M/s)"},
                                 {"spread", "spread (%)"},
                                 {"over_best", "over the best"}},
                                {},
                                "small: 1/64 of the particles. default: the number of threads is found while it runs; "
                                "the best is one of the others."}},
                              {}};
  const BenchSuite small(context.suite.registry(), true);
  std::vector<BusyScene> scenes{{"small", small}};
  if (!context.options.quick) scenes.push_back({"cube_3d", context.suite});
  for (const BusyScene& scene : scenes)
    for (const int busy : std::set<int>{0, 1, context.threads / 2, context.threads})
      measure(context, scene, busy, result);
  return result;
}

}  // namespace mpm::app
