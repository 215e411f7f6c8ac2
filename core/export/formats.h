// What a scan can be exported as: one table for the command line and whoever else asks.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"
#include "core/dataset/trajectory.h"
#include "core/export/photo_set.h"
#include "core/output/cloud.h"
#include "core/output/named_file.h"
#include "core/output/triangle_mesh.h"

namespace hermite {

// Just one of the functions is there: it says what the format is made of.
struct ExportFormat {
  const char* name;
  const char* words;  // for people: what it is
  bool is_folder;     // else the one file that comes of it is the export
  bool takes_texture = false;
  Result<NamedFiles> (*of_mesh)(const TriangleMesh& mesh) = nullptr;
  Result<NamedFiles> (*of_cloud)(const Cloud& cloud) = nullptr;
  Result<NamedFiles> (*of_trajectory)(const Trajectory& trajectory) = nullptr;
  Result<PhotoSummary> (*of_pictures)(const PhotoSource& source, const PhotoOptions& options, const std::string& path,
                                      const ExportProgress& progress) = nullptr;
};

// In the order in which they are shown.
const std::vector<ExportFormat>& export_formats();

// kInvalidArgument, naming those that there are.
Result<ExportFormat> export_format_named(std::string_view name);

// One file (write_file_atomically: what was there is replaced), or a new folder (WholeFolder). Their errors.
Status write_export(const ExportFormat& format, const NamedFiles& files, const std::string& path);

}  // namespace hermite
