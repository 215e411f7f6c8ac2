// The frames of a scan that has ended, out of its frame log, for people who look at them. Each is
// found without reading those before it (core/log/frame_log_records.h). Blocks on the disk;
// thread-safe.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/image/depth_rendering.h"
#include "core/pipeline/reason_table.h"
#include "server/store/blobs.h"

namespace hermite::server {

// False: they were removed, or there were none.
bool are_frames_kept(const std::string& log_folder);

// Errors of all that follow. kNotFound: there is no such frame, or the scan has refused it.
// kCorruptData: it is damaged, or never was what it should be, with a message. kIo.
struct FrameImage {
  std::string bytes;
  const char* content_type = "";
};
// JPEG or PNG, as it came.
Result<FrameImage> read_color(const std::string& log_folder, std::uint64_t sequence);
// 16-bit PNG in sensor units.
Result<FrameImage> read_raw_depth(const std::string& log_folder, std::uint64_t sequence);

// Millimetres from the camera.
struct DepthRange_mm {
  std::int64_t nearest = 0, farthest = 0;
};

struct DepthView {
  FrameImage image;
  DepthRange_mm shown;     // what red and blue stand for
  DepthRange_mm measured;  // in this frame, without outliers (extent_of); zeros: nothing was
  double valid_share = 0;  // of the pixels: was measured
};

// Without `shown` the colours are spread over what was measured.
Result<DepthView> read_depth(const std::string& log_folder, std::uint64_t sequence,
                             const std::optional<DepthRange_mm>& shown);

enum class FrameFate {
  kUnknown,  // the scan has no results, or is of an older server
  kTracked,
  kWeak,
  kLost,
  kLeftOut,  // there was no time for it
  kRefused,  // its time was not after that of the frame before
  kDamaged,  // on the disk
};
// "unknown", "tracked", "weak", "lost", "left_out", "refused", "damaged".
const char* name_of(FrameFate fate);

struct ListedFrame {
  std::optional<double> timestamp_s;  // none: refused or damaged
  FrameFate fate = FrameFate::kUnknown;
  // Reason of a weak or lost frame; older servers have kept none.
  std::uint16_t reason = pipeline::kNoReason;
};

struct FrameList {
  std::vector<ListedFrame> frames;  // by sequence
  int width = 0, height = 0;        // pixels
  double depth_units_per_metre = 0;
  pipeline::ReasonTable reasons;
};

// Reads a page of the disk for each frame. kCorruptData: the log does not begin as one of a scan.
Result<FrameList> list_frames(const std::string& log_folder, Blobs& blobs,
                              const std::string& scan_id);

}  // namespace hermite::server
