// 7-Scenes: frame-NNNNNN.color.{jpg,png}, .depth.png and .pose.txt in one folder; the camera in
// camera-intrinsics.txt (3x3). Frame N was taken at N/30 s. Depth is in millimetres; 65535 means
// "no measurement" like 0. The benchmark's own recordings are raw images of a Kinect v1: colour is
// not registered to depth.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/dataset/pose_matrix.h"
#include "core/dataset/recorded_folder.h"
#include "core/dataset/text_file.h"
#include "core/image/image_codec.h"

namespace hermite::dataset {
namespace {

constexpr double kFrameRate_hz = 30.0;
constexpr double kDepthUnitsPerMetre = 1000;
constexpr std::uint16_t kNoMeasurement = 65535;
constexpr std::size_t kMaxMatrixFile_bytes = 64 << 10;
constexpr std::string_view kPrefix = "frame-";

struct NumberedFile {
  std::int64_t number;
  std::string kind;  // "color.jpg", "depth.png", "pose.txt"
};

std::optional<NumberedFile> parse_name(const std::string& name) {
  constexpr std::size_t kMaxDigits = 9;
  const std::size_t dot = name.find('.');
  if (name.rfind(kPrefix, 0) != 0 || dot == std::string::npos || dot > kPrefix.size() + kMaxDigits)
    return std::nullopt;
  const auto number =
      parse_index(std::string_view(name).substr(kPrefix.size(), dot - kPrefix.size()));
  if (!number) return std::nullopt;
  return NumberedFile{*number, name.substr(dot + 1)};
}

struct FrameFiles {
  std::string color, depth, pose;  // empty where there is none
};

std::map<std::int64_t, FrameFiles> group_by_number(const std::vector<std::string>& names) {
  std::map<std::int64_t, FrameFiles> frames;
  for (const std::string& name : names) {
    const auto file = parse_name(name);
    if (!file) continue;
    if (file->kind == "color.jpg" || file->kind == "color.png") frames[file->number].color = name;
    if (file->kind == "depth.png") frames[file->number].depth = name;
    if (file->kind == "pose.txt") frames[file->number].pose = name;
  }
  return frames;
}

// Reads `size` lines of `size` numbers. Numbers that are not finite are kept, because 7-Scenes
// marks lost poses with them.
Result<Eigen::MatrixXd> read_matrix(const std::string& path, int size) {
  const Result<std::string> text = read_text_file(path, kMaxMatrixFile_bytes);
  if (!text.ok()) return text.error();
  const std::vector<TextLine> lines = data_lines(*text);
  if (lines.size() != static_cast<std::size_t>(size))
    return Error{ErrorCode::kCorruptData,
                 fmt::format("{} has {} lines, expected {}", path, lines.size(), size)};
  Eigen::MatrixXd matrix(size, size);
  for (int row = 0; row < size; ++row) {
    const TextLine& line = lines[static_cast<std::size_t>(row)];
    const auto fields = split_fields(line.text);
    if (fields.size() != static_cast<std::size_t>(size))
      return line_error(path, line, fmt::format("expected {} numbers", size));
    for (int column = 0; column < size; ++column) {
      const std::string_view field = fields[static_cast<std::size_t>(column)];
      const bool is_lost = field == "nan" || field == "inf" || field == "-nan" || field == "-inf" ||
                           field == "-1.#IND";
      const auto value = is_lost ? std::optional<double>(std::nan("")) : parse_finite(field);
      if (!value)
        return line_error(path, line, fmt::format("field {} is not a number", column + 1));
      matrix(row, column) = *value;
    }
  }
  return matrix;
}

// Returns std::nullopt for a pose that the recording itself marks as lost.
Result<std::optional<Rigid3>> read_pose(const std::string& path) {
  const auto matrix = read_matrix(path, 4);
  if (!matrix.ok()) return matrix.error();
  if (!matrix->allFinite()) return std::optional<Rigid3>();
  const std::optional<Rigid3> pose = rigid_pose(*matrix);
  if (!pose) return Error{ErrorCode::kCorruptData, path + ": this matrix is not a rigid transform"};
  return pose;
}

// The file has no image size; it is that of the first depth image that can be read.
Result<Camera> read_intrinsics(const std::string& folder,
                               const std::map<std::int64_t, FrameFiles>& frames) {
  const std::string path = folder + "/camera-intrinsics.txt";
  const auto matrix = read_matrix(path, 3);
  if (!matrix.ok()) return matrix.error();
  for (const auto& [number, files] : frames) {
    if (files.depth.empty()) continue;
    const auto bytes = read_binary_file(folder + "/" + files.depth, kMaxImageFile_bytes);
    if (!bytes.ok()) continue;
    const auto size = image::read_image_size(*bytes);
    if (!size.ok()) continue;
    const Eigen::MatrixXd& k = *matrix;
    const Camera camera{size->width, size->height,       k(0, 0), k(1, 1), k(0, 2),
                        k(1, 2),     kDepthUnitsPerMetre};
    if (const Status status = validate(camera); !status.ok())
      return in_context(path, status.error());
    return camera;
  }
  return Error{ErrorCode::kCorruptData,
               folder + ": no depth image can be read, so the camera's size is unknown"};
}

// Returns whether this is the depth camera of the benchmark, with which its KinectFusion estimated
// the poses. Otherwise the recording only has the layout of the benchmark.
bool is_the_benchmarks(const Camera& c) {
  return c.width == 640 && c.height == 480 && c.fx == 585 && c.fy == 585 && c.cx == 320 &&
         c.cy == 240;
}

}  // namespace

// The benchmark gives no calibration of its colour camera. Focal length and pose are those with
// which others register it (the set-up of DSAC*): the Kinect's nominal 525 pixels, and the pose
// that LIRIS measured for theirs. The principal point was estimated from redkitchen: grey values of
// frames 10 and 30 apart, one warped into the other at the benchmark's poses, correlate best with
// (325.5, 241); depth steps lie on the strongest grey edges with (325.5, 243); in either half of
// the recording to a pixel. Correlation, 10 apart: 0.949 for the images as they are, 0.977 with the
// image centre, 0.979 with this; a fit of all ten numbers is no better.
std::optional<ColorCamera> seven_scenes_color_camera(const Camera& camera) {
  if (!is_the_benchmarks(camera)) return std::nullopt;
  Eigen::Matrix4d color_from_depth;
  //
  color_from_depth << 9.9996518012567637e-01, 2.6765126468950343e-03, -7.9041012313000904e-03,
      -2.5558943178152542e-02,
      //
      -2.7409311281316700e-03, 9.9996302803027592e-01, -8.1504520778013286e-03,
      1.0109636268061706e-04,
      //
      7.8819942130445332e-03, 8.1718328771890631e-03, 9.9993554558014031e-01,
      2.0318321729487039e-03, 0, 0, 0, 1;
  return ColorCamera{525, 525, 325.5, 242, {}, rigid3_from_matrix(color_from_depth)};
}

std::optional<std::string> probe_seven_scenes(const std::string& folder) {
  const auto names = file_names(folder);
  if (!names.ok()) return std::nullopt;
  for (const std::string& name : *names)
    if (const auto file = parse_name(name); file && file->kind == "depth.png")
      return "frame-NNNNNN.depth.png files beside each other (7-Scenes)";
  return std::nullopt;
}

Result<FolderContents> list_seven_scenes(const std::string& folder) {
  const auto names = file_names(folder);
  if (!names.ok()) return names.error();
  const std::map<std::int64_t, FrameFiles> frames = group_by_number(*names);

  FolderContents contents;
  contents.format = "7-scenes";
  contents.invalid_depth = {kNoMeasurement};
  for (const auto& [number, files] : frames) {
    if (files.depth.empty() && files.color.empty()) continue;
    const double timestamp_s = static_cast<double>(number) / kFrameRate_hz;
    // A missing half is an error of that frame when it is read, so that frame numbers remain those
    // of the recording.
    std::string stem = files.depth.empty() ? files.color : files.depth;
    stem = stem.substr(0, stem.find('.'));
    contents.frames.push_back({timestamp_s, files.color.empty() ? stem + ".color.jpg" : files.color,
                               stem + ".depth.png"});
    if (files.pose.empty()) continue;
    const auto pose = read_pose(folder + "/" + files.pose);
    if (!pose.ok()) return pose.error();
    if (pose->has_value()) contents.groundtruth.push_back({timestamp_s, **pose});
  }
  if (is_file(folder + "/camera-intrinsics.txt")) {
    const Result<Camera> camera = read_intrinsics(folder, frames);
    if (!camera.ok()) return camera.error();
    contents.camera = *camera;
    contents.camera_source = "camera-intrinsics.txt";
  }
  return contents;
}

}  // namespace hermite::dataset
