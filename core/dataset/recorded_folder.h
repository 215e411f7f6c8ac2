// Shared by the readers of folders: a list of image pairs, and the sequence that reads them. Each
// format has one file that fills in the list.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"
#include "core/dataset/accelerometer.h"
#include "core/dataset/recording.h"

namespace hermite::dataset {

inline constexpr std::size_t kMaxFrames = 10'000'000;  // four days at 30 Hz

struct FramePaths {
  double timestamp_s = 0;
  std::string color;  // relative to the folder
  std::string depth;
  std::optional<Eigen::Vector3d> acceleration_m_s2{};  // as in frame::RgbdFrame
};

// The result of listing a folder, before any image is read.
struct FolderContents {
  std::string format;
  std::vector<FramePaths> frames;  // strictly ascending in time
  Trajectory groundtruth;
  std::optional<Camera> camera;  // from the folder's own files, or by a well-known name
  std::string camera_source;     // which of these
  // In the accelerometer's own axes, with how these lie to the camera, where that is known.
  std::vector<TimedAcceleration> felt;
  std::optional<Eigen::Matrix3d> camera_from_accelerometer;
  std::vector<std::string> doubts;
  std::vector<std::uint16_t> invalid_depth;  // stored values that mean "no measurement" besides 0
};

// `probe` returns why the folder has the format, by file names and, if these are ambiguous, by
// content; std::nullopt if it does not. `list` returns errors that name the file and line.
std::optional<std::string> probe_seven_scenes(const std::string& folder);  // seven_scenes.cpp
Result<FolderContents> list_seven_scenes(const std::string& folder);
std::optional<ColorCamera> seven_scenes_color_camera(const Camera& camera);
std::optional<std::string> probe_tum(const std::string& folder);  // tum.cpp
Result<FolderContents> list_tum(const std::string& folder);
std::optional<std::string> probe_redwood(const std::string& folder);  // redwood.cpp
Result<FolderContents> list_redwood(const std::string& folder);
std::optional<std::string> probe_icl_nuim(const std::string& folder);  // icl_nuim.cpp
Result<FolderContents> list_icl_nuim(const std::string& folder);
std::optional<std::string> probe_image_folder(const std::string& folder);  // image_folder.cpp
Result<FolderContents> list_image_folder(const std::string& folder);

// Opens the listed folder with its camera: `given`, else the folder's camera.json, else the listed
// one. `color_camera`, for formats that have one, returns the colour camera for the folder's depth
// camera when no other source contains it.
Result<Recording> open_folder(
    const std::string& folder, const std::optional<Camera>& given,
    Result<FolderContents> (*list)(const std::string& folder),
    std::optional<ColorCamera> (*color_camera)(const Camera& camera) = nullptr);

// Returns whether a name in a list stays inside the folder: no absolute path, no "..", no
// backslash.
bool stays_inside(std::string_view relative_path);

// Returns the names of the files in a folder (not below it), sorted. kNotFound or kIo; kTooLarge
// above 4 * kMaxFrames.
Result<std::vector<std::string>> file_names(const std::string& folder);

// Associations as written by the TUM benchmark's tools: lines "time file time file", with one file
// in depth*/.
struct TimedFile {
  double timestamp_s = 0;
  std::string path;  // relative to the folder
};
struct ImageLists {
  std::vector<TimedFile> colors, depths;
  bool numbered = true;  // every stamp is the number of its file
};
Result<ImageLists> read_associations(const std::string& path);  // icl_nuim.cpp

// Pairs colour with depth by time, at most 20 ms apart. A frame has the time of its depth image,
// because the pose is mainly estimated from depth.
Result<std::vector<FramePaths>> pair_by_time(std::vector<TimedFile> colors,
                                             std::vector<TimedFile> depths);

// Returns the sequence of a listed folder. kCorruptData when the first readable image has another
// size than the camera.
Result<std::unique_ptr<Sequence>> make_folder_sequence(const std::string& folder,
                                                       FolderContents contents,
                                                       double frame_rate_hz);

}  // namespace hermite::dataset
