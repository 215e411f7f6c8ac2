#include "core/dataset/write_frame_log.h"

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <thread>

#include "core/dataset/remarks.h"
#include "core/log/frame_log.h"
#include "proto/wire/client_message.h"
#include "proto/wire/frame_payload.h"

namespace hermite::dataset {
namespace {

// Supported by every version and server.
constexpr wire::DepthCodec kCodec = wire::DepthCodec::kRvlZstd;
// There is no server that could set terms.
constexpr const char* kTerms = "{}";
constexpr std::chrono::milliseconds kDiskPause(10);

std::string start_message(const Sequence& sequence) {
  wire::StartScan start;
  start.title = sequence.name();
  start.camera = sequence.camera();
  start.depth_codecs = {kCodec};
  start.color_codecs = {wire::ColorCodec::kJpeg, wire::ColorCodec::kPng};
  return wire::format_client_message(
      wire::Hello{wire::kProtocolMinor, "hermite convert", "", std::move(start)});
}

// The log never waits for its disk, so this function does.
Status append(frame_log::FrameLog& log, const std::string& payload) {
  for (;;) {
    Status status = log.append(frame_log::RecordType::kFrame, payload);
    if (status.ok() || status.error().code != ErrorCode::kBusy) return status;
    std::this_thread::sleep_for(kDiskPause);
  }
}

Status append_frame(frame_log::FrameLog& log, const RecordedFrame& frame, std::int64_t number) {
  auto depth = wire::encode_depth_payload(frame.depth, kCodec);
  if (!depth.ok()) return depth.error();
  return append(log, wire::format_client_message(
                         wire::Frame{static_cast<std::uint64_t>(number),
                                     frame.timestamp_s,
                                     *std::move(depth),
                                     {frame.color_bytes.begin(), frame.color_bytes.end()},
                                     frame.acceleration_m_s2}));
}

}  // namespace

Result<WriteSummary> write_frame_log(const Sequence& sequence, FrameRange range,
                                     const std::string& folder, const WriteProgress& progress) {
  if (std::error_code ignored; std::filesystem::exists(folder, ignored))
    return Error{ErrorCode::kInvalidArgument, folder + " exists already"};
  std::optional<Error> failure;  // written by the log's thread, and read when that has ended
  auto log = frame_log::FrameLog::create(
      folder, kTerms, start_message(sequence),
      {.durable = [](std::uint64_t) {}, .failed = [&](const Error& error) { failure = error; }});
  if (!log.ok()) return log.error();
  WriteSummary summary;
  Remarks left_out("frames that cannot be read are left out");
  for (std::int64_t i = range.begin; i < range.end; ++i) {
    const Result<RecordedFrame> frame = sequence.read(i);
    if (!frame.ok()) {
      left_out.add(frame.error().message);
    } else if (const Status status = append_frame(**log, *frame, summary.frame_count++);
               !status.ok()) {
      return status.error();
    }
    progress(i - range.begin + 1);
  }
  // Fails only after the disk has failed.
  static_cast<void>((*log)->append(frame_log::RecordType::kFinish, {}));
  log->reset();
  if (failure) return *failure;
  summary.remarks = left_out.lines();
  if (summary.frame_count == 0)
    return Error{ErrorCode::kCorruptData,
                 "not one frame could be read: " + summary.remarks.front()};
  return summary;
}

}  // namespace hermite::dataset
