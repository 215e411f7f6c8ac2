// Which cameras this build knows, which are attached, and how to open one. A new kind is a file and a row of the table.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "server/capture/camera.h"

namespace hermite {

struct CameraKind {
  const char* name;   // in --camera
  const char* words;  // what it is
  // Null where the library was not there when this was built. As in kinect.h.
  std::vector<std::string> (*find)();
  Result<std::unique_ptr<CaptureCamera>> (*open)(int index, const std::optional<Camera>& intrinsics);
  // By an address of the library's own; also null where it has none.
  Result<std::unique_ptr<CaptureCamera>> (*open_at)(const std::string& address, const std::optional<Camera>& intrinsics);
};

std::span<const CameraKind> camera_kinds();

// A line a camera, or why there is none, for each kind: what `hermite-client scan --list` prints.
std::string list_cameras();

// `wish`: empty: the first that is attached; "kinect", "kinect:2": that kind, the second of it;
// "openni:ADDRESS": what the library knows by that; "recording:SEQUENCE": recording_camera.h.
// `intrinsics` instead of the camera's own; of another size than its images: kInvalidArgument. kUnsupported: not in this build. kNotFound:
// none is attached. kDevice.
Result<std::unique_ptr<CaptureCamera>> open_camera(const std::string& wish, const std::optional<Camera>& intrinsics);

}  // namespace hermite
