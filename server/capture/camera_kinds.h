// The kinds of camera that this build supports, which of them are attached, and how to open one. A
// new kind needs a file and a row in the table.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "server/capture/camera.h"

namespace hermite::client {

struct CameraKind {
  const char* name;  // as in --camera
  const char* description;
  // As in kinect.h. nullptr if the library was not available when this was built.
  std::vector<std::string> (*find)();
  Result<std::unique_ptr<CaptureCamera>> (*open)(int index,
                                                 const std::optional<Camera>& intrinsics);
  // Opens a camera by an address that the library defines; nullptr also if the library has none.
  Result<std::unique_ptr<CaptureCamera>> (*open_at)(const std::string& address,
                                                    const std::optional<Camera>& intrinsics);
};

std::span<const CameraKind> camera_kinds();

// Returns for each kind one line per camera, or why there is none: the output of `hermite-client
// scan --list`.
std::string list_cameras();

// Opens a camera. `wish` is empty for the first attached one; "kinect" or "kinect:2" for the first
// or second one of a kind; "openni:ADDRESS" for an address that the library defines;
// "recording:SEQUENCE" for recording_camera.h. `intrinsics` replace the camera's own.
// kInvalidArgument: `intrinsics` for another image size. kUnsupported: not in this build.
// kNotFound: none is attached. kDevice.
Result<std::unique_ptr<CaptureCamera>> open_camera(const std::string& wish,
                                                   const std::optional<Camera>& intrinsics);

}  // namespace hermite::client
