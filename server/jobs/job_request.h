// What people ask of a job, in texts, and what they are told of it. Pure functions.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/math/camera.h"
#include "server/jobs/executor.h"
#include "server/store/upload_row.h"

namespace hermite {

// From the metadata of an upload (tus.h); every key may be missing, others are left alone:
//   "title"     of the scan, else that of "filename" without its ending
//   "camera"    as in camera.json, or one of the names that camera_file.h knows
//   "settings"  a JSON object of texts: of the reconstruction, as a camera sends them
//   "priority"  -100 to 100; above 0 only of a token that may administer (check_priority)
// kInvalidArgument, naming the key.
Result<JobRow> job_of_upload(const UploadRow& upload);

// From the body of a request, a JSON object: "scan" is the id of the one to be made anew, "title", "settings" and "priority" as above.
// An id of its own is not in it yet.
Result<JobRow> job_of_request(const std::string& body);

// Only administrators put themselves before others. kUnauthorized.
Status check_priority(const JobRow& job, bool is_admin);

// Of a row that came out of the above. A corrupt one has none.
std::map<std::string, std::string> settings_of(const JobRow& job);

// The camera that the job names or describes, none where it leaves that to the recording. kInvalidArgument, kCorruptData, as
// parse_camera_json.
Result<std::optional<Camera>> camera_of(const JobRow& job);

// UTF-8 without control characters, as long as a title may be; what is neither becomes "?".
std::string clean_title(const std::string& text);

// {"jobs": [...]}, and one with its log.
std::string jobs_json(const std::vector<JobStatus>& jobs);
std::string job_json(const JobStatus& job, const std::vector<JobLine>& log);

}  // namespace hermite
