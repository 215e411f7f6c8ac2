// The Kinect v1 (Xbox 360 and "for Windows") through libfreenect: 640x480 at 30 Hz, depth in
// millimetres, registered to the colour camera, and what its accelerometer feels. Where the library
// does not register depth (fakenect, which plays dumps of a Kinect), depth is in the view of the
// depth camera, with Camera::color.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "server/capture/camera.h"

namespace hermite::client {

// Returns the names of attached cameras.
std::vector<std::string> find_kinects();

// Opens the camera at `index` in that list. `intrinsics`: of this very camera if known; otherwise
// the nominal ones are used. kInvalidArgument: intrinsics for another size. kDevice: not attached,
// in use, or no permission.
Result<std::unique_ptr<CaptureCamera>> open_kinect(int index,
                                                   const std::optional<Camera>& intrinsics);

}  // namespace hermite::client
