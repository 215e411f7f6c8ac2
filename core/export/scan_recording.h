// The frames of a scan as its camera turned out to be.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "core/base/result.h"
#include "core/dataset/sequence.h"
#include "core/math/camera.h"

namespace hermite {

// The camera that a scan was made with at last, where its report.json says so (`corrected_camera`, else `camera`). kCorruptData,
// kInvalidArgument: what stands there is no camera.
Result<std::optional<Camera>> camera_of_report(const std::string& report_json);

// The recording with that camera, where there is one. Errors as above; kInvalidArgument: it has another size.
Result<std::unique_ptr<Sequence>> as_scanned(std::unique_ptr<Sequence> recording, const std::string& report_json);

}  // namespace hermite
