#include "core/dataset/recorded_folder.h"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <map>

#include "core/dataset/associate.h"
#include "core/dataset/camera_file.h"
#include "core/dataset/text_file.h"
#include "core/image/image_codec.h"

namespace hermite::dataset {
namespace {

Error size_error(image::ImageSize found, const Camera& camera) {
  const auto text = [](int width, int height) { return fmt::format("{}x{}", width, height); };
  return {ErrorCode::kCorruptData,
          fmt::format("the image has {} pixels, the camera {}", text(found.width, found.height),
                      text(camera.width, camera.height))};
}

Result<std::vector<std::uint8_t>> read_image_of(const std::string& path, const Camera& camera) {
  Result<std::vector<std::uint8_t>> bytes = read_binary_file(path, kMaxImageFile_bytes);
  if (!bytes.ok()) return bytes.error();
  const Result<image::ImageSize> size = image::read_image_size(*bytes);
  if (!size.ok()) return in_context(path, size.error());
  if (!(*size == image::ImageSize{camera.width, camera.height}))
    return in_context(path, size_error(*size, camera));
  return bytes;
}

std::string folder_name(const std::string& folder) {
  const std::filesystem::path path = std::filesystem::absolute(folder).lexically_normal();
  return path.has_filename() ? path.filename().string() : path.parent_path().filename().string();
}

class FolderSequence : public Sequence {
 public:
  FolderSequence(std::string folder, FolderContents contents, double frame_rate_hz)
      : folder_(std::move(folder)), contents_(std::move(contents)), frame_rate_hz_(frame_rate_hz) {}

  std::string format() const override { return contents_.format; }
  std::string name() const override { return folder_name(folder_); }
  const Camera& camera() const override { return *contents_.camera; }
  double frame_rate_hz() const override { return frame_rate_hz_; }
  std::int64_t frame_count() const override {
    return static_cast<std::int64_t>(contents_.frames.size());
  }
  double timestamp_s(std::int64_t index) const override { return frame(index).timestamp_s; }
  const Trajectory& groundtruth() const override { return contents_.groundtruth; }

  Result<RecordedFrame> read(std::int64_t index) const override {
    const FramePaths& paths = frame(index);
    const std::string depth_path = folder_ + "/" + paths.depth;
    const auto depth_bytes = read_image_of(depth_path, camera());
    if (!depth_bytes.ok()) return in_context("frame " + std::to_string(index), depth_bytes.error());
    auto depth = image::decode_depth_png(*depth_bytes, {camera().width, camera().height});
    if (!depth.ok())
      return in_context(fmt::format("frame {}: {}", index, depth_path), depth.error());
    auto color_bytes = read_image_of(folder_ + "/" + paths.color, camera());
    if (!color_bytes.ok()) return in_context("frame " + std::to_string(index), color_bytes.error());
    for (const std::uint16_t invalid : contents_.invalid_depth)
      std::replace(depth->pixels.begin(), depth->pixels.end(), invalid, std::uint16_t{0});
    return RecordedFrame{paths.timestamp_s, std::move(*depth), std::move(*color_bytes),
                         paths.acceleration_m_s2};
  }

 private:
  const FramePaths& frame(std::int64_t index) const {
    CHECK(index >= 0 && index < frame_count(), "frame index outside the sequence");
    return contents_.frames[static_cast<std::size_t>(index)];
  }

  const std::string folder_;
  const FolderContents contents_;
  const double frame_rate_hz_;
};

// associate.py keeps its lists in dictionaries, so of two images with the same time the later line
// counts.
void sort_by_time(std::vector<TimedFile>& files) {
  std::stable_sort(files.begin(), files.end(), [](const TimedFile& a, const TimedFile& b) {
    return a.timestamp_s < b.timestamp_s;
  });
  const auto same_time = [](const TimedFile& a, const TimedFile& b) {
    return a.timestamp_s == b.timestamp_s;
  };
  const auto kept = std::unique(files.rbegin(), files.rend(), same_time);
  files.erase(files.begin(), kept.base());
}

template <class Timed>
std::vector<double> times_of(const std::vector<Timed>& list) {
  std::vector<double> times_s;
  times_s.reserve(list.size());
  for (const Timed& one : list) times_s.push_back(one.timestamp_s);
  return times_s;
}

// Gives each frame what was felt before it, in the axes of the camera.
void turn_accelerations(FolderContents& contents) {
  if (contents.felt.empty()) return;
  if (!contents.camera_from_accelerometer) {
    contents.doubts.push_back(
        fmt::format("{} is not used: nothing says how its axes lie to the camera (see "
                    "camera_from_accelerometer of camera.json)",
                    kAccelerometerFile));
    return;
  }
  const auto means = felt_before(times_of(contents.frames), contents.felt);
  for (std::size_t i = 0; i < means.size(); ++i)
    if (means[i])
      contents.frames[i].acceleration_m_s2 = *contents.camera_from_accelerometer * *means[i];
  contents.felt.clear();
}

}  // namespace

bool stays_inside(std::string_view relative_path) {
  if (relative_path.empty() || relative_path.find('\\') != std::string_view::npos ||
      relative_path.find('\0') != std::string_view::npos)
    return false;
  const std::filesystem::path path(relative_path);
  if (path.has_root_path()) return false;
  return std::none_of(path.begin(), path.end(),
                      [](const std::filesystem::path& part) { return part == ".."; });
}

Result<std::vector<std::string>> file_names(const std::string& folder) {
  std::error_code failure;
  std::filesystem::directory_iterator entries(folder, failure);
  if (failure)
    return Error{ErrorCode::kNotFound,
                 fmt::format("cannot list the folder {}: {}", folder, failure.message())};
  std::vector<std::string> names;
  for (; entries != std::filesystem::directory_iterator(); entries.increment(failure)) {
    if (failure)
      return Error{ErrorCode::kIo,
                   fmt::format("cannot list the folder {}: {}", folder, failure.message())};
    if (names.size() == 4 * kMaxFrames)
      return Error{ErrorCode::kTooLarge, folder + " has too many files"};
    if (!entries->is_directory(failure)) names.push_back(entries->path().filename().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

Result<std::vector<FramePaths>> pair_by_time(std::vector<TimedFile> colors,
                                             std::vector<TimedFile> depths) {
  sort_by_time(colors);
  sort_by_time(depths);
  const auto pairs = associate_by_time(times_of(depths), times_of(colors));
  if (!pairs.ok()) return pairs.error();
  std::vector<FramePaths> frames;
  for (const IndexPair& pair : *pairs)
    frames.push_back(
        {depths[pair.first].timestamp_s, colors[pair.second].path, depths[pair.first].path, {}});
  return frames;
}

Result<std::unique_ptr<Sequence>> make_folder_sequence(const std::string& folder,
                                                       FolderContents contents,
                                                       double frame_rate_hz) {
  CHECK(contents.camera.has_value(), "a folder's sequence needs its camera");
  if (contents.frames.empty())
    return Error{ErrorCode::kCorruptData,
                 fmt::format("{} ({}) has no depth image with a colour image at most 20 ms away",
                             folder, contents.format)};
  // With a wrong camera every frame would fail, so this is reported once, for the first readable
  // image.
  for (const FramePaths& frame : contents.frames) {
    const auto image = read_image_of(folder + "/" + frame.depth, *contents.camera);
    if (image.ok()) break;
    const auto bytes = read_binary_file(folder + "/" + frame.depth, kMaxImageFile_bytes);
    if (bytes.ok() && image::read_image_size(*bytes).ok()) return image.error();
  }
  return std::unique_ptr<Sequence>(
      std::make_unique<FolderSequence>(folder, std::move(contents), frame_rate_hz));
}

Result<Recording> open_folder(const std::string& folder, const std::optional<Camera>& given,
                              Result<FolderContents> (*list)(const std::string& folder),
                              std::optional<ColorCamera> (*color_camera)(const Camera& camera)) {
  Recording recording;
  double frame_rate_hz = kDefaultFrameRate_hz;
  std::optional<Camera> camera = given;
  if (given) recording.camera_source = "given";
  bool says_color_camera = given.has_value();
  std::optional<Eigen::Matrix3d> camera_from_accelerometer;
  if (const std::string path = folder + "/camera.json"; is_file(path)) {
    const Result<CameraFile> file = read_camera_json(path);
    // An invalid file is an error even if the caller passes a camera, because its frame rate is
    // needed too.
    if (!file.ok()) return file.error();
    frame_rate_hz = file->frame_rate_hz;
    if (!camera) recording.camera_source = "camera.json";
    if (!camera) camera = file->camera;
    says_color_camera = says_color_camera || file->says_color_camera;
    camera_from_accelerometer = file->camera_from_accelerometer;
  }
  Result<FolderContents> contents = list(folder);
  if (!contents.ok()) return contents.error();
  if (camera) contents->camera = camera;
  if (camera_from_accelerometer) contents->camera_from_accelerometer = camera_from_accelerometer;
  turn_accelerations(*contents);
  if (!camera) recording.camera_source = contents->camera_source;
  if (!contents->camera)
    return Error{ErrorCode::kNotFound,
                 fmt::format("{} ({}) does not say which camera took it: give one (a file like "
                             "camera.json, or fr1, fr2, fr3), or put a camera.json into the folder",
                             folder, contents->format)};
  if (!says_color_camera && color_camera) contents->camera->color = color_camera(*contents->camera);
  recording.doubts = std::move(contents->doubts);
  auto sequence = make_folder_sequence(folder, std::move(*contents), frame_rate_hz);
  if (!sequence.ok()) return sequence.error();
  recording.sequence = std::move(*sequence);
  return recording;
}

}  // namespace hermite::dataset
