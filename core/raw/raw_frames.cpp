#include "core/raw/raw_frames.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <climits>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <system_error>

namespace hermite {

namespace {

static_assert(std::endian::native == std::endian::little, "the file is written as memory lies");

constexpr std::array<char, 8> kMagic{'H', 'R', 'M', 'F', 'R', 'A', 'M', 'E'};
// 1, and these for what stands behind the header.
constexpr std::uint32_t kPlainVersion = 1, kWithColorCamera = 1, kWithDepthCorrection = 2,
                        kWithTiming = 4, kLastVersion = 8;

struct Header {
  std::array<char, 8> magic = kMagic;
  std::uint32_t version = kPlainVersion;
  std::uint32_t width = 0, height = 0;
  std::uint32_t frame_count = 0;
  double fx = 0, fy = 0, cx = 0, cy = 0;
  double depth_units_per_metre = 0;
  double k1 = 0, k2 = 0, p1 = 0, p2 = 0, k3 = 0;
};
static_assert(sizeof(Header) == 8 + 4 * 4 + 10 * 8, "no padding");

// Behind the header, where the version says so; then two f64 of the correction of depth, and three
// of the timing.
struct ColorHeader {
  double fx = 0, fy = 0, cx = 0, cy = 0;
  double k1 = 0, k2 = 0, p1 = 0, p2 = 0, k3 = 0;
  std::array<double, 4> rotation{};  // x, y, z, w
  std::array<double, 3> translation_m{};
};
static_assert(sizeof(ColorHeader) == 16 * 8, "no padding");

Header header_of(const Camera& camera, std::int64_t frame_count) {
  Header header;
  if (camera.color) header.version += kWithColorCamera;
  if (camera.depth_correction != DepthCorrection{}) header.version += kWithDepthCorrection;
  if (camera.timing != ImageTiming{}) header.version += kWithTiming;
  header.width = static_cast<std::uint32_t>(camera.width);
  header.height = static_cast<std::uint32_t>(camera.height);
  header.frame_count = static_cast<std::uint32_t>(frame_count);
  header.fx = camera.fx;
  header.fy = camera.fy;
  header.cx = camera.cx;
  header.cy = camera.cy;
  header.depth_units_per_metre = camera.depth_units_per_metre;
  header.k1 = camera.distortion.k1;
  header.k2 = camera.distortion.k2;
  header.p1 = camera.distortion.p1;
  header.p2 = camera.distortion.p2;
  header.k3 = camera.distortion.k3;
  return header;
}

Camera camera_of(const Header& header) {
  // What is too large for an int is too large for a camera.
  const auto side_px = [](std::uint32_t value) {
    return static_cast<int>(std::min<std::uint32_t>(value, INT_MAX));
  };
  return {side_px(header.width),
          side_px(header.height),
          header.fx,
          header.fy,
          header.cx,
          header.cy,
          header.depth_units_per_metre,
          {header.k1, header.k2, header.p1, header.p2, header.k3}};
}

ColorHeader header_of(const ColorCamera& color) {
  const Distortion& lens = color.distortion;
  const Eigen::Quaterniond& q = color.color_from_depth.rotation;
  const Eigen::Vector3d& t = color.color_from_depth.translation;
  return {color.fx,
          color.fy,
          color.cx,
          color.cy,
          lens.k1,
          lens.k2,
          lens.p1,
          lens.p2,
          lens.k3,
          {q.x(), q.y(), q.z(), q.w()},
          {t.x(), t.y(), t.z()}};
}

ColorCamera camera_of(const ColorHeader& header) {
  const auto& [x, y, z, w] = header.rotation;
  const auto& [tx, ty, tz] = header.translation_m;
  return {header.fx,
          header.fy,
          header.cx,
          header.cy,
          {header.k1, header.k2, header.p1, header.p2, header.k3},
          {Eigen::Quaterniond(w, x, y, z), {tx, ty, tz}}};
}

std::size_t pixel_count(const Camera& camera) {
  return static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height);
}

// Of valid cameras: at most 20 MiB.
std::int64_t frame_bytes(const Camera& camera) {
  return static_cast<std::int64_t>(sizeof(double) +
                                   pixel_count(camera) * (sizeof(std::uint16_t) + sizeof(Rgb8)));
}

std::string wrong_frame_count(std::int64_t count) {
  return fmt::format("frame_count is {}, allowed is 1 to {}", count, kMaxRawFrames);
}

template <class Value>
bool read_into(std::ifstream& file, Value* values, std::size_t count = 1) {
  return static_cast<bool>(file.read(reinterpret_cast<char*>(values),
                                     static_cast<std::streamsize>(count * sizeof(Value))));
}

template <class Value>
void write_from(std::ofstream& file, const Value* values, std::size_t count = 1) {
  file.write(reinterpret_cast<const char*>(values),
             static_cast<std::streamsize>(count * sizeof(Value)));
}

// Reads what stands between the header of this version and the first frame. Returns the name of the
// part in which the file ends, or null.
const char* read_parts(std::ifstream& file, std::uint32_t version, Camera& camera) {
  const std::uint32_t parts = version - kPlainVersion;
  if ((parts & kWithColorCamera) != 0) {
    ColorHeader color;
    if (!read_into(file, &color)) return "colour camera";
    camera.color = camera_of(color);
  }
  if ((parts & kWithDepthCorrection) != 0) {
    std::array<double, 2> numbers{};
    if (!read_into(file, numbers.data(), numbers.size())) return "correction of depth";
    camera.depth_correction = {numbers[0], numbers[1]};
  }
  if ((parts & kWithTiming) != 0) {
    std::array<double, 3> numbers{};
    if (!read_into(file, numbers.data(), numbers.size())) return "timing of the images";
    camera.timing = {numbers[0], numbers[1], numbers[2]};
  }
  return nullptr;
}

}  // namespace

Error RawFrameWriter::cannot_write() const {
  return {ErrorCode::kIo,
          fmt::format("writing {}: {}", path_,
                      errno != 0 ? std::strerror(errno) : "the file did not take all bytes")};
}

Result<RawFrameWriter> RawFrameWriter::create(const std::string& path, const Camera& camera,
                                              std::int64_t frame_count) {
  if (const Status valid = validate(camera); !valid.ok()) return valid.error();
  if (frame_count < 1 || frame_count > kMaxRawFrames)
    return Error{ErrorCode::kInvalidArgument, wrong_frame_count(frame_count)};
  RawFrameWriter writer;
  writer.path_ = path;
  writer.camera_ = camera;
  writer.frame_count_ = frame_count;
  errno = 0;
  writer.file_.open(path, std::ios::binary | std::ios::trunc);
  const Header header = header_of(camera, frame_count);
  write_from(writer.file_, &header);
  if (camera.color) {
    const ColorHeader color = header_of(*camera.color);
    write_from(writer.file_, &color);
  }
  if (const DepthCorrection& depth = camera.depth_correction; depth != DepthCorrection{}) {
    const std::array<double, 2> numbers{depth.bend, depth.inverse_offset_per_m};
    write_from(writer.file_, numbers.data(), numbers.size());
  }
  if (const ImageTiming& timing = camera.timing; timing != ImageTiming{}) {
    const std::array<double, 3> numbers{timing.depth_readout_s, timing.color_readout_s,
                                        timing.color_delay_s};
    write_from(writer.file_, numbers.data(), numbers.size());
  }
  if (!writer.file_) return writer.cannot_write();
  return writer;
}

Status RawFrameWriter::append(const frame::RgbdFrame& frame) {
  const auto fits = [this](const auto& image) {
    return image.width == camera_.width && image.height == camera_.height;
  };
  if (!fits(frame.depth) || !fits(frame.color))
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("a frame of another size than the camera's, {}x{}", camera_.width,
                             camera_.height)};
  if (written_count_ == frame_count_)
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("{} was to hold {} frames, not one more", path_, frame_count_)};
  errno = 0;
  write_from(file_, &frame.timestamp_s);
  write_from(file_, frame.depth.pixels.data(), frame.depth.pixels.size());
  write_from(file_, frame.color.pixels.data(), frame.color.pixels.size());
  if (!file_) return cannot_write();
  ++written_count_;
  return Done{};
}

Status RawFrameWriter::finish() {
  if (written_count_ != frame_count_)
    return Error{ErrorCode::kInvalidArgument, fmt::format("{} was to hold {} frames and got {}",
                                                          path_, frame_count_, written_count_)};
  errno = 0;
  file_.close();
  if (!file_) return cannot_write();
  return Done{};
}

Error RawFrameReader::corrupt(const std::string& message) const {
  return {ErrorCode::kCorruptData, path_ + ": " + message};
}

Result<RawFrameReader> RawFrameReader::open(const std::string& path) {
  RawFrameReader reader;
  reader.path_ = path;
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error))
    return Error{ErrorCode::kNotFound, "there is no file " + path};
  const auto file_bytes = static_cast<std::int64_t>(std::filesystem::file_size(path, error));
  errno = 0;
  reader.file_.open(path, std::ios::binary);
  if (error || !reader.file_)
    return Error{ErrorCode::kIo, fmt::format("cannot read {}: {}", path, std::strerror(errno))};
  Header header;
  if (!read_into(reader.file_, &header))
    return reader.corrupt(
        fmt::format("only {} bytes, the header alone has {}", file_bytes, sizeof header));
  if (header.magic != kMagic)
    return reader.corrupt("no file of raw frames: it does not begin with HRMFRAME");
  if (header.version < kPlainVersion || header.version > kLastVersion)
    return reader.corrupt(
        fmt::format("version {}, this program reads versions 1 to 8", header.version));
  reader.camera_ = camera_of(header);
  if (const char* cut = read_parts(reader.file_, header.version, reader.camera_))
    return reader.corrupt(fmt::format("only {} bytes, cut in the {}", file_bytes, cut));
  reader.header_bytes_ = static_cast<std::int64_t>(reader.file_.tellg());
  if (const Status valid = validate(reader.camera_); !valid.ok())
    return reader.corrupt(valid.error().message);
  reader.frame_count_ = header.frame_count;
  if (reader.frame_count_ < 1 || reader.frame_count_ > kMaxRawFrames)
    return reader.corrupt(wrong_frame_count(reader.frame_count_));
  const std::int64_t expected_bytes =
      reader.header_bytes_ + reader.frame_count_ * frame_bytes(reader.camera_);
  if (file_bytes != expected_bytes)
    return reader.corrupt(
        fmt::format("{} bytes, {} frames of {}x{} take {}{}", file_bytes, reader.frame_count_,
                    header.width, header.height, expected_bytes,
                    file_bytes < expected_bytes ? ": the file was cut short" : ""));
  return reader;
}

Result<double> RawFrameReader::timestamp_s(std::int64_t index) {
  CHECK(index >= 0 && index < frame_count_, "a frame that the file does not have");
  double time_s = 0;
  file_.seekg(header_bytes_ + index * frame_bytes(camera_));
  if (!read_into(file_, &time_s))
    return Error{ErrorCode::kIo, fmt::format("cannot read frame {} of {}", index, path_)};
  if (!std::isfinite(time_s))
    return corrupt(fmt::format("the time stamp of frame {} is no number", index));
  return time_s;
}

Result<frame::RgbdFrame> RawFrameReader::read(std::int64_t index) {
  const Result<double> time_s = timestamp_s(index);
  if (!time_s.ok()) return time_s.error();
  frame::RgbdFrame frame{*time_s, DepthImage(camera_.width, camera_.height),
                         ColorImage(camera_.width, camera_.height)};
  const bool read = read_into(file_, frame.depth.pixels.data(), frame.depth.pixels.size()) &&
                    read_into(file_, frame.color.pixels.data(), frame.color.pixels.size());
  if (!read) return Error{ErrorCode::kIo, fmt::format("cannot read frame {} of {}", index, path_)};
  return frame;
}

}  // namespace hermite
