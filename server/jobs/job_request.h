// Parses job requests and formats job status as JSON. Pure functions.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/math/camera.h"
#include "server/jobs/executor.h"
#include "server/store/upload_row.h"

namespace hermite::server {

// From the metadata of an upload (tus.h). All keys are optional, unknown keys are ignored:
//   "title"     of the scan; by default "filename" without its extension
//   "camera"    JSON as in camera.json, or a name that camera_file.h knows
//   "settings"  a JSON object of strings: settings of the reconstruction, as a camera sends them
//   "priority"  -100 to 100; above 0 only for administrators (check_priority)
// kInvalidArgument, naming the key.
Result<JobRow> job_of_upload(const UploadRow& upload);

// Makes a job from the body of a request, a JSON object: "scan" is the id of the scan to reprocess;
// "title", "settings" and "priority" as above. The caller sets the id of the job.
Result<JobRow> job_of_request(const std::string& body);

// kUnauthorized: only administrators may use a priority above 0.
Status check_priority(const JobRow& job, bool is_admin);

// The settings of a row that the functions above have made; none if the row is corrupt.
std::map<std::string, std::string> settings_of(const JobRow& job);

// The camera that the job names or describes; none if it comes from the recording.
// kInvalidArgument, kCorruptData: as parse_camera_json.
Result<std::optional<Camera>> camera_of(const JobRow& job);

// Makes text valid UTF-8 without control characters, cut to the length of a title; invalid parts
// become "?".
std::string clean_title(const std::string& text);

// {"jobs": [...]}, and a single job with its log.
std::string jobs_json(const std::vector<JobStatus>& jobs);
std::string job_json(const JobStatus& job, const std::vector<JobLine>& log);

}  // namespace hermite::server
