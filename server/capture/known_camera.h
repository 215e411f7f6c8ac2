// What scans have found out about a camera, kept in a file for its next scan. Any thread, but one
// at a time for a file.
#pragma once

#include <optional>
#include <string>

#include "core/base/result.h"
#include "core/math/camera.h"

namespace hermite::client {

// Returns the camera of the file, a camera.json; std::nullopt if there is no file yet. Errors name
// the file and the key.
Result<std::optional<Camera>> known_camera_in(const std::string& path);

// Returns kInvalidArgument if the file says that its camera is another device than `device`
// (CameraDescription::name): numbers of another camera would be believed for the first seconds.
Status check_device(const std::string& path, const std::string& device);

// Writes "known_camera" of a scan's report.json and the name of the device to the file, in place of
// what it had. kUnsupported: the report has none, since the server is older. kCorruptData: it is
// not a camera. kIo: the file cannot be written. After an error the file is as before.
Status keep_known_camera(const std::string& report_json, const std::string& device,
                         const std::string& path);

}  // namespace hermite::client
