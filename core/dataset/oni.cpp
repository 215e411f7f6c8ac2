// .oni, recordings of OpenNI (oni_file.h). The file contains the field of view of depth, but no
// lens parameters: the camera is a pinhole whose principal point is the middle of the image, unless
// a camera is given or is in FILE.camera.json or camera.json beside it. Mirrored images, which
// OpenNI records by default, are mirrored back.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>

#include "core/dataset/associate.h"
#include "core/dataset/camera_file.h"
#include "core/dataset/frame_file.h"
#include "core/dataset/oni_file.h"
#include "core/dataset/recording.h"
#include "core/image/nibble_depth.h"
#include "core/image/resize.h"

namespace hermite::dataset {
namespace {

// Field of view of a PrimeSense sensor (Kinect v1, Xtion), for recordings that do not contain it.
constexpr double kPrimeSenseView_rad[] = {1.0144686707507438, 0.78980943449644714};
constexpr double kMaxFrameRate_hz = 500;
enum OniPixelFormat : std::int64_t {
  kDepth1Mm = 100,
  kDepth100Um = 101,
  kRgb888 = 200,
  kOniJpeg = 204
};
enum XnPixelFormat : std::int64_t { kXnRgb24 = 1, kXnJpeg = 5 };
enum class Coding { kRaw, kNibbles, kNibblesWithTable, kJpeg };

struct Stream {
  Coding coding = Coding::kRaw;
  image::ImageSize size;
  bool is_mirrored = false;
};

template <class Pixel>
void turn_back(Image<Pixel>& image) {
  for (auto row = image.pixels.begin(); row != image.pixels.end(); row += image.width)
    std::reverse(row, row + image.width);
}

// Decodes a raw image of exactly `size`.
template <class Pixel>
Result<Image<Pixel>> raw_image(const std::vector<std::uint8_t>& bytes, image::ImageSize size) {
  Image<Pixel> image(size.width, size.height);
  const std::size_t expected = image.pixels.size() * sizeof(Pixel);
  if (bytes.size() != expected)
    return Error{
        ErrorCode::kCorruptData,
        fmt::format("the image has {} bytes, not the {} of its pixels", bytes.size(), expected)};
  std::memcpy(image.pixels.data(), bytes.data(), expected);
  return image;
}

Result<DepthImage> decode_depth(const std::vector<std::uint8_t>& bytes, const Stream& stream) {
  Result<DepthImage> depth = stream.coding == Coding::kNibbles
                                 ? image::decode_depth_nibbles(bytes, stream.size)
                             : stream.coding == Coding::kNibblesWithTable
                                 ? image::decode_depth_nibbles_with_table(bytes, stream.size)
                                 : raw_image<std::uint16_t>(bytes, stream.size);
  if (depth.ok() && stream.is_mirrored) turn_back(*depth);
  return depth;
}

Result<std::vector<std::uint8_t>> decode_color_part(std::vector<std::uint8_t> bytes,
                                                    const Stream& stream, image::ImageSize size) {
  if (stream.coding == Coding::kJpeg && stream.size == size && !stream.is_mirrored) {
    const Result<image::ImageSize> found = image::read_image_size(bytes);
    if (!found.ok()) return found.error();
    if (*found == stream.size) return bytes;
  }
  auto image = stream.coding == Coding::kJpeg ? image::decode_color(bytes, stream.size)
                                              : raw_image<Rgb8>(bytes, stream.size);
  if (!image.ok()) return image.error();
  if (stream.is_mirrored) turn_back(*image);
  return image::encode_png(stream.size == size ? *image : image::resize_color(*image, size));
}

Error unsupported(const std::string& message) { return {ErrorCode::kUnsupported, message}; }

std::string text_of(image::ImageSize size) { return fmt::format("{}x{}", size.width, size.height); }

Status check_stream(const OniStream& stream, const char* name, int max_side_px) {
  if (stream.is_cropped)
    return unsupported(std::string(name) + " was recorded cropped: only whole images are read");
  const auto inside = [max_side_px](int side) {
    return side >= kMinImageSide_px && side <= max_side_px;
  };
  if (inside(stream.size.width) && inside(stream.size.height)) return Done{};
  return Error{ErrorCode::kCorruptData,
               fmt::format("{}: xnMapOutputMode says {} pixels, allowed is {} to {}", name,
                           text_of(stream.size), kMinImageSide_px, max_side_px)};
}

Result<Stream> depth_stream(const OniStream& found) {
  if (const Status status = check_stream(found, "depth", kMaxImageSide_px); !status.ok())
    return status.error();
  const std::int64_t format = found.oni_pixel_format;
  if (format != 0 && format != kDepth1Mm && format != kDepth100Um)
    return unsupported(fmt::format(
        "depth: oniPixelFormat is {}, only 100 (1 mm) and 101 (0.1 mm) are read", format));
  const std::pair<const char*, Coding> known[] = {
      {"NONE", Coding::kRaw}, {"16zP", Coding::kNibbles}, {"16zT", Coding::kNibblesWithTable}};
  for (const auto& [codec, coding] : known)
    if (found.codec == codec) return Stream{coding, found.size, found.is_mirrored};
  return unsupported(
      fmt::format("depth: the codec is \"{}\", known are NONE, 16zP and 16zT", found.codec));
}

Result<Stream> color_stream(const OniStream& found, image::ImageSize depth_size) {
  if (const Status status = check_stream(found, "colour", kMaxStoredColorSide_px); !status.ok())
    return status.error();
  if (found.size.width * depth_size.height != found.size.height * depth_size.width)
    return unsupported(
        fmt::format("colour has {} pixels, depth {}: these are not of one shape, the file does not "
                    "say which part of one the other shows",
                    text_of(found.size), text_of(depth_size)));
  const bool says_format = found.oni_pixel_format != 0 || found.pixel_format != 0;
  const bool is_jpeg = found.codec == "JPEG" ||
                       (found.codec == "NONE" &&
                        (found.oni_pixel_format == kOniJpeg || found.pixel_format == kXnJpeg));
  if (is_jpeg) return Stream{Coding::kJpeg, found.size, found.is_mirrored};
  const bool is_rgb = found.oni_pixel_format == kRgb888 ||
                      (found.oni_pixel_format == 0 && found.pixel_format == kXnRgb24);
  if (found.codec == "NONE" && (is_rgb || !says_format))
    return Stream{Coding::kRaw, found.size, found.is_mirrored};
  return unsupported(fmt::format(
      "colour: codec \"{}\" with pixel format {} is not read, but JPEG and plain RGB are",
      found.codec, found.oni_pixel_format != 0 ? found.oni_pixel_format : found.pixel_format));
}

std::string degrees(double rad) {
  return std::to_string(std::lround(rad * 180 / 3.14159265358979));
}

Result<Camera> camera_of(const OniStream& depth, const std::optional<Camera>& given,
                         Recording& recording, const std::string& path) {
  const auto choose = [&](const Camera& camera, const std::string& source) -> Result<Camera> {
    recording.camera_source = source;
    if (image::ImageSize{camera.width, camera.height} == depth.size) return camera;
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("its images have {} pixels, the camera {}", text_of(depth.size),
                             text_of({camera.width, camera.height}))};
  };
  if (given) return choose(*given, "given");
  const auto beside = camera_beside(path);
  if (!beside.ok()) return beside.error();
  if (*beside) return choose((*beside)->file.camera, (*beside)->name);
  const bool says_view = depth.view_rad[0] != 0 && depth.view_rad[1] != 0;
  if (!says_view && 3 * depth.size.width != 4 * depth.size.height)
    return Error{ErrorCode::kNotFound,
                 fmt::format("the file does not say how wide its camera sees (xnFOV): give a "
                             "camera, or put {}.camera.json beside it",
                             path)};
  const double across_rad = says_view ? depth.view_rad[0] : kPrimeSenseView_rad[0];
  const double down_rad = says_view ? depth.view_rad[1] : kPrimeSenseView_rad[1];
  const auto focal_px = [](int side_px, double view_rad) {
    return 0.5 * side_px / std::tan(0.5 * view_rad);
  };
  const Camera camera{depth.size.width,
                      depth.size.height,
                      focal_px(depth.size.width, across_rad),
                      focal_px(depth.size.height, down_rad),
                      0.5 * (depth.size.width - 1),
                      0.5 * (depth.size.height - 1),
                      depth.oni_pixel_format == kDepth100Um ? 10'000.0 : 1000.0};
  if (const Status status = validate(camera); !status.ok())
    return in_context("xnFOV", status.error());
  const std::string view = fmt::format("{} by {} degrees", degrees(across_rad), degrees(down_rad));
  if (!says_view)
    recording.doubts.push_back(fmt::format(
        "the file does not say how wide its camera sees: {} is assumed, as of a Kinect or Xtion",
        view));
  return choose(camera,
                says_view ? fmt::format("the file's field of view ({}), centre in the middle", view)
                          : "a Kinect's or Xtion's field of view");
}

// Returns ascending times in seconds; images that are not later than the one before are removed
// from the stream.
std::vector<double> ascending_times(OniStream& stream, std::size_t& left_out) {
  std::vector<double> times_s;
  std::vector<OniImage> kept;
  for (const OniImage& image : stream.images) {
    const double time_s = static_cast<double>(image.stamp_us) / 1e6;
    if (!times_s.empty() && time_s <= times_s.back()) continue;
    times_s.push_back(time_s);
    kept.push_back(image);
  }
  left_out += stream.images.size() - kept.size();
  stream.images = std::move(kept);
  return times_s;
}

// In OpenNI 2 the stamps of each stream may start at 0. The stream that started later is then taken
// to start at the time of the other's latest image before it in the file.
void align_starts(const OniStream& stream, std::vector<double>& times_s,
                  const std::vector<double>& other_s, std::vector<std::string>& doubts) {
  const bool both_from_zero =
      !times_s.empty() && !other_s.empty() && times_s.front() == 0 && other_s.front() == 0;
  const auto before =
      static_cast<std::size_t>(stream.images.empty() ? 0 : stream.images.front().images_before);
  if (!both_from_zero || before < 2 || before > other_s.size()) return;
  const double start_s = other_s[before - 1];
  doubts.push_back(
      fmt::format("one stream began {:f} s after the other by its place in the file; their stamps "
                  "do not say it",
                  start_s));
  for (double& time_s : times_s) time_s += start_s;
}

Result<std::vector<FrameParts>> pair_images(OniFile& found, std::vector<std::string>& doubts) {
  std::size_t left_out = 0;
  std::vector<double> depth_s = ascending_times(*found.depth, left_out);
  std::vector<FrameParts> frames;
  if (!found.color) {
    doubts.push_back("there is no colour: all frames are black");
    for (std::size_t i = 0; i < depth_s.size(); ++i)
      frames.push_back({depth_s[i], found.depth->images[i].part, {}});
  } else {
    std::vector<double> color_s = ascending_times(*found.color, left_out);
    const std::vector<double> unmoved_depth_s = depth_s;
    align_starts(*found.depth, depth_s, color_s, doubts);
    align_starts(*found.color, color_s, unmoved_depth_s, doubts);
    const auto pairs = associate_by_time(depth_s, color_s);
    if (!pairs.ok()) return pairs.error();
    for (const IndexPair& pair : *pairs)
      frames.push_back({depth_s[pair.first], found.depth->images[pair.first].part,
                        found.color->images[pair.second].part});
    if (const std::size_t lonely = depth_s.size() - frames.size(); lonely > 0)
      doubts.push_back(
          fmt::format("{} of {} depth images have no colour within 20 ms and are left out", lonely,
                      depth_s.size()));
  }
  if (left_out > 0)
    doubts.push_back(std::to_string(left_out) +
                     " images have no time after the one before and are left out");
  if (frames.empty())
    return Error{ErrorCode::kCorruptData, "no depth image has a colour image within 20 ms"};
  return frames;
}

Result<Recording> open_file(ByteFile file, const std::optional<Camera>& given) {
  Result<OniFile> found = read_oni_file(file);
  if (!found.ok()) return found.error();
  if (!found->depth || found->depth->images.empty())
    return Error{ErrorCode::kCorruptData, "there is no depth image in it"};
  const Result<Stream> depth = depth_stream(*found->depth);
  if (!depth.ok()) return depth.error();
  if (found->color && found->color->images.empty()) found->color.reset();
  Stream color;
  if (found->color) {
    const Result<Stream> described = color_stream(*found->color, depth->size);
    if (!described.ok()) return described.error();
    color = *described;
  }
  Recording recording;
  const auto camera = camera_of(*found->depth, given, recording, file.path());
  if (!camera.ok()) return camera.error();
  if (!found->cut.empty())
    recording.doubts.push_back("the file is cut or damaged, what is behind cannot be used: " +
                               found->cut);
  if (!camera->color)
    recording.doubts.push_back(
        "an .oni file does not say whether its depth is registered to colour: it is taken to be");
  if (found->color && depth->is_mirrored != color.is_mirrored)
    recording.doubts.push_back(
        "only one of depth and colour is said to be mirrored: that one is turned back");
  auto frames = pair_images(*found, recording.doubts);
  if (!frames.ok()) return frames.error();
  const double rate_hz = found->depth->frame_rate_hz;
  const bool is_a_rate = rate_hz >= 1 && rate_hz <= kMaxFrameRate_hz;
  FrameDecoders decoders{
      [depth = *depth](std::vector<std::uint8_t> bytes) { return decode_depth(bytes, depth); },
      [color, size = depth->size](std::vector<std::uint8_t> bytes) {
        return decode_color_part(std::move(bytes), color, size);
      }};
  auto sequence = make_frame_file_sequence({"oni",
                                            std::move(file),
                                            *std::move(frames),
                                            {},
                                            *camera,
                                            std::move(decoders),
                                            is_a_rate ? rate_hz : kDefaultFrameRate_hz});
  if (!sequence.ok()) return sequence.error();
  recording.sequence = std::move(*sequence);
  return recording;
}

}  // namespace

std::optional<std::string> probe_oni(const std::string& path) {
  const Result<ByteFile> file = ByteFile::open(path);
  if (!file.ok() || !looks_like_oni(*file)) return std::nullopt;
  return "it begins with NI10 (a recording of OpenNI)";
}

Result<Recording> open_oni(const std::string& path, const std::optional<Camera>& given) {
  return open_file_with(open_file, path, given);
}

}  // namespace hermite::dataset
