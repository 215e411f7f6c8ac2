#include "server/jobs/job_request.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>

#include "core/base/utf8.h"
#include "core/dataset/camera_file.h"
#include "core/import/model.h"
#include "proto/wire/messages.h"
#include "proto/wire/without_paths.h"
#include "server/operations/json_text.h"
#include "server/operations/json_time.h"
#include "server/scan/scan_record.h"
#include "server/store/scan_id.h"
#include "server/uploads/tus.h"

namespace hermite::server {

namespace {

using Json = nlohmann::ordered_json;

Error invalid(const std::string& message) { return {ErrorCode::kInvalidArgument, message}; }

// "kitchen" for "kitchen.tar.zst".
std::string without_ending(std::string name) {
  const std::size_t slash = name.find_last_of("/\\");
  if (slash != std::string::npos) name.erase(0, slash + 1);
  for (const char* ending : {".tar.gz", ".tar.zst", ".tgz", ".tar", ".zip", ".klg", ".sens", ".oni",
                             ".raw", ".ply", ".glb"})
    if (name.size() > std::string_view(ending).size() && name.ends_with(ending)) {
      name.resize(name.size() - std::string_view(ending).size());
      break;
    }
  return name;
}

// Checks names and values: settings of a reconstruction or of an import, since which of them it is
// depends on the uploaded bytes.
Status check_settings(const std::map<std::string, std::string>& settings) {
  if (settings.size() > static_cast<std::size_t>(wire::kMaxSettings))
    return invalid(fmt::format("settings has {} entries, allowed are {}", settings.size(),
                               wire::kMaxSettings));
  if (std::any_of(settings.begin(), settings.end(),
                  [](const auto& setting) { return imports::is_import_option(setting.first); })) {
    const Result<imports::ImportOptions> options = imports::parse_import_options(settings);
    return options.ok() ? Status(Done{}) : invalid("settings: " + options.error().message);
  }
  ScanRecord record;
  record.request.settings = settings;
  if (const Result<pipeline::Options> options = options_of(record); !options.ok())
    return invalid(options.error().message);
  return Done{};
}

Result<std::map<std::string, std::string>> parse_settings(const Json& json) {
  std::map<std::string, std::string> settings;
  if (!json.is_object()) return invalid("settings must be a JSON object of strings");
  for (const auto& [key, value] : json.items()) {
    if (!value.is_string()) return invalid("settings has a value that is not a string");
    settings[key] = value.get<std::string>();
  }
  if (Status status = check_settings(settings); !status.ok()) return status.error();
  return settings;
}

Result<int> parse_priority(const std::string& text) {
  int priority = 0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), priority);
  if (error != std::errc() || stop != text.data() + text.size() || priority < kLowestPriority ||
      priority > kHighestPriority)
    return invalid(fmt::format("priority must be a whole number from {} to {}", kLowestPriority,
                               kHighestPriority));
  return priority;
}

Json row_json(const JobStatus& job) {
  const JobRow& row = job.row;
  Json json = {{"id", row.id},
               {"title", row.title},
               {"state", name_of(row.state)},
               {"words", wire::without_paths(row.message)}};
  json["stage"] = job.stage.name;
  json["done"] = job.stage.done;
  json["total"] = job.stage.total;
  const bool has_scan =
      !row.scan_id.empty() && (!has_ended(row.state) || row.state == JobState::kFinished);
  json["scan"] = has_scan ? Json(row.scan_id) : Json();
  json["source"] = name_of(row.source);
  json["source_id"] = row.source_id;
  json["settings"] = settings_of(row);
  json["priority"] = row.priority;
  json["attempts"] = row.attempt_count;
  json["created_at"] = time_json(row.created_at_ms);
  json["started_at"] = time_json(row.started_at_ms);
  json["finished_at"] = time_json(row.finished_at_ms);
  return json;
}

}  // namespace

std::string clean_title(const std::string& text) {
  std::string title;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t length = utf8_length(text, at);
    const auto first = static_cast<unsigned char>(text[at]);
    // Including the two-byte control characters.
    const bool control =
        first < 0x20 || first == 0x7f ||
        (first == 0xc2 && length == 2 && static_cast<unsigned char>(text[at + 1]) < 0xa0);
    const std::string piece = length == 0 || control ? "?" : text.substr(at, length);
    if (title.size() + piece.size() > wire::kMaxTitleBytes) break;
    title += piece;
    at += length == 0 ? 1 : length;
  }
  return title;
}

Result<std::optional<Camera>> camera_of(const JobRow& job) {
  if (job.camera.empty()) return std::optional<Camera>();
  if (std::optional<Camera> known = dataset::known_camera(job.camera)) return known;
  const Result<dataset::CameraFile> file = dataset::parse_camera_json(job.camera);
  if (!file.ok()) return in_context("camera", file.error());
  return std::optional<Camera>(file->camera);
}

Result<JobRow> job_of_upload(const UploadRow& upload) {
  const Result<std::map<std::string, std::string>> metadata =
      parse_upload_metadata(upload.metadata);
  if (!metadata.ok()) return metadata.error();
  const auto value = [&metadata](const char* key) {
    const auto found = metadata->find(key);
    return found == metadata->end() ? std::string() : found->second;
  };
  JobRow job;
  job.id = job.source_id = upload.id;
  job.token_id = upload.token_id;
  job.title =
      clean_title(value("title").empty() ? without_ending(value("filename")) : value("title"));
  job.camera = value("camera");
  if (const Result<std::optional<Camera>> camera = camera_of(job); !camera.ok())
    return camera.error();
  if (!value("settings").empty()) {
    const Result<std::map<std::string, std::string>> settings =
        parse_settings(Json::parse(value("settings"), nullptr, false));
    if (!settings.ok()) return settings.error();
    job.settings = Json(*settings).dump();
  }
  if (!value("priority").empty()) {
    const Result<int> priority = parse_priority(value("priority"));
    if (!priority.ok()) return priority.error();
    job.priority = *priority;
  }
  return job;
}

Result<JobRow> job_of_request(const std::string& body) {
  const Json json = Json::parse(body, nullptr, false);
  if (!json.is_object()) return invalid("the request is not a JSON object");
  JobRow job;
  job.source = JobSource::kScan;
  for (const auto& [key, value] : json.items()) {
    if (key == "scan" && value.is_string() && is_scan_id(value.get<std::string>())) {
      job.source_id = value.get<std::string>();
    } else if (key == "title" && value.is_string()) {
      job.title = clean_title(value.get<std::string>());
    } else if (key == "priority" && value.is_number_integer()) {
      const Result<int> priority = parse_priority(value.dump());
      if (!priority.ok()) return priority.error();
      job.priority = *priority;
    } else if (key == "settings") {
      const Result<std::map<std::string, std::string>> settings = parse_settings(value);
      if (!settings.ok()) return settings.error();
      job.settings = Json(*settings).dump();
    } else {
      return invalid(fmt::format("the field \"{}\" is not known here, or is not what it should be",
                                 clean_title(key)));
    }
  }
  if (job.source_id.empty()) return invalid("the field \"scan\" with the id of a scan is missing");
  return job;
}

Status check_priority(const JobRow& job, bool is_admin) {
  if (is_admin || job.priority <= kHighestPriorityForAll) return Done{};
  return Error{ErrorCode::kUnauthorized,
               fmt::format("priority {} needs a token with admin; others may ask for {} to {}",
                           job.priority, kLowestPriority, kHighestPriorityForAll)};
}

std::map<std::string, std::string> settings_of(const JobRow& job) {
  const Result<std::map<std::string, std::string>> settings =
      parse_settings(Json::parse(job.settings, nullptr, false));
  return settings.ok() ? *settings : std::map<std::string, std::string>();
}

std::string jobs_json(const std::vector<JobStatus>& jobs) {
  Json json = {{"jobs", Json::array()}};
  for (const JobStatus& job : jobs) json["jobs"].push_back(row_json(job));
  return json_text(json);
}

std::string job_json(const JobStatus& job, const std::vector<JobLine>& log) {
  Json json = row_json(job);
  json["log"] = Json::array();
  for (const JobLine& line : log)
    json["log"].push_back(
        {{"at", time_json(line.at_ms)}, {"words", wire::without_paths(line.message)}});
  return json_text(json);
}

}  // namespace hermite::server
