#include "server/exports/export_format.h"

#include <algorithm>
#include <array>

#include "core/output/mesh_ply.h"

namespace hermite {

namespace {

constexpr std::array kFormats = {
    ExportFormat{"mesh-ply", "mesh.ply", "application/octet-stream", "Mesh, PLY", ExportKind::kMesh,
                 [](const TriangleMesh& mesh) -> Result<std::string> { return format_mesh_ply(mesh); }},
    ExportFormat{"cloud-ply", "cloud.ply", "application/octet-stream", "Points, PLY", ExportKind::kCloud},
    ExportFormat{"trajectory", "trajectory.txt", "text/plain; charset=utf-8", "Path of the camera, TUM", ExportKind::kPath},
};

}  // namespace

const char* name_of(ExportKind kind) {
  switch (kind) {
    case ExportKind::kMesh: return "mesh";
    case ExportKind::kCloud: return "cloud";
    case ExportKind::kPath: return "path";
  }
  return "mesh";
}

std::span<const ExportFormat> export_formats() { return kFormats; }

const ExportFormat* find_export_format(std::string_view name) {
  const auto found = std::find_if(kFormats.begin(), kFormats.end(), [name](const ExportFormat& format) { return format.name == name; });
  return found == kFormats.end() ? nullptr : &*found;
}

}  // namespace hermite
