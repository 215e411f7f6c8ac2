// The recording of a scan with its final, possibly corrected, camera.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "core/base/result.h"
#include "core/dataset/sequence.h"
#include "core/math/camera.h"

namespace hermite::exports {

// Returns the final camera of a scan from its report.json (`corrected_camera`, else `camera`), or
// nullopt when it has neither. Returns kCorruptData or kInvalidArgument when the entry is not a
// valid camera.
Result<std::optional<Camera>> camera_of_report(const std::string& report_json);

// Returns the recording with that camera, if there is one. Errors as above; kInvalidArgument also
// when the camera has another size.
Result<std::unique_ptr<dataset::Sequence>> as_scanned(std::unique_ptr<dataset::Sequence> recording,
                                                      const std::string& report_json);

}  // namespace hermite::exports
