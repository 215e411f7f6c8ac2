#include "core/dataset/write_klg.h"

#include <fmt/core.h>

#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "core/dataset/camera_file.h"
#include "core/dataset/remarks.h"
#include "core/dataset/text_file.h"
#include "core/image/image_codec.h"
#include "core/image/inflate.h"

namespace hermite::dataset {
namespace {

constexpr double kMillimetres = 1000;

Error cannot_write(const std::string& path) {
  return {ErrorCode::kIo, fmt::format("writing {}: {}", path, std::strerror(errno))};
}

Status write_text(const std::string& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.close();
  if (!file) return cannot_write(path);
  return Done{};
}

class KlgWriter {
 public:
  KlgWriter(std::string path, double depth_units_per_metre)
      : path_(std::move(path)),
        to_millimetres_(kMillimetres / depth_units_per_metre),
        file_(path_, std::ios::binary | std::ios::trunc) {
    put(count_);
  }

  Status append(RecordedFrame frame) {
    const double stamp_us = std::round(frame.timestamp_s * 1e6);
    // Larger numbers of microseconds are not all exact as a double.
    if (!(std::abs(stamp_us) < 9e15))
      return Error{ErrorCode::kInvalidArgument,
                   fmt::format("the time {:f} s does not fit", frame.timestamp_s)};
    rounded_time_ = rounded_time_ || stamp_us / 1e6 != frame.timestamp_s;
    to_millimetres(frame.depth);
    const auto format = image::detect_image_format(frame.color_bytes);
    if (!format.ok()) return format.error();
    std::vector<std::uint8_t> color = std::move(frame.color_bytes);
    if (*format != image::ImageFormat::kJpeg) {
      const auto image = image::decode_color(color, {frame.depth.width, frame.depth.height});
      if (!image.ok()) return image.error();
      color.resize(image->pixels.size() * sizeof(Rgb8));
      std::memcpy(color.data(), image->pixels.data(), color.size());
    }
    const auto* values = reinterpret_cast<const std::uint8_t*>(frame.depth.pixels.data());
    const std::vector<std::uint8_t> depth =
        image::deflate_bytes({values, frame.depth.pixels.size() * sizeof(std::uint16_t)});
    put(static_cast<std::int64_t>(stamp_us));
    put(static_cast<std::int32_t>(depth.size()));
    put(static_cast<std::int32_t>(color.size()));
    file_.write(reinterpret_cast<const char*>(depth.data()),
                static_cast<std::streamsize>(depth.size()));
    file_.write(reinterpret_cast<const char*>(color.data()),
                static_cast<std::streamsize>(color.size()));
    if (!file_) return cannot_write(path_);
    ++count_;
    return Done{};
  }

  Status finish() {
    file_.seekp(0);
    put(count_);
    file_.close();
    if (!file_) return cannot_write(path_);
    return Done{};
  }

  std::int32_t count() const { return count_; }

  std::vector<std::string> remarks() const {
    std::vector<std::string> remarks;
    if (to_millimetres_ != 1)
      remarks.push_back("depth was rounded to millimetres, which the format has");
    if (too_far_ > 0)
      remarks.push_back(std::to_string(too_far_) + " depths beyond 65.535 m were left out");
    if (rounded_time_)
      remarks.push_back("times were rounded to microseconds, which the format has");
    return remarks;
  }

 private:
  template <class Value>
  void put(Value value) {
    file_.write(reinterpret_cast<const char*>(&value), sizeof value);
  }

  void to_millimetres(DepthImage& depth) {
    if (to_millimetres_ == 1) return;
    for (std::uint16_t& value : depth.pixels) {
      const double millimetres = std::round(value * to_millimetres_);
      too_far_ += millimetres > 65535 ? 1 : 0;
      value = millimetres > 65535 ? std::uint16_t{0} : static_cast<std::uint16_t>(millimetres);
    }
  }

  const std::string path_;
  const double to_millimetres_;
  std::ofstream file_;
  std::int32_t count_ = 0;
  std::int64_t too_far_ = 0;
  bool rounded_time_ = false;
};

Status write_beside(const Sequence& sequence, const std::string& path) {
  Camera camera = sequence.camera();
  camera.depth_units_per_metre = kMillimetres;
  const Status status = write_text(path + ".camera.json",
                                   format_camera_json({camera, sequence.frame_rate_hz(), true}));
  if (!status.ok() || sequence.groundtruth().empty()) return status;
  return write_text(path + ".groundtruth.txt", format_tum_trajectory(sequence.groundtruth()));
}

}  // namespace

Result<WriteSummary> write_klg(const Sequence& sequence, FrameRange range, const std::string& path,
                               const WriteProgress& progress) {
  if (std::filesystem::exists(path))
    return Error{ErrorCode::kInvalidArgument, path + " exists already"};
  KlgWriter writer(path, sequence.camera().depth_units_per_metre);
  Remarks left_out("frames that cannot be read are left out");
  for (std::int64_t i = range.begin; i < range.end; ++i) {
    Result<RecordedFrame> frame = sequence.read(i);
    const Status status = frame.ok() ? writer.append(*std::move(frame)) : Status(frame.error());
    if (!status.ok() && status.error().code == ErrorCode::kIo && frame.ok()) return status.error();
    if (!status.ok()) left_out.add(status.error().message);
    progress(i - range.begin + 1);
  }
  if (writer.count() == 0)
    return Error{ErrorCode::kCorruptData,
                 "not one frame could be written: " + left_out.lines().at(1)};
  if (const Status status = writer.finish(); !status.ok()) return status.error();
  if (const Status status = write_beside(sequence, path); !status.ok()) return status.error();
  WriteSummary summary{writer.count(), writer.remarks()};
  for (const std::string& line : left_out.lines()) summary.remarks.push_back(line);
  return summary;
}

}  // namespace hermite::dataset
