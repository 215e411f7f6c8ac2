// The Kinect v1 (Xbox 360 and "for Windows") through libfreenect: 640x480 at 30 Hz, depth in millimetres as the colour camera sees it; as
// the depth camera sees it, with Camera::color, where the library does not register (fakenect, which plays dumps of a Kinect).
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "server/capture/camera.h"

namespace hermite {

// Names of those attached.
std::vector<std::string> find_kinects();

// `index` in that list. `intrinsics`: of this very camera where they are known, else the nominal ones.
// kInvalidArgument: of another size. kDevice: not there, in use, or not allowed.
Result<std::unique_ptr<CaptureCamera>> open_kinect(int index, const std::optional<Camera>& intrinsics);

}  // namespace hermite
