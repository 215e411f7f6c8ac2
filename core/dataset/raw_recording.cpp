// Our own raw frames, core/raw/raw_frames.h. They are not compressed; colour is passed on as PNG.
#include <fmt/core.h>

#include <array>
#include <filesystem>
#include <mutex>

#include "core/dataset/byte_file.h"
#include "core/dataset/camera_file.h"
#include "core/dataset/recording.h"
#include "core/image/image_codec.h"
#include "core/raw/raw_frames.h"

namespace hermite::dataset {
namespace {

class RawSequence : public Sequence {
 public:
  RawSequence(std::string path, RawFrameReader reader, Camera camera, std::vector<double> times_s)
      : path_(std::move(path)),
        camera_(std::move(camera)),
        times_s_(std::move(times_s)),
        reader_(std::move(reader)) {}

  std::string format() const override { return "raw"; }
  std::string name() const override { return std::filesystem::path(path_).stem().string(); }
  const Camera& camera() const override { return camera_; }
  double frame_rate_hz() const override { return kDefaultFrameRate_hz; }
  std::int64_t frame_count() const override { return static_cast<std::int64_t>(times_s_.size()); }
  double timestamp_s(std::int64_t index) const override {
    return times_s_.at(static_cast<std::size_t>(index));
  }
  const Trajectory& groundtruth() const override { return none_; }

  Result<RecordedFrame> read(std::int64_t index) const override {
    Result<frame::RgbdFrame> frame = [&] {
      const std::lock_guard lock(reading_);
      return reader_.read(index);
    }();
    if (!frame.ok()) return frame.error();
    auto color = image::encode_png(frame->color);
    if (!color.ok()) return color.error();
    return RecordedFrame{timestamp_s(index), std::move(frame->depth), std::move(*color)};
  }

 private:
  const std::string path_;
  const Camera camera_;
  const std::vector<double> times_s_;
  const Trajectory none_;
  mutable std::mutex reading_;  // the reader has a single position in its file
  mutable RawFrameReader reader_;
};

}  // namespace

std::optional<std::string> probe_raw(const std::string& path) {
  constexpr std::array<char, 8> kMagic{'H', 'R', 'M', 'F', 'R', 'A', 'M', 'E'};
  const Result<ByteFile> file = ByteFile::open(path);
  std::array<char, 8> start{};
  if (!file.ok() || !file->read_into(0, start.data(), start.size()).ok() || start != kMagic)
    return std::nullopt;
  return "it begins with HRMFRAME (our raw frames)";
}

Result<Recording> open_raw(const std::string& path, const std::optional<Camera>& given) {
  Result<RawFrameReader> reader = RawFrameReader::open(path);
  if (!reader.ok()) return reader.error();
  const Camera own = reader->camera();
  if (given && (given->width != own.width || given->height != own.height))
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("{}: its images have {}x{} pixels, the camera {}x{}", path, own.width,
                             own.height, given->width, given->height)};
  std::vector<double> times_s;
  for (std::int64_t i = 0; i < reader->frame_count(); ++i) {
    const Result<double> time_s = reader->timestamp_s(i);
    if (!time_s.ok()) return time_s.error();
    if (!times_s.empty() && *time_s <= times_s.back())
      return Error{ErrorCode::kCorruptData,
                   fmt::format("{}: the time of frame {} is not after the one before", path, i)};
    times_s.push_back(*time_s);
  }
  Recording recording;
  recording.camera_source = given ? "given" : "the file's header";
  recording.sequence = std::make_unique<RawSequence>(path, std::move(*reader), given.value_or(own),
                                                     std::move(times_s));
  return recording;
}

}  // namespace hermite::dataset
