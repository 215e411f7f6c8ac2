// What the readers of folders share: a list of image pairs, and the sequence that reads them. One file per format fills in the list.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"
#include "core/dataset/sequence.h"

namespace hermite {

inline constexpr std::size_t kMaxFrames = 10'000'000;  // four days at 30 Hz

struct FramePaths {
  double timestamp_s = 0;
  std::string color;  // relative to the folder
  std::string depth;
};

// What a reader finds in a folder, before any image is read.
struct FolderContents {
  std::string format;
  std::vector<FramePaths> frames;  // strictly ascending in time
  Trajectory groundtruth;
  std::optional<Camera> camera;              // of the folder's own files, or by a known name
  std::vector<std::uint16_t> invalid_depth;  // stored values that mean "no measurement" besides 0
};

// A row per format, tried in this order. `recognises` looks at names of files only; `list` returns errors naming the file and line.
// `color_camera`, where a format has one, tells the colour camera that goes with the folder's camera when the folder does not.
struct FolderFormat {
  const char* name;
  bool (*recognises)(const std::string& folder);
  Result<FolderContents> (*list)(const std::string& folder);
  std::optional<ColorCamera> (*color_camera)(const Camera& camera) = nullptr;
};

bool is_seven_scenes(const std::string& folder);
Result<FolderContents> list_seven_scenes(const std::string& folder);  // seven_scenes.cpp
std::optional<ColorCamera> seven_scenes_color_camera(const Camera& camera);
bool is_tum(const std::string& folder);
Result<FolderContents> list_tum(const std::string& folder);  // tum.cpp
bool is_icl_nuim(const std::string& folder);
Result<FolderContents> list_icl_nuim(const std::string& folder);  // icl_nuim.cpp

// A name in a list may only lead into the folder: no absolute path, no "..", no backslash.
bool stays_inside(std::string_view relative_path);

// Names of the files of a folder itself (not below), sorted. kNotFound or kIo; kTooLarge above 4 * kMaxFrames.
Result<std::vector<std::string>> file_names(const std::string& folder);

// Pairs colour with depth by time, at most 20 ms apart. A frame's time is its depth image's: geometry moves the camera.
struct TimedFile {
  double timestamp_s = 0;
  std::string path;  // relative to the folder
};
Result<std::vector<FramePaths>> pair_by_time(std::vector<TimedFile> colors, std::vector<TimedFile> depths);

// The sequence of a listed folder. kCorruptData when the first image that can be read has another size than the camera.
Result<std::unique_ptr<Sequence>> make_folder_sequence(const std::string& folder, FolderContents contents, double frame_rate_hz);

}  // namespace hermite
