// What the writers of folders with pictures have in common: the keyframes are found, read and written one after the other, and the folder
// is there as a whole or not at all.
#pragma once

#include <functional>
#include <string>

#include "core/archive/whole_folder.h"
#include "core/base/result.h"
#include "core/export/photo_set.h"

namespace hermite {

using WritePicture = std::function<Status(const WholeFolder& folder, const Cloud& points, const SeenFrame& seen, const Picture& picture)>;
using WriteRest = std::function<Status(const WholeFolder& folder, const Cloud& points)>;

struct PhotoWalk {
  const PhotoSource& source;
  const PhotoOptions& options;
  const std::string& path;
  const ExportProgress& progress;

  // `picture` gets each keyframe (at least one), `rest` is called once behind them; both get the cloud thinned to
  // options.most_points, the same object each time. Errors: write_colmap.
  Result<PhotoSummary> write(const WritePicture& picture, const WriteRest& rest) const;
};

}  // namespace hermite
