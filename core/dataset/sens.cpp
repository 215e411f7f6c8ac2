// .sens, ScanNet's container, version 4. Little endian, nothing between the fields:
//   u32 version (4), u64 length and that many bytes of the sensor's name
//   f32[16] each, row by row: colour intrinsics, colour extrinsics, depth intrinsics, depth
//       extrinsics
//   i32 colour coding (0 raw, 1 PNG, 2 JPEG), i32 depth coding (0 raw, 1 zlib; 2 is of the
//       Occipital SDK and unsupported)
//   u32 colour width, height, depth width, height; f32 depth units per metre; u64 num_frames
//   each frame: f32[16] world_from_camera, u64 colour and depth time stamp [us], u64 colour and
//               depth size, colour bytes, depth bytes
//   u64 number of IMU frames of 128 bytes each, which are ignored
// Extrinsics transform each camera to a common coordinate frame. Colour is resized to the size of
// depth; if both then have the same camera within half a pixel, depth counts as registered, as in
// the published scans.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/dataset/camera_file.h"
#include "core/dataset/frame_file.h"
#include "core/dataset/pose_matrix.h"

namespace hermite::dataset {
namespace {

using Matrix = std::array<float, 16>;

constexpr std::uint32_t kVersion = 4;
constexpr std::int64_t kMaxSensorName_bytes = 1000;
constexpr std::int64_t kMinFrame_bytes = 16 * 4 + 4 * 8 + 1;
constexpr double kSameCamera_px = 0.5;
enum class ColorCoding : std::int32_t { kRaw, kPng, kJpeg };
enum class DepthCoding : std::int32_t { kRaw, kZlib };

struct Header {
  // Colour intrinsics, extrinsics, depth intrinsics, extrinsics.
  std::array<Matrix, 4> calibration{};
  std::int32_t color_coding = 0, depth_coding = 0;
  std::array<std::uint32_t, 4> sizes{};  // colour width, height, depth width, height
  float depth_units_per_metre = 0;
  std::uint64_t frame_count = 0;
};

struct SensFrame {
  Matrix world_from_camera;
  std::int64_t stamp = 0;
  FilePart depth, color;
};

// Reads the next field into `to`.
template <class Value>
Status take(FieldReader& fields, const char* name, Value& to) {
  const Result<Value> value = fields.read<Value>(name);
  if (!value.ok()) return value.error();
  to = *value;
  return Done{};
}

Status read_name(FieldReader& fields) {
  std::uint32_t version = 0;
  if (const Status status = take(fields, "version", version); !status.ok()) return status;
  if (version != kVersion)
    return fields.error("version", fmt::format("is {}, only 4 is read", version));
  std::uint64_t name_bytes = 0;
  if (const Status status = take(fields, "sensor name length", name_bytes); !status.ok())
    return status;
  const auto length = static_cast<std::int64_t>(std::min<std::uint64_t>(name_bytes, INT64_MAX));
  const auto name = fields.skip("sensor name length", length, 0, kMaxSensorName_bytes);
  if (!name.ok()) return name.error();
  return Done{};
}

Status check_sizes(FieldReader& fields, const Header& header) {
  const auto inside = [](std::uint32_t side, int max) {
    return side >= kMinImageSide_px && side <= static_cast<std::uint32_t>(max);
  };
  const auto& [color_width, color_height, depth_width, depth_height] = header.sizes;
  if (!inside(color_width, kMaxStoredColorSide_px) || !inside(color_height, kMaxStoredColorSide_px))
    return fields.error("colour size",
                        fmt::format("is {}x{}, allowed is {} to {}", color_width, color_height,
                                    kMinImageSide_px, kMaxStoredColorSide_px));
  if (!inside(depth_width, kMaxImageSide_px) || !inside(depth_height, kMaxImageSide_px))
    return fields.error("depth size",
                        fmt::format("is {}x{}, allowed is {} to {}", depth_width, depth_height,
                                    kMinImageSide_px, kMaxImageSide_px));
  return Done{};
}

Result<Header> read_header(FieldReader& fields) {
  if (const Status status = read_name(fields); !status.ok()) return status.error();
  Header header;
  if (const Status status = take(fields, "calibration", header.calibration); !status.ok())
    return status.error();
  if (const Status status = take(fields, "colour coding", header.color_coding); !status.ok())
    return status.error();
  if (header.color_coding < 0 || header.color_coding > static_cast<int>(ColorCoding::kJpeg))
    return fields.error("colour coding", fmt::format("is {}, known are 0 (raw), 1 (PNG), 2 (JPEG)",
                                                     header.color_coding));
  if (const Status status = take(fields, "depth coding", header.depth_coding); !status.ok())
    return status.error();
  if (header.depth_coding < 0 || header.depth_coding > static_cast<int>(DepthCoding::kZlib))
    return fields.error("depth coding",
                        fmt::format("is {}, known are 0 (raw) and 1 (zlib)", header.depth_coding));
  if (const Status status = take(fields, "image sizes", header.sizes); !status.ok())
    return status.error();
  if (const Status status = check_sizes(fields, header); !status.ok()) return status.error();
  if (const Status status = take(fields, "depth units per metre", header.depth_units_per_metre);
      !status.ok())
    return status.error();
  if (const Status status = take(fields, "num_frames", header.frame_count); !status.ok())
    return status.error();
  const std::uint64_t room = fields.remaining() / kMinFrame_bytes;
  if (header.frame_count < 1 || header.frame_count > static_cast<std::uint64_t>(kMaxFileFrames) ||
      header.frame_count > room)
    return fields.error("num_frames",
                        fmt::format("is {}, the file has room for {}, allowed are 1 to {}",
                                    header.frame_count, room, kMaxFileFrames));
  return header;
}

Result<SensFrame> read_frame(FieldReader& fields, const Header& header) {
  SensFrame frame;
  if (const Status status = take(fields, "camera to world", frame.world_from_camera); !status.ok())
    return status.error();
  std::array<std::uint64_t, 4> numbers{};
  if (const Status status = take(fields, "time stamps and sizes", numbers); !status.ok())
    return status.error();
  for (std::uint64_t& number : numbers) number = std::min<std::uint64_t>(number, INT64_MAX);
  const auto& [color_stamp, depth_stamp, color_bytes, depth_bytes] = numbers;
  frame.stamp = static_cast<std::int64_t>(depth_stamp);
  const auto color =
      fields.skip("colour size", static_cast<std::int64_t>(color_bytes), 0, kMaxColorPart_bytes);
  if (!color.ok()) return color.error();
  const std::uint64_t raw_bytes = std::uint64_t{2} * header.sizes[2] * header.sizes[3];
  if (header.depth_coding == static_cast<int>(DepthCoding::kRaw) && depth_bytes != raw_bytes)
    return fields.error("depth size",
                        fmt::format("is {}, a raw image has {}", depth_bytes, raw_bytes));
  const auto depth =
      fields.skip("depth size", static_cast<std::int64_t>(depth_bytes), 1, kMaxDepthPart_bytes);
  if (!depth.ok()) return depth.error();
  frame.color = *color;
  frame.depth = *depth;
  return frame;
}

Eigen::Matrix4d matrix_of(const Matrix& values) {
  Eigen::Matrix4d matrix;
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column)
      matrix(row, column) = values[static_cast<std::size_t>(4 * row + column)];
  return matrix;
}

// Zeros mean "unknown" in files of other programs.
Result<Rigid3> extrinsics_of(const Matrix& values, const char* field) {
  const bool is_unknown =
      std::all_of(values.begin(), values.end(), [](float value) { return value == 0; });
  if (is_unknown) return Rigid3{};
  const std::optional<Rigid3> pose = rigid_pose(matrix_of(values));
  if (!pose)
    return Error{ErrorCode::kCorruptData,
                 std::string(field) + ": this matrix is not a rigid transform"};
  return *pose;
}

// Returns the largest difference between the pixels in which the two cameras see a point at
// infinity, at the corners of the image.
double disparity_px(const Camera& depth, const ColorCamera& color) {
  double worst_px = 0;
  for (const double u : {0.0, depth.width - 1.0})
    for (const double v : {0.0, depth.height - 1.0}) {
      const double du = (u - depth.cx) / depth.fx * color.fx + color.cx - u,
                   dv = (v - depth.cy) / depth.fy * color.fy + color.cy - v;
      worst_px = std::max({worst_px, std::abs(du), std::abs(dv)});
    }
  return worst_px;
}

Result<Camera> camera_of(const Header& header) {
  const auto& [color_in, color_ex, depth_in, depth_ex] = header.calibration;
  const auto& [color_width, color_height, depth_width, depth_height] = header.sizes;
  Camera camera{static_cast<int>(depth_width),
                static_cast<int>(depth_height),
                depth_in[0],
                depth_in[5],
                depth_in[2],
                depth_in[6],
                header.depth_units_per_metre};
  const double sx = static_cast<double>(depth_width) / color_width,
               sy = static_cast<double>(depth_height) / color_height;
  ColorCamera color{color_in[0] * sx, color_in[5] * sy, (color_in[2] + 0.5) * sx - 0.5,
                    (color_in[6] + 0.5) * sy - 0.5};
  const auto from_color = extrinsics_of(color_ex, "colour extrinsics"),
             from_depth = extrinsics_of(depth_ex, "depth extrinsics");
  if (!from_color.ok()) return from_color.error();
  if (!from_depth.ok()) return from_depth.error();
  color.color_from_depth = inverse(*from_color) * *from_depth;
  const bool same_place = color.color_from_depth.matrix().isIdentity(1e-6);
  // Some files omit the intrinsics of colour if they are the same.
  const bool says_color = color_in[0] != 0;
  if (says_color && !(same_place && disparity_px(camera, color) <= kSameCamera_px))
    camera.color = color;
  if (const Status status = validate(camera); !status.ok()) return status.error();
  return camera;
}

void add_poses(const std::vector<SensFrame>& frames, FrameFile& contents,
               std::vector<std::string>& doubts) {
  std::size_t missing = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const std::optional<Rigid3> pose = rigid_pose(matrix_of(frames[i].world_from_camera));
    if (pose) contents.groundtruth.push_back({contents.frames[i].timestamp_s, *pose});
    missing += pose ? 0 : 1;
  }
  if (missing > 0)
    doubts.push_back(fmt::format("{} of {} frames have no valid pose", missing, frames.size()));
}

Result<Recording> open_file(ByteFile file, const std::optional<Camera>& given) {
  FieldReader fields(file);
  const Result<Header> header = read_header(fields);
  if (!header.ok()) return header.error();
  std::vector<SensFrame> frames;
  frames.reserve(header->frame_count);
  for (std::uint64_t i = 0; i < header->frame_count; ++i) {
    const auto frame = read_frame(fields, *header);
    if (!frame.ok())
      return in_context(fmt::format("frame {} of {}", i, header->frame_count), frame.error());
    frames.push_back(*frame);
  }
  Recording recording;
  Result<Camera> camera = given ? Result<Camera>(*given) : camera_of(*header);
  if (!camera.ok()) return in_context("calibration", camera.error());
  const auto& [color_width, color_height, depth_width, depth_height] = header->sizes;
  if (camera->width != static_cast<int>(depth_width) ||
      camera->height != static_cast<int>(depth_height))
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("the depth images have {}x{} pixels, the camera {}x{}", depth_width,
                             depth_height, camera->width, camera->height)};
  recording.camera_source = given ? "given" : "the file's header";
  std::vector<std::int64_t> stamps;
  for (const SensFrame& frame : frames) stamps.push_back(frame.stamp);
  const std::vector<double> times_s =
      seconds_of_stamps(stamps, kDefaultFrameRate_hz, recording.doubts);
  const image::ImageSize color_size{static_cast<int>(color_width), static_cast<int>(color_height)};
  FrameFile contents{"sens",
                     std::move(file),
                     {},
                     {},
                     *camera,
                     raw_or_packed({camera->width, camera->height}, color_size),
                     kDefaultFrameRate_hz};
  for (std::size_t i = 0; i < frames.size(); ++i)
    contents.frames.push_back({times_s[i], frames[i].depth, frames[i].color});
  add_poses(frames, contents, recording.doubts);
  auto sequence = make_frame_file_sequence(std::move(contents));
  if (!sequence.ok()) return sequence.error();
  recording.sequence = std::move(*sequence);
  return recording;
}

}  // namespace

std::optional<std::string> probe_sens(const std::string& path) {
  const Result<ByteFile> file = ByteFile::open(path);
  if (!file.ok()) return std::nullopt;
  FieldReader fields(*file);
  if (!read_name(fields).ok()) return std::nullopt;
  // A .klg file of four frames may begin with the same four bytes, followed by black depth for
  // zeros; the last row of each matrix distinguishes them.
  const auto calibration = fields.read<std::array<Matrix, 4>>("calibration");
  if (!calibration.ok()) return std::nullopt;
  const auto is_whole_matrix = [](const Matrix& matrix) {
    return matrix[12] == 0 && matrix[13] == 0 && matrix[14] == 0 && matrix[15] == 1;
  };
  if (!std::all_of(calibration->begin(), calibration->end(), is_whole_matrix)) return std::nullopt;
  return "version 4, a sensor's name and four 4x4 matrices (ScanNet's .sens)";
}

Result<Recording> open_sens(const std::string& path, const std::optional<Camera>& given) {
  return open_file_with(open_file, path, given);
}

}  // namespace hermite::dataset
