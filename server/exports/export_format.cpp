#include "server/exports/export_format.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/archive/zip.h"
#include "core/dataset/trajectory_formats.h"
#include "core/output/glb.h"
#include "core/output/las.h"
#include "core/output/mesh_ply.h"
#include "core/output/obj.h"
#include "core/output/splats.h"
#include "core/output/stl.h"

namespace hermite {

namespace {

// OBJ names its materials and images in files of their own.
Result<std::string> format_obj_zip(const TriangleMesh& mesh) {
  Result<NamedFiles> files = format_obj(mesh);
  if (!files.ok()) return files.error();
  ZipEntries entries;
  for (NamedFile& file : *files) entries.emplace_back(std::move(file.name), std::move(file.bytes));
  return format_zip(entries);
}

Result<std::string> format_tracked_log(const Trajectory& trajectory) {
  const std::vector<bool> tracked = tracked_frames(trajectory);
  Trajectory poses;
  std::vector<std::int64_t> frames;
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    if (!tracked[i]) continue;
    poses.push_back(trajectory[i]);
    frames.push_back(static_cast<std::int64_t>(i));
  }
  return format_log_trajectory(poses, frames);
}

constexpr const char* kGlbType = "model/gltf-binary";
constexpr const char* kBytesType = "application/octet-stream";
constexpr const char* kTextType = "text/plain; charset=utf-8";

constexpr ExportFormat mesh_format(std::string_view name, std::string_view file, const char* type, std::string_view words,
                                   Result<std::string> (*make)(const TriangleMesh&)) {
  return {name, file, type, words, ExportKind::kMesh, make, nullptr, nullptr};
}
constexpr ExportFormat cloud_format(std::string_view name, std::string_view file, const char* type, std::string_view words,
                                    Result<std::string> (*make)(const Cloud&)) {
  return {name, file, type, words, ExportKind::kCloud, nullptr, make, nullptr};
}
constexpr ExportFormat path_format(std::string_view name, std::string_view file, std::string_view words,
                                   Result<std::string> (*make)(const Trajectory&)) {
  return {name, file, kTextType, words, ExportKind::kPath, nullptr, nullptr, make};
}

constexpr std::array kFormats = {
    mesh_format("glb", "mesh.glb", kGlbType, "GLB, opens nearly everywhere",
                [](const TriangleMesh& mesh) { return format_mesh_glb(mesh, GlbCompression::kNone); }),
    mesh_format(kViewerMesh, "mesh.draco.glb", kGlbType, "GLB, small (Draco)",
                [](const TriangleMesh& mesh) { return format_mesh_glb(mesh, GlbCompression::kDraco); }),
    mesh_format("obj", "mesh-obj.zip", "application/zip", "OBJ", format_obj_zip),
    mesh_format("mesh-ply", "mesh.ply", kBytesType, "PLY",
                [](const TriangleMesh& mesh) -> Result<std::string> { return format_mesh_ply(mesh); }),
    mesh_format("stl", "mesh.stl", "model/stl", "STL, for printing", format_stl),
    cloud_format("cloud-ply", "cloud.ply", kBytesType, "PLY, with all that is known", nullptr),
    cloud_format("las", "cloud.las", "application/vnd.las", "LAS 1.4", format_las),
    cloud_format("cloud-glb", "cloud.glb", kGlbType, "GLB", format_cloud_glb),
    cloud_format("splats", "splats.ply", kBytesType, "Gaussian splats", format_splats),
    path_format("trajectory", "trajectory.txt", "TUM", nullptr),
    path_format("kitti", "trajectory.kitti.txt", "KITTI",
                [](const Trajectory& path) -> Result<std::string> { return format_kitti_trajectory(path); }),
    path_format("log", "trajectory.log", "LOG, as Open3D has it", format_tracked_log),
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
