#include "backends/device/drivers/host_driver.hpp"

#include <dlfcn.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <new>
#include <stdexcept>

#include "backends/device/drivers/host_graph.hpp"
#include "backends/device/drivers/host_library.hpp"
#include "backends/device/drivers/host_results.hpp"

namespace mpm::device {

struct OpaqueStream {
  HostOperations waiting;
  HostCapture capture;
};

struct OpaqueEvent {
  bool recorded = false, reached = false;
  std::chrono::steady_clock::time_point when;
};

struct OpaqueFunction {
  using Entry = void (*)(const void* arguments, int teams, int lanes, unsigned order);
  std::string name;
  Entry entry;
};

struct OpaqueModule {
  void* library;
  std::map<std::string, OpaqueFunction> functions;
  ~OpaqueModule() { dlclose(library); }
};

constexpr std::align_val_t line{256};  // what CUDA aligns memory to

struct FreeMemory {
  void operator()(unsigned char* memory) const { ::operator delete(memory, line); }
};
struct Allocation {
  std::unique_ptr<unsigned char, FreeMemory> memory;
  std::size_t bytes;
};

struct OpaqueContext {
  HostDevice device;
  int users = 0;
  std::uint64_t bytes = 0;
  std::map<std::uintptr_t, Allocation> allocations;  ///< by host address
  std::map<StreamHandle, std::unique_ptr<OpaqueStream>> streams;
  std::shared_ptr<RaceRecorder> recorder;  ///< null where the device records no accesses
  DriverResult lost = driver_success;      ///< what every call returns from now on
};

namespace {

// ---- the state of the process --------------------------------------------------------------------------------------

struct Failure {
  std::string function;
  long call;
  DriverResult result;
};

struct Host {
  std::mutex mutex;  ///< guards all of this and of the contexts; kernels run outside it
  std::vector<HostDevice> devices{HostDevice{}};
  std::map<int, std::unique_ptr<OpaqueContext>> contexts;  ///< of the devices in use
  std::map<int, std::shared_ptr<RaceRecorder>> recorders;  ///< of the devices that record, since they were set
  std::map<std::string, long> calls;
  std::uint64_t copied = 0;  ///< bytes, both ways
  std::uint64_t left = 0;    ///< bytes that nobody freed before the last user of a device left
  std::vector<Failure> failures;
};

Host& host() {
  static Host* const state = new Host;  // outlives whatever static objects still hold a device when the process ends
  return *state;
}
thread_local ContextHandle current = nullptr;

bool loses_the_device(DriverResult result) {
  // Those of which cuda.h says that they leave the process in a state in which no work of CUDA goes on.
  constexpr DriverResult final_ones[] = {driver_illegal_address,   702 /* time */,        710 /* assertion */,
                                         714 /* stack */,          715 /* instruction */, 716 /* alignment */,
                                         717 /* address space */,  718 /* counter */,     driver_launch_failed,
                                         driver_device_unavailable};
  return std::find(std::begin(final_ones), std::end(final_ones), result) != std::end(final_ones);
}

/// Counts a call, and lets it fail where a test wants that or the device is lost. Call it with the state locked.
DriverResult begin(const char* function) {
  Host& state = host();
  const bool alive = std::any_of(state.contexts.begin(), state.contexts.end(),
                                 [](const auto& context) { return context.second.get() == current; });
  if (!alive) current = nullptr;  // somebody has given the device back
  ++state.calls[function];
  DriverResult result = driver_success;
  for (Failure& failure : state.failures)
    if (failure.function == function && --failure.call == 0) result = failure.result;
  std::erase_if(state.failures, [](const Failure& failure) { return failure.call <= 0; });
  if (current && current->lost) return current->lost;
  if (current && loses_the_device(result)) current->lost = result;
  return result;
}

/// Begins a function that needs a context.
#define MPM_BEGIN(function)            \
  std::unique_lock lock(host().mutex); \
  if (const DriverResult failed = begin(#function)) return failed;
#define MPM_BEGIN_IN_CONTEXT(function) \
  MPM_BEGIN(function)                  \
  if (!current) return driver_invalid_context;

/// Refuses what a graph cannot hold, or what CUDA refuses to all threads, while a stream captures.
#define MPM_REFUSE_IN_CAPTURE                            \
  for (auto& [handle, stream_in_use] : current->streams) \
    if (stream_in_use->capture.on()) return stream_in_use->capture.refuse();

std::uint64_t memory_of(const HostDevice& device) {
  return device.memory
             ? device.memory
             : static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

bool is_device(int number) {
  return number >= 0 && number < static_cast<int>(host().devices.size());
}

// ---- addresses -----------------------------------------------------------------------------------------------------

// A device pointer is the host's address with these bits above it, which no address of the processor has. As a number
// it is a signalling NaN that no arithmetic makes, so that pointers are told from data wherever they lie.
constexpr DevicePointer tag = 0x7ff7ull << 48, tag_bits = 0xffffull << 48;

/// The memory behind `bytes` bytes from a device pointer; null where they are not all in one allocation.
unsigned char* memory_at(DevicePointer pointer, std::size_t bytes) {
  if ((pointer & tag_bits) != tag) return nullptr;
  const auto address = static_cast<std::uintptr_t>(pointer & ~tag_bits);
  auto found = current->allocations.upper_bound(address);
  if (found == current->allocations.begin()) return nullptr;
  --found;
  const std::size_t offset = address - found->first;
  if (offset > found->second.bytes || bytes > found->second.bytes - offset) return nullptr;
  return found->second.memory.get() + offset;
}

/// Puts addresses in place of device pointers in a block of 8-byte words.
void translate(std::vector<std::uint64_t>& words) {
  for (std::uint64_t& word : words)
    if ((word & tag_bits) == tag)
      if (unsigned char* const memory = memory_at(word, 0)) word = reinterpret_cast<std::uintptr_t>(memory);
}

/// Whether a word is an address of this process that is in use. Small numbers and most data are told by their bits.
bool is_host_address(std::uint64_t word) {
  constexpr std::uint64_t lowest = 1ull << 32;
  // Room between the members of a struct may hold anything, but hardly a whole address beside its members' zeros.
  if (word < lowest || word >= 1ull << 47 || word % 4 != 0 || (word & 0xffffff) == 0) return false;
  const auto page = static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
  unsigned char ignored = 0;
  // NOLINTNEXTLINE(performance-no-int-to-ptr): the word is only asked for, nothing is read there
  return mincore(reinterpret_cast<void*>(word / page * page), page, &ignored) == 0;
}

std::vector<std::uint64_t> words_of(const void* from, std::size_t bytes) {
  std::vector<std::uint64_t> words((bytes + 7) / 8);
  if (bytes > 0) std::memcpy(words.data(), from, bytes);
  return words;
}

// ---- queues --------------------------------------------------------------------------------------------------------

/// Runs what waits in a stream, in order.
void run(StreamHandle stream, std::unique_lock<std::mutex>& lock) {
  HostOperations operations;
  operations.swap(stream->waiting);
  lock.unlock();
  for (const auto& operation : operations) operation();
  lock.lock();
}
void run_all(std::unique_lock<std::mutex>& lock) {
  std::vector<StreamHandle> streams;
  for (const auto& [handle, stream] : current->streams) streams.push_back(handle);
  for (StreamHandle stream : streams) run(stream, lock);
}

bool is_stream(StreamHandle stream) {
  return current->streams.count(stream) > 0;
}

// ---- the functions -------------------------------------------------------------------------------------------------

DriverResult cuInit(unsigned) {
  MPM_BEGIN(cuInit)
  return host().devices.empty() ? driver_no_device : driver_success;
}

DriverResult cuDriverGetVersion(int* version) {
  MPM_BEGIN(cuDriverGetVersion)
  *version = 12000;
  return driver_success;
}

DriverResult cuDeviceGetCount(int* count) {
  MPM_BEGIN(cuDeviceGetCount)
  *count = static_cast<int>(host().devices.size());
  return driver_success;
}
DriverResult cuDeviceGet(DeviceNumber* device, int ordinal) {
  MPM_BEGIN(cuDeviceGet)
  if (!is_device(ordinal)) return driver_invalid_device;
  *device = ordinal;
  return driver_success;
}
DriverResult cuDeviceGetName(char* name, int length, DeviceNumber device) {
  MPM_BEGIN(cuDeviceGetName)
  if (!is_device(device)) return driver_invalid_device;
  if (length < 1) return driver_invalid_value;
  const std::string& full = host().devices[static_cast<std::size_t>(device)].name;
  const std::size_t fits = std::min(full.size(), static_cast<std::size_t>(length) - 1);
  std::memcpy(name, full.data(), fits);
  name[fits] = 0;
  return driver_success;
}
DriverResult cuDeviceTotalMem_v2(std::size_t* bytes, DeviceNumber device) {
  MPM_BEGIN(cuDeviceTotalMem_v2)
  if (!is_device(device)) return driver_invalid_device;
  *bytes = memory_of(host().devices[static_cast<std::size_t>(device)]);
  return driver_success;
}
DriverResult cuDeviceGetAttribute(int* value, int attribute, DeviceNumber device) {
  MPM_BEGIN(cuDeviceGetAttribute)
  if (!is_device(device)) return driver_invalid_device;
  *value = attribute == attribute_most_shared_memory ? 48 * 1024 : attribute == attribute_multiprocessors ? 1 : 0;
  return driver_success;
}

DriverResult cuDevicePrimaryCtxRetain(ContextHandle* context, DeviceNumber device) {
  MPM_BEGIN(cuDevicePrimaryCtxRetain)
  if (!is_device(device)) return driver_invalid_device;
  std::unique_ptr<OpaqueContext>& found = host().contexts[device];
  if (!found) {
    found = std::make_unique<OpaqueContext>();
    found->device = host().devices[static_cast<std::size_t>(device)];
    if (found->device.records) {
      std::shared_ptr<RaceRecorder>& recorder = host().recorders[device];
      if (!recorder) recorder = std::make_shared<RaceRecorder>();
      found->recorder = recorder;
    }
  }
  ++found->users;
  *context = found.get();
  return driver_success;
}
DriverResult cuDevicePrimaryCtxRelease_v2(DeviceNumber device) {
  std::unique_lock lock(host().mutex);
  ++host().calls["cuDevicePrimaryCtxRelease_v2"];
  const auto found = host().contexts.find(device);
  if (found == host().contexts.end()) return driver_invalid_device;
  if (--found->second->users > 0) return driver_success;
  if (!found->second->lost) host().left += found->second->bytes;  // a lost device refuses to take memory back
  host().contexts.erase(found);                                   // a lost device is as new for the next user
  return driver_success;
}
DriverResult cuCtxSetCurrent(ContextHandle context) {
  std::unique_lock lock(host().mutex);
  current = context;
  return begin("cuCtxSetCurrent");
}

DriverResult cuMemGetInfo_v2(std::size_t* free, std::size_t* total) {
  MPM_BEGIN_IN_CONTEXT(cuMemGetInfo_v2)
  *total = memory_of(current->device);
  *free = *total - current->bytes;
  return driver_success;
}
DriverResult cuMemAlloc_v2(DevicePointer* pointer, std::size_t bytes) {
  MPM_BEGIN_IN_CONTEXT(cuMemAlloc_v2)
  MPM_REFUSE_IN_CAPTURE
  if (bytes == 0) return driver_invalid_value;
  if (bytes > memory_of(current->device) - current->bytes) return driver_out_of_memory;
  auto* const memory = static_cast<unsigned char*>(::operator new(bytes, line, std::nothrow));
  if (!memory) return driver_out_of_memory;
  std::memset(memory, 0xff, bytes);
  const auto address = reinterpret_cast<std::uintptr_t>(memory);
  current->allocations[address] = {std::unique_ptr<unsigned char, FreeMemory>(memory), bytes};
  current->bytes += bytes;
  if (current->recorder) current->recorder->add_memory(address, bytes);
  *pointer = tag | address;
  return driver_success;
}
DriverResult cuMemFree_v2(DevicePointer pointer) {
  MPM_BEGIN_IN_CONTEXT(cuMemFree_v2)
  MPM_REFUSE_IN_CAPTURE
  const auto found = current->allocations.find(static_cast<std::uintptr_t>(pointer & ~tag_bits));
  if ((pointer & tag_bits) != tag || found == current->allocations.end()) return driver_invalid_value;
  run_all(lock);  // what waits may still use it
  current->bytes -= found->second.bytes;
  if (current->recorder) current->recorder->remove_memory(found->first);
  current->allocations.erase(found);
  return driver_success;
}

DriverResult cuMemcpyHtoDAsync_v2(DevicePointer to, const void* from, std::size_t bytes, StreamHandle stream) {
  MPM_BEGIN_IN_CONTEXT(cuMemcpyHtoDAsync_v2)
  // CUDA would copy at each launch what the host's memory holds by then.
  MPM_REFUSE_IN_CAPTURE
  unsigned char* const memory = memory_at(to, bytes);
  if (!memory) return driver_invalid_value;
  if (!is_stream(stream)) return driver_invalid_handle;
  host().copied += bytes;
  std::vector<std::uint64_t> words = words_of(from, bytes);  // pageable memory is free when a copy from it returns
  translate(words);
  stream->waiting.emplace_back([=, words = std::move(words)] { std::memcpy(memory, words.data(), bytes); });
  return driver_success;
}
DriverResult cuMemcpyDtoHAsync_v2(void* to, DevicePointer from, std::size_t bytes, StreamHandle stream) {
  MPM_BEGIN_IN_CONTEXT(cuMemcpyDtoHAsync_v2)
  MPM_REFUSE_IN_CAPTURE
  const unsigned char* const memory = memory_at(from, bytes);
  if (!memory) return driver_invalid_value;
  if (!is_stream(stream)) return driver_invalid_handle;
  host().copied += bytes;
  stream->waiting.emplace_back([=] { std::memcpy(to, memory, bytes); });
  return driver_success;
}
DriverResult cuMemcpyDtoDAsync_v2(DevicePointer to, DevicePointer from, std::size_t bytes, StreamHandle stream) {
  MPM_BEGIN_IN_CONTEXT(cuMemcpyDtoDAsync_v2)
  unsigned char *const target = memory_at(to, bytes), *const source = memory_at(from, bytes);
  if (!target || !source) return driver_invalid_value;
  if (!is_stream(stream)) return driver_invalid_handle;
  stream->waiting.emplace_back([=] { std::memmove(target, source, bytes); });
  return driver_success;
}
DriverResult cuMemsetD8Async(DevicePointer to, unsigned char value, std::size_t bytes, StreamHandle stream) {
  MPM_BEGIN_IN_CONTEXT(cuMemsetD8Async)
  unsigned char* const memory = memory_at(to, bytes);
  if (!memory) return driver_invalid_value;
  if (!is_stream(stream)) return driver_invalid_handle;
  stream->waiting.emplace_back([=] { std::memset(memory, value, bytes); });
  return driver_success;
}

DriverResult cuStreamCreate(StreamHandle* stream, unsigned) {
  MPM_BEGIN_IN_CONTEXT(cuStreamCreate)
  auto made = std::make_unique<OpaqueStream>();
  *stream = made.get();
  current->streams[*stream] = std::move(made);
  return driver_success;
}
DriverResult cuStreamDestroy_v2(StreamHandle stream) {
  MPM_BEGIN_IN_CONTEXT(cuStreamDestroy_v2)
  if (!is_stream(stream)) return driver_invalid_handle;
  run(stream, lock);
  current->streams.erase(stream);
  return driver_success;
}
DriverResult cuStreamSynchronize(StreamHandle stream) {
  MPM_BEGIN_IN_CONTEXT(cuStreamSynchronize)
  MPM_REFUSE_IN_CAPTURE
  if (!is_stream(stream)) return driver_invalid_handle;
  run(stream, lock);
  return driver_success;
}

DriverResult cuStreamBeginCapture_v2(StreamHandle stream, int mode) {
  MPM_BEGIN_IN_CONTEXT(cuStreamBeginCapture_v2)
  if (!is_stream(stream)) return driver_invalid_handle;
  return mode == capture_of_thread ? stream->capture.begin(stream->waiting) : driver_invalid_value;
}
DriverResult cuStreamEndCapture(StreamHandle stream, GraphHandle* graph) {
  MPM_BEGIN_IN_CONTEXT(cuStreamEndCapture)
  return is_stream(stream) ? stream->capture.end(stream->waiting, graph) : driver_invalid_handle;
}
DriverResult cuGraphInstantiateWithFlags(GraphExecHandle* made, GraphHandle graph, unsigned long long) {
  MPM_BEGIN_IN_CONTEXT(cuGraphInstantiateWithFlags)
  if (!graph) return driver_invalid_handle;
  *made = new OpaqueGraphExec{graph->operations};
  return driver_success;
}
DriverResult cuGraphLaunch(GraphExecHandle graph, StreamHandle stream) {
  MPM_BEGIN_IN_CONTEXT(cuGraphLaunch)
  if (!graph || !is_stream(stream)) return driver_invalid_handle;
  stream->waiting.insert(stream->waiting.end(), graph->operations.begin(), graph->operations.end());
  return driver_success;
}
DriverResult cuGraphDestroy(GraphHandle graph) {
  MPM_BEGIN(cuGraphDestroy)
  delete graph;
  return driver_success;
}
DriverResult cuGraphExecDestroy(GraphExecHandle graph) {
  MPM_BEGIN(cuGraphExecDestroy)
  delete graph;  // a launch that waits has its own copy of the operations
  return driver_success;
}

DriverResult cuEventCreate(EventHandle* event, unsigned) {
  MPM_BEGIN_IN_CONTEXT(cuEventCreate)
  *event = new OpaqueEvent;
  return driver_success;
}
DriverResult cuEventDestroy_v2(EventHandle event) {
  MPM_BEGIN_IN_CONTEXT(cuEventDestroy_v2)
  run_all(lock);  // a record may wait
  delete event;
  return driver_success;
}
DriverResult cuEventRecord(EventHandle event, StreamHandle stream) {
  MPM_BEGIN_IN_CONTEXT(cuEventRecord)
  if (!event || !is_stream(stream)) return driver_invalid_handle;
  event->recorded = true, event->reached = false;
  stream->waiting.emplace_back([=] { event->when = std::chrono::steady_clock::now(), event->reached = true; });
  return driver_success;
}
DriverResult cuEventElapsedTime(float* milliseconds, EventHandle start, EventHandle end) {
  MPM_BEGIN_IN_CONTEXT(cuEventElapsedTime)
  if (!start || !end) return driver_invalid_handle;
  for (EventHandle event : {start, end})
    if (!event->reached) return event->recorded ? driver_not_ready : driver_invalid_handle;
  *milliseconds = std::chrono::duration<float, std::milli>(end->when - start->when).count();
  return driver_success;
}

DriverResult cuModuleLoadData(ModuleHandle* module, const void* image) {
  MPM_BEGIN_IN_CONTEXT(cuModuleLoadData)
  const std::size_t length = length_of_image(image);
  if (length == 0) return driver_invalid_image;
  void* const library = load_library({static_cast<const char*>(image), length});
  if (!library) return driver_invalid_image;
  if (void* const wants = dlsym(library, "mpm_access_recorder"))
    *static_cast<AccessRecorder**>(wants) = access_recorder();
  *module = new OpaqueModule{library, {}};
  return driver_success;
}
DriverResult cuModuleUnload(ModuleHandle module) {
  MPM_BEGIN_IN_CONTEXT(cuModuleUnload)
  run_all(lock);  // launches may wait
  delete module;
  return driver_success;
}
DriverResult cuModuleGetFunction(FunctionHandle* function, ModuleHandle module, const char* name) {
  MPM_BEGIN_IN_CONTEXT(cuModuleGetFunction)
  void* const entry = dlsym(module->library, name);
  if (!entry) return driver_not_found;
  OpaqueFunction& made = module->functions[name];
  made.name = name;
  made.entry = reinterpret_cast<OpaqueFunction::Entry>(entry);
  *function = &made;
  return driver_success;
}

DriverResult cuLaunchKernel(FunctionHandle function, unsigned grid_x, unsigned grid_y, unsigned grid_z,
                            unsigned block_x, unsigned block_y, unsigned block_z, unsigned, StreamHandle stream, void**,
                            void** extra) {
  MPM_BEGIN_IN_CONTEXT(cuLaunchKernel)
  if (!function || !is_stream(stream)) return driver_invalid_handle;
  if (grid_x < 1 || grid_y != 1 || grid_z != 1 || block_x < 1 || block_x > 1024 || block_y != 1 || block_z != 1)
    return driver_invalid_value;
  const void* block = nullptr;
  std::size_t bytes = 0;
  for (void** key = extra; key && *key != launch_parameter_end; key += 2) {
    if (*key == launch_parameter_buffer) block = key[1];
    if (*key == launch_parameter_size) bytes = *static_cast<const std::size_t*>(key[1]);
  }
  if (!block || bytes > 4096) return driver_invalid_value;  // a kernel of CUDA before 12.1 takes at most 4096 bytes
  std::vector<std::uint64_t> words = words_of(block, bytes);
  if (std::any_of(words.begin(), words.end(), is_host_address)) return current->lost = driver_illegal_address;
  translate(words);
  stream->waiting.emplace_back([=, context = current, words = std::move(words)] {
    const Recording recording(context->recorder.get(), function->name, words);
    function->entry(words.data(), static_cast<int>(grid_x), static_cast<int>(block_x), context->device.order);
  });
  return driver_success;
}

#undef MPM_REFUSE_IN_CAPTURE
#undef MPM_BEGIN
#undef MPM_BEGIN_IN_CONTEXT

}  // namespace

const Driver& host_driver() {
#define MPM_NAME(name, parameters) name,
  static const Driver table{MPM_DRIVER_FUNCTIONS(MPM_NAME)};
#undef MPM_NAME
  return table;
}

void set_host_devices(std::vector<HostDevice> devices) {
  const std::lock_guard lock(host().mutex);
  if (!host().contexts.empty()) throw std::logic_error("a device of the host driver is in use");
  host().devices = std::move(devices);
  host().recorders.clear();
}

void fail_on_host(const std::string& function, long call, DriverResult result) {
#define MPM_WORD(name, parameters) #name,
  static const std::vector<std::string> names{MPM_DRIVER_FUNCTIONS(MPM_WORD)};
#undef MPM_WORD
  if (std::find(names.begin(), names.end(), function) == names.end() || call < 1)
    throw std::logic_error("the driver's table has no " + function);
  const std::lock_guard lock(host().mutex);
  host().failures.push_back({function, call, result});
}
void forget_failures_on_host() {
  const std::lock_guard lock(host().mutex);
  host().failures.clear();
}

long calls_on_host(const std::string& function) {
  const std::lock_guard lock(host().mutex);
  return host().calls[function];
}
std::uint64_t bytes_on_host(int device) {
  const std::lock_guard lock(host().mutex);
  const auto found = host().contexts.find(device);
  return found == host().contexts.end() ? 0 : found->second->bytes;
}

std::uint64_t bytes_left_on_host() {
  const std::lock_guard lock(host().mutex);
  return host().left;
}
std::uint64_t bytes_copied_on_host() {
  const std::lock_guard lock(host().mutex);
  return host().copied;
}
RaceRecorder& recorder_on_host(int device) {
  const std::lock_guard lock(host().mutex);
  const auto found = host().recorders.find(device);
  if (found == host().recorders.end()) throw std::logic_error("no recording device of that number has been used");
  return *found->second;
}

}  // namespace mpm::device
