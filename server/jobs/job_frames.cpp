#include "server/jobs/job_frames.h"

#include <fmt/core.h>

#include <utility>

#include "core/log/frame_log_reader.h"
#include "proto/wire/client_message.h"
#include "server/client/frame_encoder.h"
#include "server/scan/scan_record.h"

namespace hermite::server {

namespace {

class FramesOfRecording : public JobFrames {
 public:
  FramesOfRecording(dataset::Recording recording, wire::StartScan request)
      : recording_(std::move(recording)), request_(std::move(request)) {
    const dataset::Sequence& sequence = *recording_.sequence;
    // Any lossless codec gives the same result, and nothing is sent over a network: take the one
    // that needs no trial.
    request_.depth_codecs = {wire::DepthCodec::kRvlZstd};
    request_.color_codecs = {wire::ColorCodec::kJpeg, wire::ColorCodec::kPng};
    request_.mode = wire::Mode::kBatch;
    request_.camera = sequence.camera();
    request_.expected_frames = static_cast<std::uint64_t>(sequence.frame_count());
    remarks_ = recording_.doubts;
    remarks_.insert(
        remarks_.begin(),
        fmt::format("{} ({}), {} frames of {}x{}, camera: {}", sequence.format(),
                    recording_.format_reason, sequence.frame_count(), request_.camera.width,
                    request_.camera.height, recording_.camera_source));
  }
  const wire::StartScan& request() const override { return request_; }
  Result<std::optional<wire::Frame>> next() override {
    if (index_ >= recording_.sequence->frame_count()) return std::optional<wire::Frame>();
    client::EncodedFrame encoded =
        client::encode_frame(*recording_.sequence, index_, {wire::DepthCodec::kRvlZstd, true});
    encoded.frame.sequence = static_cast<std::uint64_t>(index_++);
    if (!encoded.problem.empty()) remarks_.push_back(std::move(encoded.problem));
    return std::optional<wire::Frame>(std::move(encoded.frame));
  }
  Status skip(std::uint64_t frame_count) override {
    index_ += static_cast<std::int64_t>(frame_count);
    return Done{};
  }
  std::vector<std::string> take_remarks() override { return std::exchange(remarks_, {}); }

 private:
  const dataset::Recording recording_;
  wire::StartScan request_;
  std::vector<std::string> remarks_;
  std::int64_t index_ = 0;
};

class FramesOfLog : public JobFrames {
 public:
  FramesOfLog(const std::string& folder, wire::StartScan request)
      : log_(folder), request_(std::move(request)) {}

  Status read_start(std::uint64_t frame_count) {
    const Result<std::optional<frame_log::LogRecord>> terms = log_.next(), start = log_.next();
    if (!terms.ok()) return terms.error();
    if (!start.ok()) return start.error();
    if (!*terms || !*start)
      return Error{ErrorCode::kNotFound, "the frames of the scan are not kept any more"};
    Result<ScanRecord> record = parse_scan_record((*terms)->payload, (*start)->payload);
    if (!record.ok()) return record.error();
    request_.camera = record->request.camera;
    request_.depth_codecs = {record->request.depth_codecs.front()};
    request_.color_codecs = record->request.color_codecs;
    request_.mode = wire::Mode::kBatch;
    request_.expected_frames = frame_count;
    return Done{};
  }
  const wire::StartScan& request() const override { return request_; }
  Result<std::optional<wire::Frame>> next() override {
    for (;;) {
      Result<std::optional<frame_log::LogRecord>> record = log_.next();
      if (!record.ok()) return record.error();
      if (!*record) return std::optional<wire::Frame>();
      if ((*record)->type != frame_log::RecordType::kFrame) continue;
      Result<wire::Frame> frame =
          wire::parse_frame_message((*record)->payload, frame_log::kMaxRecordBytes);
      if (!frame.ok()) return in_context("a record of the frame log", frame.error());
      // Frames that the old scan refused leave no gap in the numbering.
      frame->sequence = sequence_++;
      return std::optional<wire::Frame>(*std::move(frame));
    }
  }
  Status skip(std::uint64_t frame_count) override {
    while (sequence_ < frame_count) {
      const Result<std::optional<wire::Frame>> frame = next();
      if (!frame.ok()) return frame.error();
      if (!*frame) return Error{ErrorCode::kCorruptData, "the frame log has become shorter"};
    }
    return Done{};
  }
  std::vector<std::string> take_remarks() override { return {}; }

 private:
  frame_log::FrameLogReader log_;
  wire::StartScan request_;
  std::uint64_t sequence_ = 0;
};

}  // namespace

std::unique_ptr<JobFrames> recorded_frames(dataset::Recording recording, wire::StartScan request) {
  return std::make_unique<FramesOfRecording>(std::move(recording), std::move(request));
}

Result<std::unique_ptr<JobFrames>> logged_frames(const std::string& log_folder,
                                                 std::uint64_t frame_count,
                                                 const wire::StartScan& request) {
  auto frames = std::make_unique<FramesOfLog>(log_folder, request);
  if (Status status = frames->read_start(frame_count); !status.ok()) return status.error();
  return std::unique_ptr<JobFrames>(std::move(frames));
}

}  // namespace hermite::server
