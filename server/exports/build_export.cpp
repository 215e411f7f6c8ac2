#include "server/exports/build_export.h"

#include <utility>

#include "core/archive/zip.h"
#include "core/base/check.h"
#include "core/mesh/contour.h"
#include "core/output/ply_reader.h"

namespace hermite {

namespace {

constexpr const char* kCloud = "cloud.ply";
constexpr const char* kSurfels = "surfels.ply";  // what meshes are made of; scans of older servers have none
constexpr const char* kTrajectory = "trajectory.txt";
constexpr double kContouring = 0.9;  // of the time that a mesh and its file take

}  // namespace

Result<Cloud> ExportBuilder::read_points(const std::string& scan_id, const std::string& name) {
  const Result<std::string> bytes = read_blob(blobs_, scan_id, name, kMaxExportCloud_bytes);
  if (!bytes.ok()) return bytes.error();
  const Result<PlyShape> shape = parse_ply(*bytes);
  if (!shape.ok()) return in_context(name, shape.error());
  if (shape->positions.empty()) return Error{ErrorCode::kInvalidArgument, name + " has no points"};
  return cloud_of(*shape);
}

Result<Trajectory> ExportBuilder::read_path(const std::string& scan_id) {
  const Result<std::string> text = read_blob(blobs_, scan_id, kTrajectory, kMaxExportCloud_bytes);
  if (!text.ok()) return text.error();
  Result<Trajectory> path = parse_tum_trajectory(*text);
  return path.ok() ? std::move(path) : in_context(kTrajectory, path.error());
}

Status ExportBuilder::make_mesh(const std::string& scan_id, const BuildProgress& progress) {
  const std::string source = blobs_.size_bytes(scan_id, kSurfels).ok() ? kSurfels : kCloud;
  const Result<std::string> version = blobs_.version(scan_id, source);
  if (!version.ok()) return version.error();
  if (mesh_ && mesh_->scan_id == scan_id && mesh_->source_version == *version) return Done{};
  mesh_.reset();  // before there are two
  const Result<Cloud> cloud = read_points(scan_id, source);
  if (!cloud.ok()) return cloud.error();
  Result<TriangleMesh> mesh = contour(*cloud, {}, [&progress](double done) { return progress(kContouring * done); });
  if (!mesh.ok()) return mesh.error();
  if (mesh->triangles.empty())
    return Error{ErrorCode::kInvalidArgument,
                 "the " + std::to_string(cloud->size()) + " points of the scan are too few or too far apart to make a surface"};
  mesh_ = KnownMesh{scan_id, *version, *std::move(mesh)};
  return Done{};
}

Result<NamedFiles> ExportBuilder::files_of(const ExportFormat& format, const std::string& scan_id, const BuildProgress& progress) {
  const Error stopped{ErrorCode::kBusy, "stopped"};
  if (!progress(0)) return stopped;
  if (format.of_mesh) {
    if (Status made = make_mesh(scan_id, progress); !made.ok()) return made.error();
    return progress(kContouring) ? format.of_mesh(mesh_->mesh) : stopped;
  }
  if (format.of_trajectory) {
    const Result<Trajectory> path = read_path(scan_id);
    return path.ok() ? format.of_trajectory(*path) : path.error();
  }
  CHECK(format.of_cloud, "an offer is made of results");
  const Result<Cloud> cloud = read_points(scan_id, kCloud);
  if (!cloud.ok()) return cloud.error();
  return progress(kContouring) ? format.of_cloud(*cloud) : stopped;
}

// Files that belong together go as one.
Result<std::string> ExportBuilder::build(const ExportOffer& offer, const std::string& scan_id, const BuildProgress& progress) {
  CHECK(!offer.is_result, "a result is there already");
  const Result<ExportFormat> format = export_format_named(offer.name);
  if (!format.ok()) return format.error();
  Result<NamedFiles> files = files_of(*format, scan_id, progress);
  if (!files.ok()) return files.error();
  if (!format->is_folder) return std::move(files->front().bytes);
  ZipEntries entries;
  for (NamedFile& file : *files) entries.emplace_back(std::move(file.name), std::move(file.bytes));
  return format_zip(entries);
}

}  // namespace hermite
