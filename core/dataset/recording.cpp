#include "core/dataset/recording.h"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>

#include "core/archive/fresh_folder.h"
#include "core/archive/unpack.h"
#include "core/dataset/recorded_folder.h"
#include "core/dataset/text_file.h"

namespace hermite::dataset {
namespace {

namespace fs = std::filesystem;

constexpr RecordingFormat kFormats[] = {
    {"raw frames", "a file that begins with HRMFRAME", probe_raw, open_raw},
    {"frame log", "a folder with segment-000000.rlog", probe_frame_log, open_frame_log},
    {"OpenNI", "an .oni file", probe_oni, open_oni},
    {"ScanNet", "a .sens file of version 4", probe_sens, open_sens},
    {"klg", "a .klg log", probe_klg, open_klg},
    {"7-Scenes", "frame-NNNNNN.depth.png files", probe_seven_scenes,
     [](const std::string& path, const std::optional<Camera>& camera) {
       return open_folder(path, camera, list_seven_scenes, seven_scenes_color_camera);
     }},
    {"TUM", "rgb.txt and depth.txt", probe_tum,
     [](const std::string& path, const std::optional<Camera>& camera) {
       return open_folder(path, camera, list_tum);
     }},
    {"Redwood", "numbered images with a .log of poses", probe_redwood,
     [](const std::string& path, const std::optional<Camera>& camera) {
       return open_folder(path, camera, list_redwood);
     }},
    {"ICL-NUIM", "depth/ and rgb/ with numbered PNG files", probe_icl_nuim,
     [](const std::string& path, const std::optional<Camera>& camera) {
       return open_folder(path, camera, list_icl_nuim);
     }},
    {"images", "numbered images with a camera.json", probe_image_folder,
     [](const std::string& path, const std::optional<Camera>& camera) {
       return open_folder(path, camera, list_image_folder);
     }},
};

constexpr int kMaxSearchDepth = 3;
constexpr std::size_t kMaxSearched = 2000;  // files and folders that are examined

struct Found {
  std::string path;
  std::string reason;
  const RecordingFormat* format = nullptr;
};

std::optional<Found> probe(const std::string& path) {
  for (const RecordingFormat& format : kFormats)
    if (auto reason = format.probe(path)) return Found{path, std::move(*reason), &format};
  return std::nullopt;
}

std::vector<std::string> children_of(const std::vector<std::string>& folders, std::size_t limit) {
  std::vector<std::string> children;
  for (const std::string& folder : folders) {
    std::error_code failure;
    for (fs::directory_iterator entries(folder, failure), end;
         !failure && entries != end && children.size() < limit; entries.increment(failure))
      children.push_back(entries->path().string());
  }
  std::sort(children.begin(), children.end());
  return children;
}

Error not_recognised(const std::string& path) {
  std::string message = path + " is no recording we know, and none lies in it. Known are:";
  for (const RecordingFormat& format : kFormats)
    message +=
        fmt::format("{} {} ({})", &format == kFormats ? "" : ";", format.looks_like, format.name);
  return {ErrorCode::kUnsupported, message};
}

// Finds the recording at `path`, or else the only one on the first level below it that has any.
Result<Found> find_recording(const std::string& path) {
  if (auto found = probe(path)) return *std::move(found);
  std::vector<std::string> folders{path};
  std::size_t searched = 0;
  for (int depth = 0; depth < kMaxSearchDepth && is_folder(path); ++depth) {
    std::vector<Found> found;
    const std::vector<std::string> children = children_of(folders, kMaxSearched - searched);
    searched += children.size();
    for (const std::string& child : children)
      if (auto one = probe(child)) found.push_back(*std::move(one));
    if (found.size() == 1) return found.front();
    if (found.size() > 1)
      return Error{ErrorCode::kInvalidArgument,
                   fmt::format("{} holds {} recordings, among them {} and {}: give one of them",
                               path, found.size(), found[0].path, found[1].path)};
    folders.clear();
    std::copy_if(children.begin(), children.end(), std::back_inserter(folders), is_folder);
  }
  return not_recognised(path);
}

Result<Recording> open_in_place(const std::string& path, const std::optional<Camera>& camera) {
  const Result<Found> found = find_recording(path);
  if (!found.ok()) return found.error();
  Result<Recording> recording = found->format->open(found->path, camera);
  if (!recording.ok()) return recording.error();
  recording->format_reason = found->reason;
  if (found->path != path)
    recording->format_reason += " in " + fs::path(found->path).lexically_relative(path).string();
  return recording;
}

// Keeps the unpacked files as long as the sequence that reads them.
class UnpackedSequence : public Sequence {
 public:
  UnpackedSequence(archive::TemporaryFolder folder, std::string name,
                   std::unique_ptr<Sequence> sequence)
      : folder_(std::move(folder)), name_(std::move(name)), sequence_(std::move(sequence)) {}

  std::string format() const override { return sequence_->format(); }
  std::string name() const override { return name_; }
  const Camera& camera() const override { return sequence_->camera(); }
  double frame_rate_hz() const override { return sequence_->frame_rate_hz(); }
  std::int64_t frame_count() const override { return sequence_->frame_count(); }
  double timestamp_s(std::int64_t index) const override { return sequence_->timestamp_s(index); }
  Result<RecordedFrame> read(std::int64_t index) const override { return sequence_->read(index); }
  const Trajectory& groundtruth() const override { return sequence_->groundtruth(); }

 private:
  const archive::TemporaryFolder folder_;
  const std::string name_;
  const std::unique_ptr<Sequence> sequence_;
};

// Returns "kitchen" for "scans/kitchen.tar.zst".
std::string name_of_archive(const std::string& path) {
  fs::path name = fs::path(path).stem();
  if (name.extension() == ".tar") name = name.stem();
  return name.string();
}

Result<Recording> open_archive(const std::string& path, const std::optional<Camera>& camera) {
  Result<archive::TemporaryFolder> folder = archive::TemporaryFolder::make();
  if (!folder.ok()) return folder.error();
  // The folder is named after the archive, because readers recognise benchmarks by folder names.
  const std::string inside = folder->path() + "/" + name_of_archive(path);
  const Result<archive::UnpackSummary> unpacked = archive::unpack_archive(path, inside);
  if (!unpacked.ok()) return unpacked.error();
  Result<Recording> recording = open_in_place(inside, camera);
  if (!recording.ok()) return in_context(path, recording.error());
  recording->format_reason +=
      fmt::format(", in an archive ({}, {} files)", unpacked->kind, unpacked->file_count);
  recording->sequence = std::make_unique<UnpackedSequence>(
      std::move(*folder), name_of_archive(path), std::move(recording->sequence));
  return recording;
}

}  // namespace

Result<Recording> open_recording(const std::string& path, const std::optional<Camera>& camera) {
  if (camera)
    if (const Status status = validate(*camera); !status.ok()) return status.error();
  if (!is_file(path) && !is_folder(path))
    return Error{ErrorCode::kNotFound, "there is neither a file nor a folder " + path};
  return is_file(path) && archive::is_archive(path) ? open_archive(path, camera)
                                                    : open_in_place(path, camera);
}

}  // namespace hermite::dataset
