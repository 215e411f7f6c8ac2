// Depth cameras through OpenNI2: Asus Xtion, PrimeSense, Orbbec and others for which OpenNI2 has a
// driver. Depth is registered to colour if the device supports that.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "server/capture/camera.h"

namespace hermite::client {

// Returns the names of attached cameras.
std::vector<std::string> find_openni_cameras();

// Open the camera at `index` in that list, or by its OpenNI2 address. `intrinsics`: of this very
// camera if known; otherwise they are derived from the fields of view that the device reports.
// kInvalidArgument: intrinsics for another size. kUnsupported: no depth and colour of the same
// size, or neither field of view nor intrinsics. kDevice: not attached, in use, or no permission.
Result<std::unique_ptr<CaptureCamera>> open_openni(int index,
                                                   const std::optional<Camera>& intrinsics);
Result<std::unique_ptr<CaptureCamera>> open_openni_at(const std::string& address,
                                                      const std::optional<Camera>& intrinsics);

}  // namespace hermite::client
