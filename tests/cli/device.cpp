// Backend "cuda" as a person meets it: on the host's device, and without any.

#include "cli/program.hpp"

#include "backends/device/drivers/cuda.hpp"
#include "backends/device/drivers/nvrtc.hpp"
#include "support/csv.hpp"

using namespace mpm::test;

namespace {

/// Two steps of a ball, small enough for kernels on the processor.
Json small_ball() {
  Json scene = ball();
  scene["solver"] = {{"time_step", 1e-4}, {"end_time", 1e-3}};
  scene["output"] = {{"metrics_every", 1}};
  return scene;
}

/// Runs the program with its cache in the folder, and with what else the environment has.
Result with_cache(const Folder& folder, const Words& words, Words environment = {}) {
  environment.push_back("MPM_CACHE=" + (folder / "cache").string());
  Process process(folder, program(words), environment);
  return process.finish();
}

/// A library libcuda.so.1 of this text, in a folder of its own.
Words library_of(const Folder& folder, const std::string& text) {
  fs::create_directories(folder / "lib");
  spill(folder / "lib/cuda.cpp", text);
  const std::string command = "c++ -shared -fPIC -o '" + (folder / "lib/libcuda.so.1").string() + "' '" +
                              (folder / "lib/cuda.cpp").string() + "'";
  REQUIRE(std::system(command.c_str()) == 0);
  return {"LD_LIBRARY_PATH=" + (folder / "lib").string()};
}

}  // namespace

TEST_CASE("backend cuda on the host's device gives the numbers of the cpu backend") {
  const Folder folder;
  spill(folder / "scene.json", small_ball().dump());
  REQUIRE(with_cache(folder, {"run", "scene.json", "--out", "cpu"}).code == 0);
  const Result first =
      with_cache(folder, {"run", "scene.json", "--out", "cuda", "--backend", "cuda", "--device", "host"});
  INFO(first.err);
  REQUIRE(first.code == 0);
  CHECK(has(first.err, "compiling the kernels of this scene ("));
  const auto cpu = mpm::support::read_csv(folder / "cpu/metrics.csv");
  const auto cuda = mpm::support::read_csv(folder / "cuda/metrics.csv");
  REQUIRE(cpu.header == cuda.header);
  REQUIRE(cpu.rows() == cuda.rows());
  for (const std::string column : {"time", "kinetic energy", "strain energy", "total energy"}) {
    INFO(column);
    const std::vector<double>&expected = *cpu.find(column), &found = *cuda.find(column);
    const double scale = std::abs(*std::max_element(expected.begin(), expected.end()));
    for (std::size_t row = 0; row < expected.size(); ++row)
      CHECK(std::abs(found[row] - expected[row]) <= 1e-11 * scale);
  }
  CHECK(json_in(folder / "cuda/experiment.json")["backend"] == "cuda");

  // The variable stands for the option, and the program is there already.
  const Result second =
      with_cache(folder, {"run", "scene.json", "--out", "again", "--backend", "cuda"}, {"MPM_DEVICE=host"});
  INFO(second.err);
  CHECK(second.code == 0);
  CHECK(!has(second.err, "compiling"));
  CHECK(slurp(folder / "again/metrics.csv") == slurp(folder / "cuda/metrics.csv"));

  CHECK(has(with_cache(folder, {"cache"}).out, "cache: 1 program, "));
  CHECK(has(with_cache(folder, {"cache", "--clear"}).out, "cache: removed 1 program, "));
  CHECK(has(with_cache(folder, {"cache"}).out, "cache: 0 programs, "));
  CHECK(has(with_cache(folder, {"cache"}, {"MPM_CACHE="}).out, "not kept"));
}

TEST_CASE("float and backend cuda need no device to be checked and planned") {
  const Folder folder;
  spill(folder / "scene.json", small_ball().dump());
  for (const std::string verb : {"check", "plan"}) {
    const Result result = with_cache(folder, {verb, "scene.json", "--backend", "cuda", "--set", "/precision=float"});
    INFO(result.err);
    CHECK(result.code == 0);
    if (verb == "check") CHECK(!fs::exists(folder / "cache"));
  }
}

TEST_CASE("plan shows what a scene takes of a device, or what is missing to know it") {
  const Folder folder;
  spill(folder / "scene.json", small_ball().dump());
  const Result plan = with_cache(folder, {"plan", "scene.json", "--backend", "cuda", "--architecture", "sm_80"});
  INFO(plan.out);
  CHECK(plan.code == 0);
  CHECK(has(plan.out, "On a device: 2-D "));
  CHECK(has(plan.out, " bytes a particle\n"));
  CHECK(has(plan.out, "    stress                              4     32 B   within a step\n"));
  CHECK(has(plan.out, " kernels"));
  const Json json =
      Json::parse(with_cache(folder, {"plan", "scene.json", "--backend", "cuda", "--json"}).out)["device"];
  double bytes = 0;
  for (const Json& field : json["memory"]) bytes += field["body"] == 0 ? field["bytes"].get<double>() : 0;
  CHECK(json["bodies"][0]["bytes_per_particle"] == bytes);
  std::string why;
  if (mpm::device::Nvrtc::find(why)) {
    CHECK(has(plan.out, "compiles them for sm_80 (nothing was run)"));
    CHECK(json["architecture"] == "sm_90");
    CHECK(json["kernels"].size() == json["kernel_count"]);
  } else {
    CHECK(has(plan.out, "what they take is not known: NVRTC was not found"));
    CHECK(has(json["missing"], "install"));
  }
  CHECK(!has(with_cache(folder, {"plan", "scene.json"}).out, "On a device"));
  const Result other = with_cache(folder, {"plan", "scene.json", "--backend", "cuda", "--architecture", "sm_75"});
  CHECK(other.code == 2);
  CHECK(has(other.err, "there are sm_80, sm_90"));
}

TEST_CASE("bench on a device says what it cannot do") {
  const Folder folder;
  const auto refused = [&](const Words& words, int code, const std::string& part) {
    const Result result = with_cache(folder, words);
    INFO(result.err);
    CHECK(result.code == code);
    CHECK(has(result.err, part));
  };
  refused({"bench", "--backend", "cuda", "--device", "host"}, 2, "add --quick, or --predict for the counts");
  refused({"bench", "standard", "--backend", "cuda", "--device", "host"}, 2, "backend cuda has no sections");
  refused({"bench", "--backend", "gpu"}, 2, "--backend");
  std::string why;
  if (!mpm::device::cuda_driver(why)) refused({"bench", "--backend", "cuda"}, 5, "needs NVIDIA's driver");
}

TEST_CASE("5: a device that is not there") {
  const Folder folder;
  spill(folder / "scene.json", small_ball().dump());
  const Words words{"run", "scene.json", "--backend", "cuda"};
  const auto stopped = [&](const Words& environment, const Words& parts) {
    const Result result = with_cache(folder, words, environment);
    INFO(result.err);
    CHECK(result.code == 5);
    for (const std::string& part : parts) {
      INFO(part);
      CHECK(has(result.err, part));
    }
    CHECK(has(result.err, "use --backend cpu, or --device host"));
    CHECK(!fs::exists(folder / "runs"));
  };
  std::string why;
  if (!mpm::device::cuda_driver(why)) stopped({}, {"needs NVIDIA's driver", "libcuda.so.1", "LD_LIBRARY_PATH"});
  stopped(library_of(folder, "extern \"C\" int cuInit(unsigned) { return 0; }"),
          {"has no function cuDriverGetVersion", "install a newer driver"});
  std::string functions =
      "extern \"C\" {\nint cuInit(unsigned) { return 100; }\n"
      "int cuGetErrorName(int, const char** s) { *s = \"CUDA_ERROR_NO_DEVICE\"; return 0; }\n"
      "int cuGetErrorString(int, const char** s) { *s = \"no device\"; return 0; }\n";
#define MPM_STUB(name, parameters) \
  if (!has(functions, "int " #name "(")) functions += "int " #name "() { return 100; }\n";
  MPM_DRIVER_FUNCTIONS(MPM_STUB)
#undef MPM_STUB
  const Words none = library_of(folder, functions + "}");
  stopped(none, {"finds no device", "CUDA_ERROR_NO_DEVICE", "nvidia-smi"});
  const Result list = with_cache(folder, {"list", "--devices"}, none);
  CHECK(list.code == 0);
  CHECK(has(list.out, "no device of CUDA: "));
  CHECK(has(list.out, "host: host, "));
}

TEST_CASE("a word that names no device is refused") {
  const Folder folder;
  spill(folder / "scene.json", small_ball().dump());
  const Result option = with_cache(folder, {"run", "scene.json", "--backend", "cuda", "--device", "gpu"});
  CHECK(option.code == 2);
  CHECK(has(option.err, "--device: expected \"host\" or the number of a device, got \"gpu\""));
  const Result variable = with_cache(folder, {"run", "scene.json", "--backend", "cuda"}, {"MPM_DEVICE=gpu"});
  CHECK(variable.code == 5);
  CHECK(has(variable.err, "MPM_DEVICE: expected \"host\" or the number of a device, got \"gpu\""));
}
