#include "core/dataset/frame_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <functional>

#include "core/image/inflate.h"
#include "core/image/resize.h"

namespace hermite::dataset {
namespace {

std::size_t pixel_count(image::ImageSize size) {
  return static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height);
}

class FrameFileSequence : public Sequence {
 public:
  explicit FrameFileSequence(FrameFile contents) : contents_(std::move(contents)) {}

  std::string format() const override { return contents_.format; }
  std::string name() const override {
    return std::filesystem::path(contents_.file.path()).stem().string();
  }
  const Camera& camera() const override { return contents_.camera; }
  double frame_rate_hz() const override { return contents_.frame_rate_hz; }
  std::int64_t frame_count() const override {
    return static_cast<std::int64_t>(contents_.frames.size());
  }
  double timestamp_s(std::int64_t index) const override { return frame(index).timestamp_s; }
  const Trajectory& groundtruth() const override { return contents_.groundtruth; }

  Result<RecordedFrame> read(std::int64_t index) const override {
    const FrameParts& parts = frame(index);
    const auto where = [&](const char* image, const FilePart& part) {
      return fmt::format("{}, frame {}, {} at offset {}", contents_.file.path(), index, image,
                         part.offset);
    };
    auto depth = decoded(parts.depth, contents_.decoders.depth);
    if (!depth.ok()) return in_context(where("depth", parts.depth), depth.error());
    auto color = parts.color.bytes > 0 ? decoded(parts.color, contents_.decoders.color)
                                       : image::encode_png(black());
    if (!color.ok()) return in_context(where("colour", parts.color), color.error());
    return RecordedFrame{parts.timestamp_s, std::move(*depth), std::move(*color)};
  }

 private:
  const FrameParts& frame(std::int64_t index) const {
    CHECK(index >= 0 && index < frame_count(), "frame index outside the sequence");
    return contents_.frames[static_cast<std::size_t>(index)];
  }

  template <class Image>
  Result<Image> decoded(
      const FilePart& part,
      const std::function<Result<Image>(std::vector<std::uint8_t>)>& decode) const {
    Result<std::vector<std::uint8_t>> bytes = contents_.file.read(part);
    if (!bytes.ok()) return bytes.error();
    return decode(*std::move(bytes));
  }

  ColorImage black() const { return ColorImage(contents_.camera.width, contents_.camera.height); }

  const FrameFile contents_;
};

Result<DepthImage> raw_or_inflated_depth(std::vector<std::uint8_t> bytes, image::ImageSize size) {
  DepthImage depth(size.width, size.height);
  const std::size_t depth_bytes = pixel_count(size) * sizeof(std::uint16_t);
  if (bytes.size() != depth_bytes) {
    auto inflated = image::inflate_exactly(bytes, depth_bytes);
    if (!inflated.ok()) return inflated.error();
    bytes = *std::move(inflated);
  }
  std::memcpy(depth.pixels.data(), bytes.data(), depth_bytes);
  return depth;
}

Result<std::vector<std::uint8_t>> raw_or_coded_color(std::vector<std::uint8_t> bytes,
                                                     image::ImageSize stored,
                                                     image::ImageSize size) {
  if (bytes.size() != pixel_count(stored) * sizeof(Rgb8)) {
    const Result<image::ImageSize> found = image::read_image_size(bytes);
    if (!found.ok()) return found.error();
    if (*found == stored && stored == size) return bytes;
    const Result<ColorImage> image = image::decode_color(bytes, stored);
    if (!image.ok()) return image.error();
    return image::encode_png(image::resize_color(*image, size));
  }
  ColorImage image(stored.width, stored.height);
  std::memcpy(image.pixels.data(), bytes.data(), bytes.size());
  return image::encode_png(stored == size ? image : image::resize_color(image, size));
}

bool ascends(const std::vector<std::int64_t>& stamps) {
  return std::adjacent_find(stamps.begin(), stamps.end(),
                            [](std::int64_t a, std::int64_t b) { return a >= b; }) == stamps.end();
}

// Returns the median step between ascending integer stamps; 0 if there are fewer than two.
double median_step(const std::vector<std::int64_t>& stamps) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < stamps.size(); ++i)
    steps.push_back(static_cast<double>(stamps[i]) - static_cast<double>(stamps[i - 1]));
  if (steps.empty()) return 0;
  std::nth_element(steps.begin(), steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2),
                   steps.end());
  return steps[steps.size() / 2];
}

}  // namespace

FrameDecoders raw_or_packed(image::ImageSize size, image::ImageSize color_size) {
  return {[size](std::vector<std::uint8_t> bytes) {
            return raw_or_inflated_depth(std::move(bytes), size);
          },
          [size, color_size](std::vector<std::uint8_t> bytes) {
            return raw_or_coded_color(std::move(bytes), color_size, size);
          }};
}

Result<std::unique_ptr<Sequence>> make_frame_file_sequence(FrameFile contents) {
  if (contents.frames.empty()) return Error{ErrorCode::kCorruptData, "there is no frame in it"};
  return std::unique_ptr<Sequence>(std::make_unique<FrameFileSequence>(std::move(contents)));
}

Result<Recording> open_file_with(Result<Recording> (*open)(ByteFile file,
                                                           const std::optional<Camera>& camera),
                                 const std::string& path, const std::optional<Camera>& camera) {
  Result<ByteFile> file = ByteFile::open(path);
  if (!file.ok()) return file.error();
  Result<Recording> recording = open(std::move(*file), camera);
  if (!recording.ok()) return in_context(path, recording.error());
  return recording;
}

std::vector<double> seconds_of_stamps(const std::vector<std::int64_t>& stamps, double frame_rate_hz,
                                      std::vector<std::string>& doubts) {
  std::vector<double> times_s(stamps.size());
  if (!ascends(stamps)) {
    doubts.push_back(
        fmt::format("the time stamps do not ascend: frames are taken to be 1/{} s apart",
                    static_cast<int>(frame_rate_hz)));
    for (std::size_t i = 0; i < stamps.size(); ++i)
      times_s[i] = static_cast<double>(i) / frame_rate_hz;
    return times_s;
  }
  // Cameras take 1 to 500 frames per second.
  constexpr double kShortestStep_s = 2e-3, kLongestStep_s = 1;
  double units_per_second = 1e6;
  const double step = median_step(stamps);
  for (const auto& [units, unit_name] :
       {std::pair{1e9, "nanoseconds"}, std::pair{1e3, "milliseconds"}}) {
    const bool as_usual =
        step == 0 || (step / 1e6 >= kShortestStep_s && step / 1e6 <= kLongestStep_s);
    if (as_usual || step / units < kShortestStep_s || step / units > kLongestStep_s) continue;
    units_per_second = units;
    doubts.push_back(fmt::format(
        "the time stamps are taken for {}, not microseconds: the median step would be {:f} s",
        unit_name, step / 1e6));
  }
  for (std::size_t i = 0; i < stamps.size(); ++i)
    times_s[i] = static_cast<double>(stamps[i]) / units_per_second;
  // Above 2^53 neighbouring stamps may round to the same number of seconds.
  if (std::adjacent_find(times_s.begin(), times_s.end(), std::greater_equal<>()) != times_s.end())
    return seconds_of_stamps(std::vector<std::int64_t>(stamps.size(), 0), frame_rate_hz, doubts);
  return times_s;
}

}  // namespace hermite::dataset
