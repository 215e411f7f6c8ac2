// .klg, the logs of ElasticFusion, Kintinuous and Logger2. Little endian, no magic number:
//   i32  num_frames
//   then each  i64 timestamp [us], i32 depth_size, i32 color_size, depth_size bytes, color_size
//              bytes
// Depth is in millimetres, raw or zlib; colour is raw r, g, b, JPEG, or absent. The file contains
// neither the camera nor the image size: they come from FILE.camera.json or a camera.json beside
// the file, otherwise from the images and ElasticFusion's default. A trajectory in
// FILE.groundtruth.txt (TUM format) is the ground truth.
#include <fmt/core.h>

#include <algorithm>
#include <array>

#include "core/dataset/camera_file.h"
#include "core/dataset/frame_file.h"
#include "core/dataset/text_file.h"

namespace hermite::dataset {
namespace {

constexpr std::int64_t kMinFrame_bytes = 8 + 4 + 4 + 1;
// ElasticFusion uses this camera for a log without a calibration file.
const Camera kElasticFusionCamera{640, 480, 528, 528, 320, 240, 1000};
// Image sizes of sensors from which logs exist, for images that do not contain their size.
constexpr image::ImageSize kSensorSizes[] = {{640, 480}, {320, 240}, {1280, 720}, {848, 480},
                                             {640, 360}, {960, 540}, {1280, 960}};

struct KlgFrame {
  std::int64_t stamp;
  FilePart depth, color;
};

Result<std::int32_t> read_frame_count(FieldReader& fields, std::uint64_t file_bytes) {
  const auto count = fields.read<std::int32_t>("num_frames");
  if (!count.ok()) return count.error();
  const std::int64_t room = static_cast<std::int64_t>(file_bytes) / kMinFrame_bytes;
  if (*count == 0)
    return fields.error("num_frames", "is 0: the logger was stopped before it wrote the number");
  if (*count < 0 || *count > kMaxFileFrames || *count > room)
    return fields.error("num_frames",
                        fmt::format("is {}, the file has room for {}, allowed are 1 to {}", *count,
                                    room, kMaxFileFrames));
  return count;
}

Result<KlgFrame> read_frame(FieldReader& fields) {
  const auto stamp = fields.read<std::int64_t>("timestamp");
  if (!stamp.ok()) return stamp.error();
  const auto sizes = fields.read<std::array<std::int32_t, 2>>("depth_size, color_size");
  if (!sizes.ok()) return sizes.error();
  const auto depth = fields.skip("depth_size", (*sizes)[0], 1, kMaxDepthPart_bytes);
  if (!depth.ok()) return depth.error();
  const auto color = fields.skip("color_size", (*sizes)[1], 0, kMaxColorPart_bytes);
  if (!color.ok()) return color.error();
  return KlgFrame{*stamp, *depth, *color};
}

Result<std::vector<KlgFrame>> read_index(FieldReader& fields, std::uint64_t file_bytes) {
  const auto count = read_frame_count(fields, file_bytes);
  if (!count.ok()) return count.error();
  std::vector<KlgFrame> frames;
  frames.reserve(static_cast<std::size_t>(*count));
  for (std::int32_t i = 0; i < *count; ++i) {
    const auto frame = read_frame(fields);
    if (!frame.ok()) return in_context(fmt::format("frame {} of {}", i, *count), frame.error());
    frames.push_back(*frame);
  }
  return frames;
}

// Returns whether this part begins like a zlib stream or can be a raw image.
bool looks_like_depth(const ByteFile& file, const FilePart& part) {
  std::array<std::uint8_t, 2> start{};
  if (part.bytes < start.size() || !file.read_into(part.offset, start.data(), start.size()).ok())
    return false;
  const bool is_zlib =
      (start[0] & 0x0f) == 8 && (start[0] >> 4) <= 7 && (start[0] * 256 + start[1]) % 31 == 0;
  const bool is_raw =
      std::any_of(std::begin(kSensorSizes), std::end(kSensorSizes), [&](image::ImageSize size) {
        return part.bytes == static_cast<std::uint64_t>(size.width * size.height) * 2;
      });
  return is_zlib || is_raw;
}

bool looks_like_color(const ByteFile& file, const FilePart& part) {
  std::array<std::uint8_t, 8> start{};
  if (part.bytes == 0 || part.bytes % 3 == 0) return true;
  return part.bytes >= start.size() &&
         file.read_into(part.offset, start.data(), start.size()).ok() &&
         image::detect_image_format(start).ok();
}

// Determines the size from the first colour image that contains it, otherwise from the number of
// bytes of raw images.
std::optional<image::ImageSize> size_of_images(const ByteFile& file,
                                               const std::vector<KlgFrame>& frames) {
  // Frames without colour, or with damaged ones, before giving up.
  constexpr std::size_t kEnough = 100;
  for (std::size_t i = 0; i < std::min(frames.size(), kEnough); ++i) {
    for (const image::ImageSize size : kSensorSizes) {
      const auto pixels = static_cast<std::uint64_t>(size.width * size.height);
      if (frames[i].depth.bytes == 2 * pixels || frames[i].color.bytes == 3 * pixels) return size;
    }
    const auto bytes = file.read(frames[i].color);
    if (!bytes.ok()) continue;
    const auto size = image::read_image_size(*bytes);
    if (size.ok()) return *size;
  }
  return std::nullopt;
}

struct KlgCamera {
  Camera camera;
  double frame_rate_hz = kDefaultFrameRate_hz;
  std::string source;
};

Result<KlgCamera> camera_of(const ByteFile& file, const std::vector<KlgFrame>& frames,
                            const std::optional<Camera>& given, std::vector<std::string>& doubts) {
  const std::string& path = file.path();
  if (given) return KlgCamera{*given, kDefaultFrameRate_hz, "given"};
  const auto beside = camera_beside(path);
  if (!beside.ok()) return beside.error();
  if (*beside)
    return KlgCamera{(*beside)->file.camera, (*beside)->file.frame_rate_hz, (*beside)->name};
  const std::optional<image::ImageSize> size = size_of_images(file, frames);
  if (!size ||
      !(*size == image::ImageSize{kElasticFusionCamera.width, kElasticFusionCamera.height}))
    return Error{ErrorCode::kNotFound,
                 fmt::format("the file does not say which camera took it, and its images are not "
                             "640x480: give a camera, or put {}.camera.json beside it",
                             path)};
  doubts.push_back(
      "the file does not say which camera took it: ElasticFusion's default is assumed (528 pixels, "
      "centre 320, 240)");
  return KlgCamera{kElasticFusionCamera, kDefaultFrameRate_hz, "ElasticFusion's default for .klg"};
}

}  // namespace

std::optional<std::string> probe_klg(const std::string& path) {
  const Result<ByteFile> file = ByteFile::open(path);
  if (!file.ok()) return std::nullopt;
  FieldReader fields(*file);
  const auto count = read_frame_count(fields, file->bytes());
  if (!count.ok()) return std::nullopt;
  const auto frame = read_frame(fields);
  if (!frame.ok() || !looks_like_depth(*file, frame->depth) ||
      !looks_like_color(*file, frame->color))
    return std::nullopt;
  return "a number of frames, then the lengths of depth and colour, with such images behind them "
         "(.klg)";
}

Result<Recording> open_klg(const std::string& path, const std::optional<Camera>& given) {
  Result<ByteFile> file = ByteFile::open(path);
  if (!file.ok()) return file.error();
  FieldReader fields(*file);
  const auto index = read_index(fields, file->bytes());
  if (!index.ok()) return in_context(path, index.error());
  Recording recording;
  if (fields.remaining() > 0)
    recording.doubts.push_back(
        std::to_string(fields.remaining()) +
        " bytes behind the last frame are ignored: num_frames may be too small");
  const auto camera = camera_of(*file, *index, given, recording.doubts);
  if (!camera.ok()) return in_context(path, camera.error());
  const image::ImageSize size{camera->camera.width, camera->camera.height};
  if (const auto found = size_of_images(*file, *index); found && *found != size)
    return Error{ErrorCode::kCorruptData,
                 fmt::format("{}: its images have {}x{} pixels, the camera {}x{}", path,
                             found->width, found->height, size.width, size.height)};
  recording.camera_source = camera->source;

  std::vector<std::int64_t> stamps;
  for (const KlgFrame& frame : *index) stamps.push_back(frame.stamp);
  const std::vector<double> times_s =
      seconds_of_stamps(stamps, camera->frame_rate_hz, recording.doubts);
  FrameFile contents{"klg",
                     std::move(*file),
                     {},
                     {},
                     camera->camera,
                     raw_or_packed(size, size),
                     camera->frame_rate_hz};
  for (std::size_t i = 0; i < index->size(); ++i)
    contents.frames.push_back({times_s[i], (*index)[i].depth, (*index)[i].color});
  const auto black = std::count_if(index->begin(), index->end(),
                                   [](const KlgFrame& frame) { return frame.color.bytes == 0; });
  if (black > 0)
    recording.doubts.push_back(std::to_string(black) + " frames have no colour: they are black");
  if (const std::string truth_path = path + ".groundtruth.txt"; is_file(truth_path)) {
    Result<Trajectory> truth = read_tum_trajectory(truth_path);
    if (!truth.ok()) return truth.error();
    contents.groundtruth = std::move(*truth);
  }
  auto sequence = make_frame_file_sequence(std::move(contents));
  if (!sequence.ok()) return in_context(path, sequence.error());
  recording.sequence = std::move(*sequence);
  return recording;
}

}  // namespace hermite::dataset
