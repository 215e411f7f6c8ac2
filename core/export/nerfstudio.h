// A folder that nerfstudio trains from (docs.nerf.studio, "Custom Dataset"):
//
//   transforms.json                      intrinsics, and per image world_from_camera with x right,
//                                        y up, looking along -z
//   images/frame_000123.jpg ...          undistorted keyframes, see photo_set.h
//   depth/frame_000123.png ...           16 bits, millimetres (nerfstudio's default), 0: not
//                                        measured or beyond 65 m
//   points.ply                           the thinned cloud with normals and colours, as format_ply
//                                        writes it
//
// The world is the scan's. As in COLMAP, the first pixel begins at 0, here at -0.5. One thread.
#pragma once

#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/export/photo_set.h"

namespace hermite::exports {

struct NerfstudioImage {
  std::string name, depth_name;  // in images/ and depth/
  Rigid3 world_from_camera;
};

// Deterministic, pure.
std::string format_transforms_json(const Camera& rectified_camera,
                                   const std::vector<NerfstudioImage>& images);

// Writes the folder; see write_colmap for `path` and errors.
Result<PhotoSummary> write_nerfstudio(const PhotoSource& source, const PhotoOptions& options,
                                      const std::string& path, const ExportProgress& progress);

}  // namespace hermite::exports
