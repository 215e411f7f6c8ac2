// ICL-NUIM in its "TUM compatible PNG" layout: depth/N.png and rgb/N.png, associations.txt, and
// <anything>.gt.freiburg with the poses. Times are frame numbers at 30 Hz. An associations.txt of
// other tools, with times in seconds, is read as well.
//
// ICL-NUIM's camera has fy = -480: its frame is x right, y up, z forward, which no rotation turns
// into ours. We read the images with fy = +480, which reflects the camera frame by S = diag(1, -1,
// 1), and reflect the world along with it so that poses stay rigid: T' = S T S.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "core/dataset/camera_file.h"
#include "core/dataset/recorded_folder.h"
#include "core/dataset/text_file.h"

namespace hermite::dataset {
namespace {

constexpr double kFrameRate_hz = 30.0;
constexpr std::string_view kTruthEnding = ".gt.freiburg";

bool ends_with(std::string_view text, std::string_view ending) {
  return text.size() >= ending.size() && text.substr(text.size() - ending.size()) == ending;
}

// Returns 12 for "depth/12.png".
std::optional<std::int64_t> number_of_png(std::string_view path) {
  const std::size_t slash = path.rfind('/');
  std::string_view name = slash == std::string_view::npos ? path : path.substr(slash + 1);
  if (!ends_with(name, ".png")) return std::nullopt;
  return parse_index(name.substr(0, name.size() - 4));
}

std::string truth_file_of(const std::string& folder) {
  const auto names = file_names(folder);
  if (!names.ok()) return "";
  const auto found = std::find_if(names->begin(), names->end(), [](const std::string& name) {
    return ends_with(name, kTruthEnding);
  });
  return found == names->end() ? "" : *found;
}

Status add_association(const std::string& path, const TextLine& line, ImageLists& lists) {
  const auto fields = split_fields(line.text);
  if (fields.size() != 4) return line_error(path, line, "expected a time and a file, twice");
  int depth_count = 0;
  for (std::size_t i = 0; i < 4; i += 2) {
    const auto time = parse_finite(fields[i]);
    const std::string_view file = fields[i + 1];
    if (!time) return line_error(path, line, "the time is not a finite number");
    if (!stays_inside(file)) return line_error(path, line, "the file name leaves the folder");
    const auto number = number_of_png(file);
    lists.numbered = lists.numbered && number && static_cast<double>(*number) == *time;
    const bool is_depth = file.rfind("depth", 0) == 0 || file.rfind("./depth", 0) == 0;
    depth_count += is_depth ? 1 : 0;
    (is_depth ? lists.depths : lists.colors).push_back({*time, std::string(file)});
  }
  if (depth_count != 1)
    return line_error(path, line, "expected one file in depth/ and one in another folder");
  if (lists.depths.size() > kMaxFrames)
    return line_error(path, line, fmt::format("more than {} images", kMaxFrames));
  return Done{};
}

// Without associations.txt, images with equal numbers are paired.
Result<ImageLists> list_numbered_images(const std::string& folder) {
  ImageLists lists;
  for (const auto& [name, files] :
       {std::pair{"depth/", &lists.depths}, std::pair{"rgb/", &lists.colors}}) {
    const auto names = file_names(folder + "/" + name);
    if (!names.ok()) return names.error();
    for (const std::string& file : *names)
      if (const auto number = number_of_png(file))
        files->push_back({static_cast<double>(*number), name + file});
  }
  return lists;
}

Rigid3 reflect_y(const Rigid3& transform) {
  const Eigen::Quaterniond& q = transform.rotation;
  const Eigen::Vector3d& t = transform.translation;
  return {Eigen::Quaterniond(q.w(), -q.x(), q.y(), -q.z()), {t.x(), -t.y(), t.z()}};
}

Result<Trajectory> read_truth(const std::string& path) {
  Result<Trajectory> trajectory = read_tum_trajectory(path);
  if (!trajectory.ok()) return trajectory.error();
  for (TimedPose& pose : *trajectory) {
    if (pose.timestamp_s != std::floor(pose.timestamp_s) || pose.timestamp_s < 0)
      return Error{ErrorCode::kCorruptData,
                   fmt::format("{}: the frame number {:f} is not whole", path, pose.timestamp_s)};
    pose = {pose.timestamp_s / kFrameRate_hz, reflect_y(pose.world_from_camera)};
  }
  return trajectory;
}

bool has_numbered_images(const std::string& folder) {
  const auto names = file_names(folder + "/depth");
  return names.ok() && std::any_of(names->begin(), names->end(), [](const std::string& name) {
           return number_of_png(name).has_value();
         });
}

}  // namespace

Result<ImageLists> read_associations(const std::string& path) {
  const Result<std::string> text = read_text_file(path);
  if (!text.ok()) return text.error();
  ImageLists lists;
  for (const TextLine& line : data_lines(*text))
    if (const Status status = add_association(path, line, lists); !status.ok())
      return status.error();
  return lists;
}

std::optional<std::string> probe_icl_nuim(const std::string& folder) {
  if (!is_folder(folder + "/depth") || !is_folder(folder + "/rgb")) return std::nullopt;
  if (is_file(folder + "/associations.txt"))
    return "depth/, rgb/ and associations.txt (ICL-NUIM in its TUM layout)";
  if (has_numbered_images(folder))
    return "depth/ and rgb/ with numbered PNG files (ICL-NUIM in its TUM layout)";
  return std::nullopt;
}

Result<FolderContents> list_icl_nuim(const std::string& folder) {
  const std::string associations = folder + "/associations.txt";
  auto lists =
      is_file(associations) ? read_associations(associations) : list_numbered_images(folder);
  if (!lists.ok()) return lists.error();
  if (lists->numbered)
    for (auto* files : {&lists->colors, &lists->depths})
      for (TimedFile& file : *files) file.timestamp_s /= kFrameRate_hz;
  auto frames = pair_by_time(std::move(lists->colors), std::move(lists->depths));
  if (!frames.ok()) return in_context(folder, frames.error());

  FolderContents contents;
  contents.format = "icl-nuim";
  contents.frames = std::move(*frames);
  // If images are named by time stamps, they are from another sensor than the rendered one.
  if (lists->numbered) contents.camera = known_camera("icl-nuim");
  contents.camera_source = "ICL-NUIM's published camera, by the layout";
  const std::string truth_file = truth_file_of(folder);
  if (truth_file.empty()) return contents;
  Result<Trajectory> truth = read_truth(folder + "/" + truth_file);
  if (!truth.ok()) return truth.error();
  contents.groundtruth = std::move(*truth);
  return contents;
}

}  // namespace hermite::dataset
