#pragma once
// The words that the host driver has for results: those of cuda.h.

#include <algorithm>
#include <iterator>

#include "backends/device/drivers/driver.hpp"

namespace mpm::device {

struct Words {
  DriverResult result;
  const char *name, *text;
};
inline constexpr Words words_of_results[] = {
    {driver_success, "CUDA_SUCCESS", "no error"},
    {driver_invalid_value, "CUDA_ERROR_INVALID_VALUE", "invalid argument"},
    {driver_out_of_memory, "CUDA_ERROR_OUT_OF_MEMORY", "out of memory"},
    {driver_not_initialized, "CUDA_ERROR_NOT_INITIALIZED", "initialization error"},
    {driver_device_unavailable, "CUDA_ERROR_DEVICE_UNAVAILABLE", "the device is busy or unavailable"},
    {driver_no_device, "CUDA_ERROR_NO_DEVICE", "no device is detected"},
    {driver_invalid_device, "CUDA_ERROR_INVALID_DEVICE", "invalid device ordinal"},
    {driver_invalid_image, "CUDA_ERROR_INVALID_IMAGE", "the kernel image is invalid"},
    {driver_invalid_context, "CUDA_ERROR_INVALID_CONTEXT", "invalid device context"},
    {driver_no_binary_for_device, "CUDA_ERROR_NO_BINARY_FOR_GPU", "no kernel image is available for the device"},
    {driver_unsupported_ptx_version, "CUDA_ERROR_UNSUPPORTED_PTX_VERSION", "made by an unsupported toolchain"},
    {driver_invalid_handle, "CUDA_ERROR_INVALID_HANDLE", "invalid resource handle"},
    {driver_illegal_state, "CUDA_ERROR_ILLEGAL_STATE", "the operation cannot be performed in the present state"},
    {driver_capture_unsupported, "CUDA_ERROR_STREAM_CAPTURE_UNSUPPORTED",
     "operation not permitted when stream is capturing"},
    {driver_capture_invalidated, "CUDA_ERROR_STREAM_CAPTURE_INVALIDATED",
     "operation failed due to a previous error during capture"},
    {driver_not_found, "CUDA_ERROR_NOT_FOUND", "named symbol not found"},
    {driver_illegal_address, "CUDA_ERROR_ILLEGAL_ADDRESS", "an illegal memory access was encountered"},
    {driver_launch_out_of_resources, "CUDA_ERROR_LAUNCH_OUT_OF_RESOURCES", "too many resources requested for launch"},
    {driver_launch_failed, "CUDA_ERROR_LAUNCH_FAILED", "unspecified launch failure"},
    {driver_system_driver_mismatch, "CUDA_ERROR_SYSTEM_DRIVER_MISMATCH", "versions of the driver do not agree"}};

inline const Words* find_words(DriverResult result) {
  const auto found = std::find_if(std::begin(words_of_results), std::end(words_of_results),
                                  [&](const Words& words) { return words.result == result; });
  return found == std::end(words_of_results) ? nullptr : found;
}
inline DriverResult cuGetErrorName(DriverResult result, const char** name) {
  const Words* const found = find_words(result);
  *name = found ? found->name : nullptr;
  return found ? driver_success : driver_invalid_value;
}
inline DriverResult cuGetErrorString(DriverResult result, const char** text) {
  const Words* const found = find_words(result);
  *text = found ? found->text : nullptr;
  return found ? driver_success : driver_invalid_value;
}

}  // namespace mpm::device
