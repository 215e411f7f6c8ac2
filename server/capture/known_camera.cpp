#include "server/capture/known_camera.h"

#include <fmt/core.h>

#include <nlohmann/json.hpp>

#include "core/dataset/camera_file.h"
#include "core/dataset/text_file.h"
#include "core/output/ply.h"

namespace hermite::client {

namespace {

constexpr const char* kDevice = "device";

}  // namespace

Result<std::optional<Camera>> known_camera_in(const std::string& path) {
  if (!dataset::is_file(path)) return std::optional<Camera>();
  const Result<dataset::CameraFile> file = dataset::read_camera_json(path);
  if (!file.ok()) return file.error();
  return std::optional(file->camera);
}

Status check_device(const std::string& path, const std::string& device) {
  const Result<std::string> text = dataset::read_text_file(path);
  if (!text.ok()) return dataset::is_file(path) ? Status(text.error()) : Status(Done{});
  const nlohmann::json file = nlohmann::json::parse(*text, nullptr, false);
  if (!file.is_object() || !file.contains(kDevice) || file[kDevice] == device) return Done{};
  return Error{ErrorCode::kInvalidArgument,
               fmt::format("{} is of the camera {}, and this is \"{}\": give each camera a file of "
                           "its own",
                           path, file[kDevice].dump(), device)};
}

Status keep_known_camera(const std::string& report_json, const std::string& device,
                         const std::string& path) {
  const nlohmann::json report = nlohmann::json::parse(report_json, nullptr, false);
  if (!report.is_object() || !report.contains("known_camera"))
    return Error{ErrorCode::kUnsupported,
                 fmt::format("the server's report does not say what is known of the camera: it is "
                             "older than this program. {} is as it was",
                             path)};
  const Result<dataset::CameraFile> camera =
      dataset::parse_camera_json(report["known_camera"].dump());
  if (!camera.ok()) return in_context("known_camera of the server's report", camera.error());
  auto file = nlohmann::ordered_json::parse(dataset::format_camera_json(*camera));
  file[kDevice] = device;
  return output::write_file_atomically(path, file.dump(2) + "\n");
}

}  // namespace hermite::client
