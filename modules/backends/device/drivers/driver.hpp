#pragma once
// The table of functions by which the device backend reaches a device: those of the CUDA driver API that it uses, with
// their names and signatures. libcuda fills it (drivers/cuda.hpp), or the host does (drivers/host_driver.hpp). The few
// types are declared here, so that nothing of CUDA is needed to build.

#include <cstddef>

namespace mpm::device {

/// The types of cuda.h. Handles are opaque; a device pointer is no address that the host may follow.
using DriverResult = int;  ///< CUresult: 0 is success
using DeviceNumber = int;
using DevicePointer = unsigned long long;
using ContextHandle = struct OpaqueContext*;
using StreamHandle = struct OpaqueStream*;
using EventHandle = struct OpaqueEvent*;
using ModuleHandle = struct OpaqueModule*;
using FunctionHandle = struct OpaqueFunction*;
using GraphHandle = struct OpaqueGraph*;
using GraphExecHandle = struct OpaqueGraphExec*;

/// The results of cuda.h that are looked at by name.
enum : DriverResult {
  driver_success = 0,
  driver_invalid_value = 1,
  driver_out_of_memory = 2,
  driver_not_initialized = 3,
  driver_device_unavailable = 46,
  driver_no_device = 100,
  driver_invalid_device = 101,
  driver_invalid_image = 200,
  driver_invalid_context = 201,
  driver_no_binary_for_device = 209,
  driver_unsupported_ptx_version = 222,
  driver_invalid_handle = 400,
  driver_illegal_state = 401,
  driver_not_found = 500,
  driver_not_ready = 600,
  driver_illegal_address = 700,
  driver_launch_out_of_resources = 701,
  driver_launch_failed = 719,
  driver_system_driver_mismatch = 803,
  driver_capture_unsupported = 900,
  driver_capture_invalidated = 901
};

/// How far a capture reaches (CUstreamCaptureMode): what it could not hold is refused to the thread that captures alone.
enum : int { capture_of_thread = 1 };

/// The attributes of devices that are asked for (CUdevice_attribute).
enum : int {
  attribute_most_shared_memory = 8,
  attribute_multiprocessors = 16,
  attribute_capability_major = 75,
  attribute_capability_minor = 76
};

/// The keys of cuLaunchKernel's last argument, by which parameters are handed over as one block.
inline void* const launch_parameter_end = nullptr;
// NOLINTBEGIN(performance-no-int-to-ptr): CUDA names these two by numbers
inline void* const launch_parameter_buffer = reinterpret_cast<void*>(1);
inline void* const launch_parameter_size = reinterpret_cast<void*>(2);
// NOLINTEND(performance-no-int-to-ptr)

/// Calls X(name, (parameters)) for every function; all return a DriverResult.
#define MPM_DRIVER_FUNCTIONS(X)                                                                                      \
  X(cuInit, (unsigned flags))                                                                                        \
  X(cuDriverGetVersion, (int* version))                                                                              \
  X(cuGetErrorName, (DriverResult result, const char** name))                                                        \
  X(cuGetErrorString, (DriverResult result, const char** text))                                                      \
  X(cuDeviceGetCount, (int* count))                                                                                  \
  X(cuDeviceGet, (DeviceNumber * device, int ordinal))                                                               \
  X(cuDeviceGetName, (char* name, int length, DeviceNumber device))                                                  \
  X(cuDeviceTotalMem_v2, (std::size_t * bytes, DeviceNumber device))                                                 \
  X(cuDeviceGetAttribute, (int* value, int attribute, DeviceNumber device))                                          \
  X(cuDevicePrimaryCtxRetain, (ContextHandle * context, DeviceNumber device))                                        \
  X(cuDevicePrimaryCtxRelease_v2, (DeviceNumber device))                                                             \
  X(cuCtxSetCurrent, (ContextHandle context))                                                                        \
  X(cuMemGetInfo_v2, (std::size_t * free, std::size_t * total))                                                      \
  X(cuMemAlloc_v2, (DevicePointer * pointer, std::size_t bytes))                                                     \
  X(cuMemFree_v2, (DevicePointer pointer))                                                                           \
  X(cuMemcpyHtoDAsync_v2, (DevicePointer to, const void* from, std::size_t bytes, StreamHandle stream))              \
  X(cuMemcpyDtoHAsync_v2, (void* to, DevicePointer from, std::size_t bytes, StreamHandle stream))                    \
  X(cuMemcpyDtoDAsync_v2, (DevicePointer to, DevicePointer from, std::size_t bytes, StreamHandle stream))            \
  X(cuMemsetD8Async, (DevicePointer to, unsigned char value, std::size_t bytes, StreamHandle stream))                \
  X(cuStreamCreate, (StreamHandle * stream, unsigned flags))                                                         \
  X(cuStreamDestroy_v2, (StreamHandle stream))                                                                       \
  X(cuStreamSynchronize, (StreamHandle stream))                                                                      \
  X(cuStreamBeginCapture_v2, (StreamHandle stream, int mode))                                                        \
  X(cuStreamEndCapture, (StreamHandle stream, GraphHandle * graph))                                                  \
  X(cuGraphInstantiateWithFlags, (GraphExecHandle * made, GraphHandle graph, unsigned long long flags))              \
  X(cuGraphLaunch, (GraphExecHandle graph, StreamHandle stream))                                                     \
  X(cuGraphDestroy, (GraphHandle graph))                                                                             \
  X(cuGraphExecDestroy, (GraphExecHandle graph))                                                                     \
  X(cuEventCreate, (EventHandle * event, unsigned flags))                                                            \
  X(cuEventDestroy_v2, (EventHandle event))                                                                          \
  X(cuEventRecord, (EventHandle event, StreamHandle stream))                                                         \
  X(cuEventElapsedTime, (float* milliseconds, EventHandle start, EventHandle end))                                   \
  X(cuModuleLoadData, (ModuleHandle * module, const void* image))                                                    \
  X(cuModuleUnload, (ModuleHandle module))                                                                           \
  X(cuModuleGetFunction, (FunctionHandle * function, ModuleHandle module, const char* name))                         \
  X(cuLaunchKernel,                                                                                                  \
    (FunctionHandle function, unsigned grid_x, unsigned grid_y, unsigned grid_z, unsigned block_x, unsigned block_y, \
     unsigned block_z, unsigned shared_bytes, StreamHandle stream, void** parameters, void** extra))

struct Driver {
#define MPM_DRIVER_MEMBER(name, parameters) DriverResult(*name) parameters = nullptr;
  MPM_DRIVER_FUNCTIONS(MPM_DRIVER_MEMBER)
#undef MPM_DRIVER_MEMBER
};

}  // namespace mpm::device
