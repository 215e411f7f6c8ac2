#include "server/upload_metadata.h"

#include <fmt/core.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "core/dataset/camera_file.h"
#include "core/dataset/recording.h"
#include "core/dataset/text_file.h"
#include "core/evaluate/inspection.h"
#include "core/import/model.h"
#include "server/client_commands.h"

namespace hermite::commands {

namespace {

using Json = nlohmann::ordered_json;
using Tell = std::function<void(const std::string&)>;

std::string file_name_of(const std::string& path) {
  const std::filesystem::path name = std::filesystem::path(path).lexically_normal();
  return name.has_filename() ? name.filename().string() : name.parent_path().filename().string();
}

// Reads the model as the server will, so that errors are reported before it is sent.
Status check_model(const std::string& path, const UploadRequest& request, const Tell& tell) {
  if (request.no_check) return Done{};
  const auto settings = parse_settings(request.settings);
  const Result<imports::ImportOptions> options =
      settings.ok() ? imports::parse_import_options(*settings) : settings.error();
  if (!options.ok()) return options.error();
  const Result<std::string> bytes = dataset::read_text_file(path, imports::kMaxModel_bytes);
  if (!bytes.ok()) return bytes.error();
  const Result<imports::ImportedModel> model = imports::read_model(*bytes, *options);
  if (!model.ok()) return model.error();
  for (const std::string& message : imports::remarks_about(*model, *options))
    tell(path + ": " + message);
  return Done{};
}

// Returns the camera that was asked for or, if the recording is opened, the recording's.
Result<std::optional<Camera>> checked_camera(const std::string& path, const UploadRequest& request,
                                             const Tell& tell) {
  std::optional<Camera> camera;
  if (!request.camera.empty()) {
    const Result<Camera> given = dataset::read_camera(request.camera);
    if (!given.ok()) return given.error();
    camera = *given;
  }
  if (request.no_check) return camera;
  const Result<dataset::Recording> recording = dataset::open_recording(path, camera);
  if (!recording.ok()) return recording.error();
  const evaluate::Inspection inspection = evaluate::inspect(*recording, path);
  tell(fmt::format("{}: {}, {} frames", path, inspection.format, inspection.frame_count));
  for (const std::string& doubt : inspection.doubts) tell("  " + doubt);
  if (inspection.unreadable_count == inspection.frames_looked_at && inspection.frames_looked_at > 0)
    return Error{ErrorCode::kCorruptData, "none of the frames that were looked at can be read"};
  return std::optional(recording->sequence->camera());
}

}  // namespace

Result<client::UploadMetadata> upload_metadata(const std::string& path,
                                               const UploadRequest& request, const Tell& tell) {
  const auto settings = parse_settings(request.settings);
  if (!settings.ok()) return settings.error();
  client::UploadMetadata metadata{{"filename", file_name_of(path)}};
  if (!request.title.empty()) metadata.emplace_back("title", request.title);
  if (!settings->empty()) metadata.emplace_back("settings", Json(*settings).dump());
  if (request.priority != 0) metadata.emplace_back("priority", std::to_string(request.priority));
  if (const Result<bool> model = imports::is_model_file(path);
      request.import || (model.ok() && *model)) {
    const Status checked = check_model(path, request, tell);
    return checked.ok() ? Result<client::UploadMetadata>(metadata) : checked.error();
  }
  const Result<std::optional<Camera>> camera = checked_camera(path, request, tell);
  if (!camera.ok()) return camera.error();
  if (*camera)
    metadata.emplace_back(
        "camera",
        Json::parse(dataset::format_camera_json({**camera, dataset::kDefaultFrameRate_hz, true}))
            .dump());
  return metadata;
}

}  // namespace hermite::commands
