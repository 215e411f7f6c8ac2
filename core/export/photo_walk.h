// The common part of the writers of folders with images: it finds, reads and writes keyframes one
// after another. The folder is written completely or not at all.
#pragma once

#include <functional>
#include <string>

#include "core/archive/whole_folder.h"
#include "core/base/result.h"
#include "core/export/photo_set.h"

namespace hermite::exports {

using WritePhoto =
    std::function<Status(const archive::WholeFolder& folder, const output::Cloud& points,
                         const SeenFrame& seen, const Photo& photo)>;
using WriteRest =
    std::function<Status(const archive::WholeFolder& folder, const output::Cloud& points)>;

struct PhotoWalk {
  const PhotoSource& source;
  const PhotoOptions& options;
  const std::string& path;
  const ExportProgress& progress;

  // Calls `photo` for each keyframe (at least one) and then `rest` once; both get the same cloud,
  // thinned to options.most_points. Returns errors as write_colmap.
  Result<PhotoSummary> write(const WritePhoto& photo, const WriteRest& rest) const;
};

}  // namespace hermite::exports
