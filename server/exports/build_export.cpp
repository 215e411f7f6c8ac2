#include "server/exports/build_export.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "core/archive/zip.h"
#include "core/base/check.h"
#include "core/export/scan_recording.h"
#include "core/export/texture_frames.h"
#include "core/import/model.h"
#include "core/mesh/contour.h"
#include "core/mesh/texture.h"
#include "core/output/ply_reader.h"

namespace hermite {

namespace {

constexpr const char* kCloud = "cloud.ply";
constexpr const char* kSurfels = "surfels.ply";  // what meshes are made of; scans of older servers have none
constexpr const char* kTrajectory = "trajectory.txt";
constexpr const char* kReport = "report.json";
// Of the time that a mesh with a texture and its file take. Without a texture what would be its time is the mesh's.
constexpr double kContouring = 0.4, kTexturing = 0.95;
// Of a texture's views: the server has other scans. A pixel of one is colour, depth and distances (core/mesh/texture_view.h).
constexpr double kViews_bytes = 256e6, kViewPixel_bytes = 8.2;
constexpr int kLeastViews = 8, kMostViews = 100;

int view_count_for(const Camera& camera) {
  const double fitting = kViews_bytes / (kViewPixel_bytes * camera.width * camera.height);
  return static_cast<int>(std::clamp<double>(fitting, kLeastViews, kMostViews));
}

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

// What nobody has scanned has its texture, or has none.
Status ExportBuilder::read_imported(const std::string& scan_id) {
  const Result<std::string> version = blobs_.version(scan_id, std::string(kImportedMeshFile));
  if (!version.ok()) return version.error();
  if (mesh_ && mesh_->scan_id == scan_id && mesh_->source_version == *version) return Done{};
  mesh_.reset();  // before there are two
  const Result<std::string> bytes = read_blob(blobs_, scan_id, std::string(kImportedMeshFile), kMaxModel_bytes);
  if (!bytes.ok()) return bytes.error();
  Result<ImportedModel> model = read_model(*bytes, {});
  if (!model.ok()) return model.error();
  mesh_ = KnownMesh{scan_id, *version, std::move(model->mesh), {}};
  return Done{};
}

Status ExportBuilder::make_mesh(const std::string& scan_id, double share, const BuildProgress& progress) {
  if (blobs_.size_bytes(scan_id, std::string(kImportedMeshFile)).ok()) return read_imported(scan_id);
  const std::string source = blobs_.size_bytes(scan_id, kSurfels).ok() ? kSurfels : kCloud;
  const Result<std::string> version = blobs_.version(scan_id, source);
  if (!version.ok()) return version.error();
  if (mesh_ && mesh_->scan_id == scan_id && mesh_->source_version == *version) return Done{};
  mesh_.reset();  // before there are two
  const Result<Cloud> cloud = read_points(scan_id, source);
  if (!cloud.ok()) return cloud.error();
  if (std::none_of(cloud->begin(), cloud->end(), [](const CloudPoint& point) { return point.normal.squaredNorm() > 0; }))
    return Error{ErrorCode::kInvalidArgument, "its points have no normals: the sides of a surface cannot be told"};
  Result<TriangleMesh> mesh = contour(*cloud, {}, [&](double done) { return progress(share * done); });
  if (!mesh.ok()) return mesh.error();
  if (mesh->triangles.empty())
    return Error{ErrorCode::kInvalidArgument,
                 "the " + std::to_string(cloud->size()) + " points of the scan are too few or too far apart to make a surface"};
  mesh_ = KnownMesh{scan_id, *version, *std::move(mesh), {}};
  return Done{};
}

Result<TriangleMesh> ExportBuilder::texture(const std::string& scan_id, const BuildProgress& progress) {
  Result<std::unique_ptr<Sequence>> recording = open_frames_(scan_id);
  if (!recording.ok()) return recording.error();
  const Result<std::string> report = read_blob(blobs_, scan_id, kReport, kMaxExportCloud_bytes);
  if (!report.ok()) return report.error();
  const Result<std::unique_ptr<Sequence>> frames = as_scanned(*std::move(recording), *report);
  if (!frames.ok()) return frames.error();
  const Result<Trajectory> path = read_path(scan_id);
  if (!path.ok()) return path.error();
  TextureOptions options;
  options.max_views = view_count_for((*frames)->camera());
  return textured(mesh_->mesh, texture_frames_of(**frames, *path), options,
                  [&progress](double done) { return progress(kContouring + (kTexturing - kContouring) * done); });
}

// Without frames, or with frames that show nothing of it, a mesh has the colours that it has.
Status ExportBuilder::make_texture(const std::string& scan_id, const BuildProgress& progress) {
  if (mesh_->textured || !mesh_->mesh.pages.empty()) return Done{};
  Result<TriangleMesh> mesh = texture(scan_id, progress);
  if (!mesh.ok() && mesh.error().code == ErrorCode::kBusy) return mesh.error();
  if (mesh.ok()) {
    mesh_->textured = *std::move(mesh);
  } else {
    spdlog::info("scan {}: its mesh has no texture: {}", scan_id, mesh.error().message);
  }
  return Done{};
}

Result<NamedFiles> ExportBuilder::files_of(const ExportFormat& format, const std::string& scan_id, const BuildProgress& progress) {
  const Error stopped{ErrorCode::kBusy, "stopped"};
  if (!progress(0)) return stopped;
  if (format.of_mesh) {
    const double contouring = format.takes_texture ? kContouring : kTexturing;
    if (Status made = make_mesh(scan_id, contouring, progress); !made.ok()) return made.error();
    if (!format.takes_texture) return progress(contouring) ? format.of_mesh(mesh_->mesh) : stopped;
    if (Status made = make_texture(scan_id, progress); !made.ok()) return made.error();
    return progress(kTexturing) ? format.of_mesh(mesh_->textured ? *mesh_->textured : mesh_->mesh) : stopped;
  }
  if (format.of_trajectory) {
    const Result<Trajectory> path = read_path(scan_id);
    return path.ok() ? format.of_trajectory(*path) : path.error();
  }
  CHECK(format.of_cloud, "an offer is made of results");
  const Result<Cloud> cloud = read_points(scan_id, kCloud);
  if (!cloud.ok()) return cloud.error();
  return progress(kTexturing) ? format.of_cloud(*cloud) : stopped;
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
