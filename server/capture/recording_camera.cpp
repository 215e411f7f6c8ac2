#include "server/capture/recording_camera.h"

#include <algorithm>
#include <thread>
#include <utility>

namespace hermite::client {
namespace {

using Clock = std::chrono::steady_clock;

class RecordingCamera final : public CaptureCamera {
 public:
  explicit RecordingCamera(std::unique_ptr<dataset::Sequence> sequence)
      : sequence_(std::move(sequence)),
        description_{sequence_->name(), sequence_->camera(), "the recording",
                     sequence_->frame_rate_hz()} {}

  const CameraDescription& description() const override { return description_; }

  Result<std::optional<frame::RgbdFrame>> next(std::chrono::milliseconds patience) override {
    if (next_ >= sequence_->frame_count())
      return Error{ErrorCode::kNotFound, "the recording is at its end"};
    if (!started_at_) started_at_ = Clock::now();
    const double after_s = sequence_->timestamp_s(next_) - sequence_->timestamp_s(0);
    const auto due = *started_at_ + std::chrono::duration_cast<Clock::duration>(
                                        std::chrono::duration<double>(after_s));
    const auto deadline = Clock::now() + patience;
    std::this_thread::sleep_until(std::min(due, deadline));
    if (due > deadline) return std::optional<frame::RgbdFrame>();
    auto recorded = sequence_->read(next_++);
    if (!recorded.ok()) return std::optional<frame::RgbdFrame>();
    Result<frame::RgbdFrame> frame = dataset::decode_frame(*std::move(recorded));
    if (!frame.ok()) return std::optional<frame::RgbdFrame>();
    return std::optional<frame::RgbdFrame>(*std::move(frame));
  }

 private:
  const std::unique_ptr<dataset::Sequence> sequence_;
  const CameraDescription description_;
  std::int64_t next_ = 0;
  std::optional<Clock::time_point> started_at_;
};

}  // namespace

std::unique_ptr<CaptureCamera> play_recording(std::unique_ptr<dataset::Sequence> sequence) {
  return std::make_unique<RecordingCamera>(std::move(sequence));
}

}  // namespace hermite::client
