// Folders of images in no particular format: numbered_images.h, or an associations.txt, and a
// camera.json.
#include <fmt/core.h>

#include "core/dataset/camera_file.h"
#include "core/dataset/numbered_images.h"
#include "core/dataset/recorded_folder.h"
#include "core/dataset/text_file.h"

namespace hermite::dataset {

std::optional<std::string> probe_image_folder(const std::string& folder) {
  if (!is_file(folder + "/camera.json")) return std::nullopt;
  if (is_file(folder + "/associations.txt"))
    return "camera.json and associations.txt (a folder of images)";
  const auto images = find_numbered_images(folder, kDefaultFrameRate_hz);
  if (!images.ok() || !images->has_value()) return std::nullopt;
  return fmt::format("camera.json and numbered images in {} (a folder of images)",
                     (*images)->where);
}

Result<FolderContents> list_image_folder(const std::string& folder) {
  FolderContents contents;
  contents.format = "images";
  const Result<CameraFile> camera = read_camera_json(folder + "/camera.json");
  if (!camera.ok()) return camera.error();
  if (const std::string associations = folder + "/associations.txt"; is_file(associations)) {
    auto lists = read_associations(associations);
    if (!lists.ok()) return lists.error();
    if (lists->numbered)
      for (auto* files : {&lists->colors, &lists->depths})
        for (TimedFile& file : *files) file.timestamp_s /= camera->frame_rate_hz;
    auto frames = pair_by_time(std::move(lists->colors), std::move(lists->depths));
    if (!frames.ok()) return in_context(folder, frames.error());
    contents.frames = std::move(*frames);
  } else {
    auto images = find_numbered_images(folder, camera->frame_rate_hz);
    if (!images.ok()) return images.error();
    if (!images->has_value())
      return Error{ErrorCode::kCorruptData, folder + ": there are no numbered images"};
    contents.frames = std::move((*images)->frames);
    if (!(*images)->has_times)
      contents.doubts.push_back(
          fmt::format("the images say no times: number N is taken to be N/{} s",
                      static_cast<int>(camera->frame_rate_hz)));
  }
  if (const std::string truth_path = folder + "/groundtruth.txt"; is_file(truth_path)) {
    Result<Trajectory> truth = read_tum_trajectory(truth_path);
    if (!truth.ok()) return truth.error();
    contents.groundtruth = std::move(*truth);
  }
  return contents;
}

}  // namespace hermite::dataset
