#include "server/scan/stored_frames.h"

#include <fmt/core.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <span>
#include <utility>

#include "core/dataset/trajectory.h"
#include "core/image/image_codec.h"
#include "core/log/frame_log_records.h"
#include "core/report/tracking_file.h"
#include "proto/wire/client_message.h"
#include "proto/wire/frame_payload.h"
#include "server/scan/checkpoint_file.h"
#include "server/scan/received_frames.h"
#include "server/scan/scan_record.h"

namespace hermite::server {

namespace {

constexpr int kRenderingQuality = 90;  // of a JPEG
// 400,000 frames have 40 MB of trajectory, and at most 91 MB of what became of them and why.
constexpr std::size_t kMaxPathBytes = std::size_t{256} * 1024 * 1024;

std::span<const std::uint8_t> bytes_of(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

std::string frame_text(std::uint64_t sequence) { return fmt::format("frame {}", sequence); }

Result<ScanRecord> read_record(const std::string& log_folder) {
  const Result<frame_log::LogRecord> terms = frame_log::read_log_record(log_folder, 0),
                                     start = frame_log::read_log_record(log_folder, 1);
  if (!terms.ok()) return terms.error();
  if (!start.ok()) return start.error();
  return parse_scan_record(terms->payload, start->payload);
}

Result<wire::Frame> read_frame(const std::string& log_folder, std::uint64_t sequence) {
  const Error none{ErrorCode::kNotFound,
                   fmt::format("there is no {}: the recording ends before", frame_text(sequence))};
  if (sequence >= kMaxFramesPerScan) return none;
  const Result<frame_log::LogRecord> record =
      frame_log::read_log_record(log_folder, sequence + kRecordsBeforeFrames);
  if (!record.ok())
    return record.error().code == ErrorCode::kNotFound
               ? none
               : in_context(frame_text(sequence), record.error());
  if (record->type == frame_log::RecordType::kFinish) return none;
  if (record->type == frame_log::RecordType::kRefusedFrame)
    return Error{ErrorCode::kNotFound,
                 frame_text(sequence) +
                     " was refused when it came: its time was not after that of the one before"};
  Result<wire::Frame> frame =
      wire::parse_frame_message(record->payload, frame_log::kMaxRecordBytes);
  return frame.ok() ? std::move(frame) : in_context(frame_text(sequence), frame.error());
}

struct FrameDepth {
  DepthImage image;  // sensor units
  double units_per_mm = 1;
};

Result<FrameDepth> decode_depth(const std::string& log_folder, std::uint64_t sequence) {
  const Result<ScanRecord> record = read_record(log_folder);
  if (!record.ok()) return record.error();
  const Result<wire::Frame> frame = read_frame(log_folder, sequence);
  if (!frame.ok()) return frame.error();
  const Camera& camera = record->request.camera;
  Result<DepthImage> depth =
      wire::decode_depth_payload(frame->depth, record->request.depth_codecs.front(), camera);
  if (!depth.ok()) return in_context(frame_text(sequence), depth.error());
  return FrameDepth{*std::move(depth), camera.depth_units_per_metre / 1000};
}

std::uint16_t units_of(std::int64_t depth_mm, double units_per_mm) {
  return static_cast<std::uint16_t>(
      std::clamp<double>(std::round(static_cast<double>(depth_mm) * units_per_mm), 0, 65535));
}

// Rounded outwards.
DepthRange_mm in_mm(const image::DepthRange& range, double units_per_mm) {
  return {static_cast<std::int64_t>(std::floor(range.nearest / units_per_mm)),
          static_cast<std::int64_t>(std::ceil(range.farthest / units_per_mm))};
}

Result<FrameImage> encoded(Result<std::vector<std::uint8_t>> bytes, const char* content_type) {
  if (!bytes.ok()) return bytes.error();
  return FrameImage{{bytes->begin(), bytes->end()}, content_type};
}

FrameFate fate_of(track::TrackingStatus status) {
  switch (status) {
    case track::TrackingStatus::kTracked: return FrameFate::kTracked;
    case track::TrackingStatus::kWeak: return FrameFate::kWeak;
    case track::TrackingStatus::kLost: return FrameFate::kLost;
  }
  return FrameFate::kUnknown;
}

// What is known of frames that were used, in the order of their times. No frames: nothing.
struct Fates {
  std::vector<ListedFrame> frames;
  pipeline::ReasonTable reasons;
};

Fates read_fates(Blobs& blobs, const std::string& scan_id) {
  Fates fates;
  if (const Result<std::string> text = read_blob(blobs, scan_id, "tracking.txt", kMaxPathBytes);
      text.ok()) {
    Result<report::TrackingFile> tracking = report::parse_tracking(*text);
    if (!tracking.ok())
      spdlog::error("tracking.txt of scan {}: {}", scan_id, tracking.error().message);
    if (tracking.ok()) {
      for (const report::TimedStatus& frame : tracking->frames)
        fates.frames.push_back({frame.timestamp_s, fate_of(frame.status), frame.reason});
      fates.reasons = std::move(tracking->reasons);
    }
  }
  if (!fates.frames.empty()) return fates;
  // Older servers have kept no more than where the camera was.
  const Result<std::string> text = read_blob(blobs, scan_id, "trajectory.txt", kMaxPathBytes);
  const Result<dataset::Trajectory> trajectory =
      text.ok() ? dataset::parse_tum_trajectory(*text) : text.error();
  if (trajectory.ok())
    for (const dataset::TimedPose& pose : *trajectory)
      fates.frames.push_back({pose.timestamp_s, FrameFate::kUnknown, pipeline::kNoReason});
  return fates;
}

// Both are in the order of their times.
void add_fates(std::vector<ListedFrame>& frames, const std::vector<ListedFrame>& fates) {
  constexpr double kSameTime_s = 1e-6;  // what is written has so many digits
  auto next = fates.begin();
  for (ListedFrame& frame : frames) {
    if (!frame.timestamp_s || fates.empty()) continue;
    while (next != fates.end() && *next->timestamp_s < *frame.timestamp_s - kSameTime_s) ++next;
    const bool was_used =
        next != fates.end() && *next->timestamp_s <= *frame.timestamp_s + kSameTime_s;
    frame.fate = was_used ? next->fate : FrameFate::kLeftOut;
    if (was_used) frame.reason = (next++)->reason;
  }
}

std::optional<double> time_of(const frame_log::LogRecordHead& head) {
  if (const std::optional<double> time_s = wire::frame_time_in(head.beginning)) return time_s;
  // The first frame of many a recording: a time of 0 is not written. Or an encoder with an order of
  // its own.
  const Result<frame_log::LogRecord> record = head.read();
  const Result<wire::Frame> frame =
      record.ok() ? wire::parse_frame_message(record->payload, frame_log::kMaxRecordBytes)
                  : record.error();
  return frame.ok() ? std::optional(frame->timestamp_s) : std::nullopt;
}

}  // namespace

bool are_frames_kept(const std::string& log_folder) {
  std::error_code ignored;
  return std::filesystem::exists(log_folder + "/" + frame_log::segment_name(0), ignored);
}

Result<FrameImage> read_color(const std::string& log_folder, std::uint64_t sequence) {
  Result<wire::Frame> frame = read_frame(log_folder, sequence);
  if (!frame.ok()) return frame.error();
  const Result<image::ImageFormat> format = image::detect_image_format(bytes_of(frame->color));
  if (!format.ok())
    return Error{ErrorCode::kCorruptData,
                 fmt::format("{} came without a colour image: {}", frame_text(sequence),
                             format.error().message)};
  return FrameImage{std::move(frame->color),
                    *format == image::ImageFormat::kJpeg ? "image/jpeg" : "image/png"};
}

Result<FrameImage> read_raw_depth(const std::string& log_folder, std::uint64_t sequence) {
  const Result<FrameDepth> depth = decode_depth(log_folder, sequence);
  return depth.ok() ? encoded(image::encode_depth_png(depth->image), "image/png") : depth.error();
}

Result<DepthView> read_depth(const std::string& log_folder, std::uint64_t sequence,
                             const std::optional<DepthRange_mm>& shown) {
  const Result<FrameDepth> depth = decode_depth(log_folder, sequence);
  if (!depth.ok()) return depth.error();
  const image::DepthExtent extent = image::extent_of(depth->image);
  DepthView view;
  view.measured = in_mm(extent.range, depth->units_per_mm);
  view.shown = shown.value_or(view.measured);
  view.valid_share = extent.valid_share;
  const image::DepthRange range{units_of(view.shown.nearest, depth->units_per_mm),
                                units_of(view.shown.farthest, depth->units_per_mm)};
  Result<FrameImage> image = encoded(image::encode_jpeg(image::depth_rendering(depth->image, range),
                                                        kRenderingQuality, image::JpegColor::kFull),
                                     "image/jpeg");
  if (!image.ok()) return image.error();
  view.image = *std::move(image);
  return view;
}

const char* name_of(FrameFate fate) {
  switch (fate) {
    case FrameFate::kUnknown: return "unknown";
    case FrameFate::kTracked: return "tracked";
    case FrameFate::kWeak: return "weak";
    case FrameFate::kLost: return "lost";
    case FrameFate::kLeftOut: return "left_out";
    case FrameFate::kRefused: return "refused";
    case FrameFate::kDamaged: return "damaged";
  }
  return "";
}

Result<FrameList> list_frames(const std::string& log_folder, Blobs& blobs,
                              const std::string& scan_id) {
  const Result<ScanRecord> record = read_record(log_folder);
  if (!record.ok()) return record.error();
  const Camera& camera = record->request.camera;
  FrameList list{{}, camera.width, camera.height, camera.depth_units_per_metre, {}};
  const Status visited = frame_log::visit_log_records(
      log_folder, wire::kFrameTimeBytes, [&list](const frame_log::LogRecordHead& head) {
        const bool is_frame = head.type == frame_log::RecordType::kFrame ||
                              head.type == frame_log::RecordType::kRefusedFrame;
        const std::uint64_t first_possible = list.frames.size() + kRecordsBeforeFrames;
        if (!is_frame || head.number < first_possible ||
            head.number >= kMaxFramesPerScan + kRecordsBeforeFrames)
          return;
        // Those that are missing in between.
        list.frames.resize(head.number - kRecordsBeforeFrames,
                           {std::nullopt, FrameFate::kDamaged, pipeline::kNoReason});
        list.frames.push_back({std::nullopt, FrameFate::kRefused, pipeline::kNoReason});
        if (head.type == frame_log::RecordType::kRefusedFrame) return;
        list.frames.back().timestamp_s = time_of(head);
        list.frames.back().fate =
            list.frames.back().timestamp_s ? FrameFate::kUnknown : FrameFate::kDamaged;
      });
  if (!visited.ok()) return visited.error();
  Fates fates = read_fates(blobs, scan_id);
  add_fates(list.frames, fates.frames);
  list.reasons = std::move(fates.reasons);
  return list;
}

}  // namespace hermite::server
