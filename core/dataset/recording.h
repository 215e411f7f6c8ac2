// Opens a recording of any format, and says how the format was determined. Formats are recognised
// by content.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/dataset/sequence.h"

namespace hermite::dataset {

struct Recording {
  std::unique_ptr<Sequence> sequence;
  std::string format_reason;        // "rgb.txt and depth.txt beside each other"
  std::string camera_source;        // "camera.json", "the file's header"
  std::vector<std::string> doubts;  // assumptions that may be wrong, as sentences for the user
};

// Opens `path`: a folder or file of one of the formats in the README's table, a folder with exactly
// one such below it (at most 3 levels deep), or an archive (core/archive/unpack.h) of either, which
// is unpacked into a temporary folder that lives as long as the sequence. The camera is `camera` if
// given, else camera.json, else the recording's own, else one by a well-known name; see the
// formats. Errors name file, place and what is allowed: kNotFound, kUnsupported when nothing is
// recognised, kInvalidArgument when there are several recordings, kCorruptData, kTooLarge, kIo.
Result<Recording> open_recording(const std::string& path,
                                 const std::optional<Camera>& camera = std::nullopt);

// A row of kFormats (recording.cpp), which are tried in order. `probe` reads little and returns why
// `path` has the format, or std::nullopt; `open` may then still find it damaged.
struct RecordingFormat {
  const char* name;
  const char* looks_like;  // for the message when no format fits
  std::optional<std::string> (*probe)(const std::string& path);
  Result<Recording> (*open)(const std::string& path, const std::optional<Camera>& camera);
};

std::optional<std::string> probe_klg(const std::string& path);  // klg.cpp
Result<Recording> open_klg(const std::string& path, const std::optional<Camera>& camera);
std::optional<std::string> probe_sens(const std::string& path);  // sens.cpp
Result<Recording> open_sens(const std::string& path, const std::optional<Camera>& camera);
std::optional<std::string> probe_oni(const std::string& path);  // oni.cpp
Result<Recording> open_oni(const std::string& path, const std::optional<Camera>& camera);
std::optional<std::string> probe_frame_log(const std::string& path);  // logged_frames.cpp
Result<Recording> open_frame_log(const std::string& path, const std::optional<Camera>& camera);
std::optional<std::string> probe_raw(const std::string& path);  // raw_recording.cpp
Result<Recording> open_raw(const std::string& path, const std::optional<Camera>& camera);

}  // namespace hermite::dataset
