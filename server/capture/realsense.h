// Intel RealSense depth cameras through librealsense 2, which registers depth to the colour image.
// The library is not part of Debian 12: this is built only if its realsense2.pc is found. The code
// was checked against the library's headers; no such camera was available.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "server/capture/camera.h"

namespace hermite::client {

// Returns the names of attached cameras.
std::vector<std::string> find_realsense_cameras();

// Open the camera at `index` in that list, or by its serial number. `intrinsics`: of the colour
// image, if known better than by the device. kInvalidArgument: intrinsics for another size than
// 640x480. kDevice: not attached, in use, on a USB port too slow for depth and colour at 30 Hz, or
// no permission.
Result<std::unique_ptr<CaptureCamera>> open_realsense(int index,
                                                      const std::optional<Camera>& intrinsics);
Result<std::unique_ptr<CaptureCamera>> open_realsense_at(const std::string& serial,
                                                         const std::optional<Camera>& intrinsics);

}  // namespace hermite::client
