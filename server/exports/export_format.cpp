#include "server/exports/export_format.h"

#include <algorithm>
#include <array>

#include "core/output/glb.h"
#include "core/output/mesh_ply.h"

namespace hermite {

namespace {

constexpr std::array kFormats = {
    ExportFormat{"glb", "mesh.glb", "model/gltf-binary", "GLB, opens nearly everywhere", ExportKind::kMesh,
                 [](const TriangleMesh& mesh) { return format_mesh_glb(mesh, GlbCompression::kNone); }},
    ExportFormat{kViewerMesh, "mesh.draco.glb", "model/gltf-binary", "GLB, small (Draco)", ExportKind::kMesh,
                 [](const TriangleMesh& mesh) { return format_mesh_glb(mesh, GlbCompression::kDraco); }},
    ExportFormat{"mesh-ply", "mesh.ply", "application/octet-stream", "PLY", ExportKind::kMesh,
                 [](const TriangleMesh& mesh) -> Result<std::string> { return format_mesh_ply(mesh); }},
    ExportFormat{"cloud-ply", "cloud.ply", "application/octet-stream", "PLY, with normals and radii", ExportKind::kCloud},
    ExportFormat{"cloud-glb", "cloud.glb", "model/gltf-binary", "GLB", ExportKind::kCloud, nullptr, format_cloud_glb},
    ExportFormat{"trajectory", "trajectory.txt", "text/plain; charset=utf-8", "Path, TUM", ExportKind::kPath},
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
