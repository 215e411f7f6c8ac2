// A COLMAP model as text (colmap.github.io/format.html), in the folder layout that COLMAP and splat
// programs open:
//
//   images/frame_000123.jpg ...          undistorted keyframes, see photo_set.h
//   sparse/0/cameras.txt                 one PINHOLE camera
//   sparse/0/images.txt                  camera_from_world: quaternion (w first), translation [m];
//                                        the points seen there
//   sparse/0/points3D.txt                the thinned cloud: position [m], colour, error 0, and the
//                                        images that see it
//
// The world is the scan's. In COLMAP the first pixel begins at 0, here at -0.5, so positions, cx
// and cy are larger by 0.5. One thread.
#pragma once

#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/export/photo_set.h"
#include "core/export/sightings.h"

namespace hermite::exports {

struct ColmapImage {
  std::string name;
  Rigid3 world_from_camera;
};

// Ids count from 1 in the given order; the index of a point in an image follows the order of
// points. Deterministic, pure.
std::string format_colmap_cameras(const Camera& rectified_camera);
std::string format_colmap_images(const std::vector<ColmapImage>& images,
                                 const std::vector<std::vector<Sighting>>& tracks);
std::string format_colmap_points(const output::Cloud& points,
                                 const std::vector<std::vector<Sighting>>& tracks);

// Writes a model to `path`, a new folder that is written completely or not at all (WholeFolder).
// Returns kInvalidArgument for the cloud (check_cloud_with_points) or the folder, kNotFound as
// find_keyframes, kIo, and kBusy when `progress` stopped it.
Result<PhotoSummary> write_colmap(const PhotoSource& source, const PhotoOptions& options,
                                  const std::string& path, const ExportProgress& progress);

}  // namespace hermite::exports
