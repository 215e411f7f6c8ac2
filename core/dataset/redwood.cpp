// Redwood's scans and the 3D Scene data of Zhou and Koltun: numbered_images.h, and the poses in a
// .log (or -traj.txt): three integers, then a 4x4 matrix world_from_camera, for each pose. The
// first integer is the index of the frame, from 0. Depth is in millimetres, the camera a
// PrimeSense.
#include <fmt/core.h>

#include <algorithm>
#include <array>

#include "core/dataset/byte_file.h"
#include "core/dataset/camera_file.h"
#include "core/dataset/numbered_images.h"
#include "core/dataset/pose_matrix.h"
#include "core/dataset/recorded_folder.h"
#include "core/dataset/text_file.h"

namespace hermite::dataset {
namespace {

constexpr std::size_t kLinesPerPose = 5;
// .log and .txt files beside the images that are examined.
constexpr std::size_t kMaxCandidates = 20;

struct LoggedPose {
  std::int64_t frame = 0;
  Rigid3 world_from_camera;
};

// Parses one pose: a line of three integers and four lines of four numbers.
Result<LoggedPose> parse_pose(const std::string& path, const TextLine* lines) {
  const auto head = split_fields(lines[0].text);
  if (head.size() != 3 || !parse_index(head[0]) || !parse_index(head[1]) || !parse_index(head[2]))
    return line_error(path, lines[0], "expected three whole numbers");
  Eigen::Matrix4d matrix;
  for (int row = 0; row < 4; ++row) {
    const TextLine& line = lines[row + 1];
    const auto fields = split_fields(line.text);
    if (fields.size() != 4) return line_error(path, line, "expected 4 numbers");
    for (int column = 0; column < 4; ++column) {
      const auto value = parse_finite(fields[static_cast<std::size_t>(column)]);
      if (!value)
        return line_error(path, line, fmt::format("field {} is not a finite number", column + 1));
      matrix(row, column) = *value;
    }
  }
  const std::optional<Rigid3> pose = rigid_pose(matrix);
  if (!pose)
    return line_error(path, lines[1], "the matrix that begins here is not a rigid transform");
  return LoggedPose{*parse_index(head[0]), *pose};
}

Result<std::vector<LoggedPose>> parse_log(const std::string& path, std::string_view text) {
  const std::vector<TextLine> lines = data_lines(text);
  if (lines.size() % kLinesPerPose != 0)
    return Error{
        ErrorCode::kCorruptData,
        fmt::format("{} has {} lines, not 5 for each pose: cut short", path, lines.size())};
  std::vector<LoggedPose> poses;
  for (std::size_t i = 0; i < lines.size(); i += kLinesPerPose) {
    const auto pose = parse_pose(path, &lines[i]);
    if (!pose.ok()) return pose.error();
    if (!poses.empty() && pose->frame <= poses.back().frame)
      return line_error(path, lines[i], "the frame is not after the one before");
    poses.push_back(*pose);
  }
  return poses;
}

// Returns whether the file begins with a pose. A matrix takes less than 1 kB.
bool begins_as_log(const std::string& path) {
  constexpr std::uint64_t kStart_bytes = 2048;
  const Result<ByteFile> file = ByteFile::open(path);
  if (!file.ok()) return false;
  const auto bytes = file->read({0, std::min(kStart_bytes, file->bytes())});
  if (!bytes.ok()) return false;
  const std::string text(bytes->begin(), bytes->end());
  const std::vector<TextLine> lines = data_lines(text);
  return lines.size() >= kLinesPerPose && parse_pose(path, lines.data()).ok();
}

// Returns the name of the log in the folder; empty if there is none.
std::string find_log(const std::string& folder) {
  const auto names = file_names(folder);
  if (!names.ok()) return "";
  std::size_t candidates = 0;
  for (const std::string_view ending : {".log", ".txt"})
    for (const std::string& name : *names)
      if (name.ends_with(ending) && candidates++ < kMaxCandidates &&
          begins_as_log(folder + "/" + name))
        return name;
  return "";
}

}  // namespace

std::optional<std::string> probe_redwood(const std::string& folder) {
  if (!is_folder(folder)) return std::nullopt;
  const std::string log = find_log(folder);
  if (log.empty()) return std::nullopt;
  const auto images = find_numbered_images(folder, kDefaultFrameRate_hz);
  if (!images.ok() || !images->has_value()) return std::nullopt;
  return fmt::format("numbered images in {} and poses as 4x4 matrices in {} (Redwood)",
                     (*images)->where, log);
}

Result<FolderContents> list_redwood(const std::string& folder) {
  auto images = find_numbered_images(folder, kDefaultFrameRate_hz);
  if (!images.ok()) return images.error();
  if (!images->has_value())
    return Error{ErrorCode::kCorruptData, folder + ": there are no numbered images"};
  FolderContents contents;
  contents.format = "redwood";
  contents.frames = std::move((*images)->frames);
  contents.camera = known_camera("redwood");
  contents.camera_source = "the data set's PrimeSense, by the layout";
  contents.doubts.push_back(
      "without a camera.json the camera is assumed to be Redwood's: 525 pixels, centre 319.5, "
      "239.5, millimetres");
  if (is_file(folder + "/camera.json")) contents.doubts.clear();

  const std::string path = folder + "/" + find_log(folder);
  const Result<std::string> text = read_text_file(path);
  if (!text.ok()) return text.error();
  const auto poses = parse_log(path, *text);
  if (!poses.ok()) return poses.error();
  for (const LoggedPose& pose : *poses) {
    if (pose.frame >= static_cast<std::int64_t>(contents.frames.size())) {
      contents.doubts.push_back(
          fmt::format("the log has poses of frames from {} on, there are {}: these are ignored",
                      pose.frame, contents.frames.size()));
      break;
    }
    contents.groundtruth.push_back(
        {contents.frames[static_cast<std::size_t>(pose.frame)].timestamp_s,
         pose.world_from_camera});
  }
  return contents;
}

}  // namespace hermite::dataset
