#include "core/export/formats.h"

#include <fmt/core.h>

#include <iterator>

#include "core/archive/whole_folder.h"
#include "core/dataset/trajectory_formats.h"
#include "core/export/colmap.h"
#include "core/export/nerfstudio.h"
#include "core/output/cloud_check.h"
#include "core/output/glb.h"
#include "core/output/las.h"
#include "core/output/mesh_check.h"
#include "core/output/mesh_ply.h"
#include "core/output/obj.h"
#include "core/output/ply.h"
#include "core/output/splats.h"
#include "core/output/stl.h"
#include "core/plan/plan_drawing.h"

namespace hermite::exports {
namespace {

Result<output::NamedFiles> one_file(const char* name, Result<std::string> bytes) {
  if (!bytes.ok()) return bytes.error();
  return output::NamedFiles{{name, *std::move(bytes)}};
}

Result<output::NamedFiles> mesh_as_glb(const output::TriangleMesh& mesh) {
  return one_file("scan.glb", output::format_mesh_glb(mesh, output::GlbCompression::kNone));
}
Result<output::NamedFiles> mesh_as_draco(const output::TriangleMesh& mesh) {
  return one_file("scan.glb", output::format_mesh_glb(mesh, output::GlbCompression::kDraco));
}
Result<output::NamedFiles> mesh_as_ply(const output::TriangleMesh& mesh) {
  if (const Status status = output::check_mesh(mesh); !status.ok()) return status.error();
  return one_file("mesh.ply", output::format_mesh_ply(mesh));
}
Result<output::NamedFiles> mesh_as_stl(const output::TriangleMesh& mesh) {
  return one_file("scan.stl", output::format_stl(mesh));
}
Result<output::NamedFiles> cloud_as_ply(const output::Cloud& cloud) {
  if (const Status status = output::check_cloud_with_points(cloud); !status.ok())
    return status.error();
  return one_file("points.ply", output::format_ply(cloud));
}
Result<output::NamedFiles> cloud_as_las(const output::Cloud& cloud) {
  return one_file("scan.las", output::format_las(cloud));
}
Result<output::NamedFiles> cloud_as_glb(const output::Cloud& cloud) {
  return one_file("points.glb", output::format_cloud_glb(cloud));
}
Result<output::NamedFiles> cloud_as_splats(const output::Cloud& cloud) {
  return one_file("splats.ply", output::format_splats(cloud));
}
Result<output::NamedFiles> plan_as_svg(const plan::FloorPlan& plan) {
  return one_file("plan.svg", plan::format_plan_svg(plan));
}
Result<output::NamedFiles> plan_as_dxf(const plan::FloorPlan& plan) {
  return one_file("plan.dxf", plan::format_plan_dxf(plan));
}
Result<output::NamedFiles> plan_as_json(const plan::FloorPlan& plan) {
  return one_file("plan.json", plan::format_plan_json(plan));
}
Result<output::NamedFiles> trajectory_as_tum(const dataset::Trajectory& trajectory) {
  return one_file("trajectory.txt", dataset::format_tum_trajectory(trajectory));
}
Result<output::NamedFiles> trajectory_as_kitti(const dataset::Trajectory& trajectory) {
  return one_file("poses.txt", dataset::format_kitti_trajectory(trajectory));
}
Result<output::NamedFiles> trajectory_as_log(const dataset::Trajectory& trajectory) {
  const std::vector<bool> tracked = dataset::tracked_frames(trajectory);
  dataset::Trajectory poses;
  std::vector<std::int64_t> frames;
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    if (!tracked[i]) continue;
    poses.push_back(trajectory[i]);
    frames.push_back(static_cast<std::int64_t>(i));
  }
  return one_file("trajectory.log", dataset::format_log_trajectory(poses, frames));
}

// In the order of export_formats().
constexpr ExportFormat kFormats[] = {
    {.name = "glb",
     .description = "mesh as binary glTF 2.0",
     .is_folder = false,
     .takes_texture = true,
     .of_mesh = mesh_as_glb},
    {.name = "glb-draco",
     .description = "the same, compressed with Draco",
     .is_folder = false,
     .takes_texture = true,
     .of_mesh = mesh_as_draco},
    {.name = "obj",
     .description = "mesh as a folder with OBJ, MTL and images",
     .is_folder = true,
     .takes_texture = true,
     .of_mesh = output::format_obj},
    {.name = "ply", .description = "mesh as PLY", .is_folder = false, .of_mesh = mesh_as_ply},
    {.name = "stl",
     .description = "mesh as STL, in millimetres",
     .is_folder = false,
     .of_mesh = mesh_as_stl},
    {.name = "points-ply",
     .description = "cloud as PLY",
     .is_folder = false,
     .of_cloud = cloud_as_ply},
    {.name = "las",
     .description = "cloud as LAS 1.4",
     .is_folder = false,
     .of_cloud = cloud_as_las},
    {.name = "points-glb",
     .description = "cloud as binary glTF 2.0",
     .is_folder = false,
     .of_cloud = cloud_as_glb},
    {.name = "splats",
     .description = "cloud as 3D Gaussians, PLY",
     .is_folder = false,
     .of_cloud = cloud_as_splats},
    {.name = "plan-svg",
     .description = "floor plan as a drawing on paper, SVG",
     .is_folder = false,
     .of_plan = plan_as_svg},
    {.name = "plan-dxf",
     .description = "floor plan in metres, DXF",
     .is_folder = false,
     .of_plan = plan_as_dxf},
    {.name = "plan-json",
     .description = "floor plan as numbers, JSON",
     .is_folder = false,
     .of_plan = plan_as_json},
    {.name = "tum",
     .description = "trajectory in TUM format",
     .is_folder = false,
     .of_trajectory = trajectory_as_tum},
    {.name = "kitti",
     .description = "trajectory in KITTI format",
     .is_folder = false,
     .of_trajectory = trajectory_as_kitti},
    {.name = "log",
     .description = "trajectory in Redwood and Open3D format",
     .is_folder = false,
     .of_trajectory = trajectory_as_log},
    {.name = "colmap",
     .description = "keyframes, poses and points as a COLMAP model",
     .is_folder = true,
     .of_photos = write_colmap},
    {.name = "nerfstudio",
     .description = "keyframes, poses and points for nerfstudio",
     .is_folder = true,
     .of_photos = write_nerfstudio},
};

}  // namespace

const std::vector<ExportFormat>& export_formats() {
  static const std::vector<ExportFormat> formats(std::begin(kFormats), std::end(kFormats));
  return formats;
}

Result<ExportFormat> export_format_named(std::string_view name) {
  std::string names;
  for (const ExportFormat& format : export_formats()) {
    if (name == format.name) return format;
    names += (names.empty() ? "" : ", ") + std::string(format.name);
  }
  return Error{ErrorCode::kInvalidArgument,
               fmt::format("there is no format '{}', there are {}", name.substr(0, 40), names)};
}

Status write_export(const ExportFormat& format, const output::NamedFiles& files,
                    const std::string& path) {
  if (!format.is_folder) {
    CHECK(files.size() == 1, "the format must have exactly one file");
    return output::write_file_atomically(path, files.front().bytes);
  }
  Result<archive::WholeFolder> folder = archive::WholeFolder::make(path);
  if (!folder.ok()) return folder.error();
  for (const output::NamedFile& file : files)
    if (const Status status = folder->write({file.name}, file.bytes); !status.ok()) return status;
  return folder->finish();
}

}  // namespace hermite::exports
