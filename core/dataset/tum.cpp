// TUM RGB-D benchmark: rgb.txt and depth.txt with "time file" lines, and groundtruth.txt and
// accelerometer.txt if they are there.
#include <fmt/core.h>

#include <filesystem>

#include "core/dataset/camera_file.h"
#include "core/dataset/recorded_folder.h"
#include "core/dataset/text_file.h"

namespace hermite::dataset {
namespace {

struct FileList {
  std::string text;
  std::vector<TimedFile> files;
};

Result<FileList> read_list(const std::string& path) {
  Result<std::string> text = read_text_file(path);
  if (!text.ok()) return text.error();
  FileList list{std::move(*text), {}};
  for (const TextLine& line : data_lines(list.text)) {
    const auto fields = split_fields(line.text);
    if (fields.size() != 2) return line_error(path, line, "expected a time and a file name");
    const auto time_s = parse_finite(fields[0]);
    if (!time_s) return line_error(path, line, "the time is not a finite number of seconds");
    if (!stays_inside(fields[1])) return line_error(path, line, "the file name leaves the folder");
    if (list.files.size() == kMaxFrames)
      return line_error(path, line, fmt::format("more than {} images", kMaxFrames));
    list.files.push_back({*time_s, std::string(fields[1])});
  }
  return list;
}

// The benchmark names its recordings in comments at the top of each list: "# file:
// 'rgbd_dataset_freiburg1_xyz.bag'".
std::string_view head_of(const std::string& text) { return std::string_view(text).substr(0, 1000); }

// A recording without a readable list of accelerations is still one. Its own Kinects have known
// axes; other programs write theirs into a file of the same name.
void list_accelerations(const std::string& folder, FolderContents& contents) {
  const std::string path = folder + "/" + kAccelerometerFile;
  if (!is_file(path)) return;
  const Result<std::string> text = read_text_file(path);
  Result<std::vector<TimedAcceleration>> felt =
      text.ok() ? parse_accelerations(*text) : text.error();
  if (!felt.ok()) {
    contents.doubts.push_back(felt.error().message + "; what the accelerometer felt is not used");
    return;
  }
  contents.felt = *std::move(felt);
  if (camera_mentioned_in(head_of(*text)))
    contents.camera_from_accelerometer = camera_from_kinect_accelerometer();
}

}  // namespace

std::optional<std::string> probe_tum(const std::string& folder) {
  if (!is_file(folder + "/rgb.txt") || !is_file(folder + "/depth.txt")) return std::nullopt;
  return "rgb.txt and depth.txt, lists of times and images (TUM RGB-D)";
}

Result<FolderContents> list_tum(const std::string& folder) {
  Result<FileList> colors = read_list(folder + "/rgb.txt");
  if (!colors.ok()) return colors.error();
  Result<FileList> depths = read_list(folder + "/depth.txt");
  if (!depths.ok()) return depths.error();
  auto frames = pair_by_time(std::move(colors->files), std::move(depths->files));
  if (!frames.ok()) return in_context(folder, frames.error());

  FolderContents contents;
  contents.format = "tum";
  contents.frames = std::move(*frames);
  contents.camera_source =
      "the benchmark's calibration of the Kinect that the folder or its lists name";
  contents.camera =
      camera_mentioned_in(std::filesystem::absolute(folder).lexically_normal().string());
  if (!contents.camera) contents.camera = camera_mentioned_in(head_of(colors->text));
  if (!contents.camera) contents.camera = camera_mentioned_in(head_of(depths->text));

  list_accelerations(folder, contents);
  const std::string truth_path = folder + "/groundtruth.txt";
  if (!is_file(truth_path)) return contents;
  const Result<std::string> truth_text = read_text_file(truth_path);
  if (!truth_text.ok()) return truth_text.error();
  Result<Trajectory> truth = parse_tum_trajectory(*truth_text);
  if (!truth.ok()) return in_context(truth_path, truth.error());
  contents.groundtruth = std::move(*truth);
  if (!contents.camera) contents.camera = camera_mentioned_in(head_of(*truth_text));
  return contents;
}

}  // namespace hermite::dataset
