#include "core/export/photo_walk.h"

#include "core/output/cloud_check.h"
#include "core/output/thin.h"

namespace hermite::exports {

Result<PhotoSummary> PhotoWalk::write(const WritePhoto& write_photo,
                                      const WriteRest& write_rest) const {
  if (const Status status = output::check_cloud_with_points(source.cloud); !status.ok())
    return status.error();
  Result<archive::WholeFolder> folder = archive::WholeFolder::make(path);
  if (!folder.ok()) return folder.error();
  const Result<std::vector<SeenFrame>> seen = frames_with_poses(source.sequence, source.trajectory);
  if (!seen.ok()) return seen.error();
  // Measuring the sharpness of all frames is most of the work; keyframes are read again later.
  const Result<std::vector<SeenFrame>> keyframes =
      find_keyframes(source.sequence, *seen, options.keyframes, progress);
  if (!keyframes.ok()) return keyframes.error();
  const output::Cloud points = output::thinned(source.cloud, options.most_points);
  const PhotoReader reader(source.sequence);
  PhotoSummary summary{static_cast<std::size_t>(source.sequence.frame_count()), seen->size(), 0,
                       points.size()};
  for (const SeenFrame& keyframe : *keyframes) {
    if (!progress(static_cast<std::int64_t>(seen->size()), static_cast<std::int64_t>(seen->size())))
      return ended_early();
    const Result<Photo> photo = reader.read(keyframe.index);
    if (!photo.ok()) return in_context("frame " + std::to_string(keyframe.index), photo.error());
    if (const Status status = write_photo(*folder, points, keyframe, *photo); !status.ok())
      return status.error();
    ++summary.image_count;
  }
  if (const Status status = write_rest(*folder, points); !status.ok()) return status.error();
  if (const Status status = folder->finish(); !status.ok()) return status.error();
  return summary;
}

}  // namespace hermite::exports
