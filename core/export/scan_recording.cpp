#include "core/export/scan_recording.h"

#include <nlohmann/json.hpp>
#include <utility>

#include "core/dataset/camera_file.h"
#include "core/dataset/changed_sequence.h"

namespace hermite::exports {

Result<std::optional<Camera>> camera_of_report(const std::string& report_json) {
  const nlohmann::json report = nlohmann::json::parse(report_json, nullptr, false);
  for (const char* key : {"corrected_camera", "camera"}) {
    if (!report.is_object() || !report.contains(key)) continue;
    const Result<dataset::CameraFile> camera = dataset::parse_camera_json(report[key].dump());
    if (!camera.ok()) return in_context(std::string("report.json: ") + key, camera.error());
    return std::optional<Camera>(camera->camera);
  }
  return std::optional<Camera>();
}

Result<std::unique_ptr<dataset::Sequence>> as_scanned(std::unique_ptr<dataset::Sequence> recording,
                                                      const std::string& report_json) {
  const Result<std::optional<Camera>> better = camera_of_report(report_json);
  if (!better.ok()) return better.error();
  if (!*better) return recording;
  if ((*better)->width != recording->camera().width ||
      (*better)->height != recording->camera().height)
    return Error{ErrorCode::kInvalidArgument,
                 "the camera in report.json has another size than that of the recording"};
  return std::unique_ptr<dataset::Sequence>(
      std::make_unique<dataset::RecalibratedSequence>(std::move(recording), **better));
}

}  // namespace hermite::exports
