// Depth cameras through OpenNI2: Asus Xtion, PrimeSense, Orbbec, whatever OpenNI2 has a driver for. Depth registered to colour where the
// device can.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "server/capture/camera.h"

namespace hermite {

// Names of those attached.
std::vector<std::string> find_openni_cameras();

// `index` in that list; or by the address that OpenNI2 knows it by. `intrinsics`: of this very camera where they are known, else by the
// fields of view that the device states. kInvalidArgument: intrinsics of another size. kUnsupported: no depth and colour of one size, or no
// field of view and no intrinsics. kDevice: not there, in use, or not allowed.
Result<std::unique_ptr<CaptureCamera>> open_openni(int index, const std::optional<Camera>& intrinsics);
Result<std::unique_ptr<CaptureCamera>> open_openni_at(const std::string& address, const std::optional<Camera>& intrinsics);

}  // namespace hermite
