// What can be taken away of a scan that has ended: a table. A new format is one row.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "core/base/result.h"
#include "core/dataset/trajectory.h"
#include "core/output/cloud.h"
#include "core/output/triangle_mesh.h"

namespace hermite {

enum class ExportKind { kMesh, kCloud, kPath };
const char* name_of(ExportKind kind);  // "mesh", "cloud", "path"

struct ExportFormat {
  std::string_view name;  // in requests: "glb"
  std::string_view file;  // what it is called: "mesh.glb"
  const char* content_type;
  std::string_view words;  // for people, beside others of its kind: "GLB"
  ExportKind kind;
  // One of these makes it; without one it is a result that the scan has left. Errors as of their writers; nothing outside is touched.
  Result<std::string> (*of_mesh)(const TriangleMesh&) = nullptr;
  Result<std::string> (*of_cloud)(const Cloud&) = nullptr;
  Result<std::string> (*of_path)(const Trajectory&) = nullptr;

  bool is_result() const { return !of_mesh && !of_cloud && !of_path; }
};

// The mesh that the viewer shows: small, and quick to be read.
inline constexpr std::string_view kViewerMesh = "glb-draco";

std::span<const ExportFormat> export_formats();                 // in the order in which people are shown them
const ExportFormat* find_export_format(std::string_view name);  // null: there is none

}  // namespace hermite
