// Intel RealSense depth cameras through librealsense 2, depth brought to the colour image by the library. Not in Debian 12: built in where
// its realsense2.pc is found. The code was checked against the library's headers; no such camera was at hand.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "server/capture/camera.h"

namespace hermite {

// Names of those attached.
std::vector<std::string> find_realsense_cameras();

// `index` in that list; or by its serial number. `intrinsics`: of the colour image where they are known better than the device knows them.
// kInvalidArgument: intrinsics of another size than 640x480. kDevice: not there, in use, on a USB port too slow for depth and colour at 30
// Hz, or not allowed.
Result<std::unique_ptr<CaptureCamera>> open_realsense(int index, const std::optional<Camera>& intrinsics);
Result<std::unique_ptr<CaptureCamera>> open_realsense_at(const std::string& serial, const std::optional<Camera>& intrinsics);

}  // namespace hermite
