// The table of export formats, for the command line and the server.
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
#include "core/plan/floor_plan.h"

namespace hermite::exports {

// Exactly one of the functions is set; it shows what the format is made from.
struct ExportFormat {
  const char* name;
  const char* description;  // for users
  bool is_folder;           // false: the export is a single file
  bool takes_texture = false;
  Result<output::NamedFiles> (*of_mesh)(const output::TriangleMesh& mesh) = nullptr;
  Result<output::NamedFiles> (*of_cloud)(const output::Cloud& cloud) = nullptr;
  Result<output::NamedFiles> (*of_plan)(const plan::FloorPlan& plan) = nullptr;
  Result<output::NamedFiles> (*of_trajectory)(const dataset::Trajectory& trajectory) = nullptr;
  Result<PhotoSummary> (*of_photos)(const PhotoSource& source, const PhotoOptions& options,
                                    const std::string& path,
                                    const ExportProgress& progress) = nullptr;
};

// In the order in which they are listed to users.
const std::vector<ExportFormat>& export_formats();

// Returns kInvalidArgument with the list of names for an unknown one.
Result<ExportFormat> export_format_named(std::string_view name);

// Writes one file (write_file_atomically, replacing a previous one) or a new folder (WholeFolder).
// Returns their errors.
Status write_export(const ExportFormat& format, const output::NamedFiles& files,
                    const std::string& path);

}  // namespace hermite::exports
