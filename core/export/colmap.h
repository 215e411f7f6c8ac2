// A COLMAP model as text (colmap.github.io/format.html), in the folder layout that COLMAP and splat programs open:
//
//   images/frame_000123.jpg ...          keyframes without distortion, see photo_set.h
//   sparse/0/cameras.txt                 one PINHOLE
//   sparse/0/images.txt                  camera_from_world: quaternion (w first), translation [m]; the points seen there
//   sparse/0/points3D.txt                the cloud thinned: position [m], colour, error 0, and the pictures that see it
//
// The world is the scan's. COLMAP's pixels begin at 0 where ours begin at -0.5: positions and cx, cy are greater by a half. One thread.
#pragma once

#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/export/photo_set.h"
#include "core/export/sightings.h"

namespace hermite {

struct ColmapImage {
  std::string name;
  Rigid3 world_from_camera;
};

// Ids count from 1 in the order given; a point's place in an image is that in the order of points. Deterministic, pure.
std::string format_colmap_cameras(const Camera& rectified_camera);
std::string format_colmap_images(const std::vector<ColmapImage>& images, const std::vector<std::vector<Sighting>>& tracks);
std::string format_colmap_points(const Cloud& points, const std::vector<std::vector<Sighting>>& tracks);

// `path` is a new folder, which is there as a whole or not at all (WholeFolder). kInvalidArgument: the cloud (check_cloud_with_points),
// the folder; kNotFound: find_keyframes; kIo; kBusy: ended by `progress`.
Result<PhotoSummary> write_colmap(const PhotoSource& source, const PhotoOptions& options, const std::string& path,
                                  const ExportProgress& progress);

}  // namespace hermite
