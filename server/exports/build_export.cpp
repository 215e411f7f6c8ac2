#include "server/exports/build_export.h"

#include <fmt/core.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <atomic>
#include <fstream>
#include <string>
#include <utility>

#include "core/archive/zip.h"
#include "core/base/check.h"
#include "core/edit/edited.h"
#include "core/export/scan_recording.h"
#include "core/export/texture_frames.h"
#include "core/import/model.h"
#include "core/mesh/contour.h"
#include "core/mesh/hole_fill.h"
#include "core/mesh/simplify.h"
#include "core/output/ply_reader.h"
#include "core/texture/texture.h"
#include "core/thumbnail/mesh_points.h"
#include "core/thumbnail/thumbnail.h"
#include "core/thumbnail/up_direction.h"
#include "server/exports/build_comparison.h"
#include "server/exports/scan_edits_file.h"

namespace hermite::server {

namespace {

// Fractions of the total time at which the steps end. Without a texture, meshing takes the share of
// texturing too.
constexpr double kContouring = 0.35, kShaping = 0.4, kTexturing = 0.9, kWritten = 0.99;
// Memory for the views of a texture, and bytes per pixel of a view: colour, depth and edge distance
// (core/texture/texture_view.h).
constexpr double kViews_bytes = 256e6, kViewPixel_bytes = 8.2;
constexpr int kLeastViews = 8, kMostViews = 100;

// Maps the progress of one step to its range of the whole work.
mesh::MeshProgress step_of(const BuildProgress& progress, double from, double to) {
  return [&progress, from, to](double done) { return progress(from + (to - from) * done); };
}

int view_count_for(const Camera& camera) {
  const double fitting = kViews_bytes / (kViewPixel_bytes * camera.width * camera.height);
  return static_cast<int>(std::clamp<double>(fitting, kLeastViews, kMostViews));
}

const Error kNothingLeft{ErrorCode::kInvalidArgument,
                         "the edits of the scan leave nothing of it: take one back"};

Result<output::TriangleMesh> shaped(output::TriangleMesh mesh, const MeshShape& shape,
                                    const mesh::MeshProgress& progress) {
  if (mesh.triangles.empty()) return kNothingLeft;
  const bool fills = shape.fill_mm > 0 || shape.closes, simplifies = shape.simplify_um > 0;
  constexpr double kHalf = 0.5;  // of the time, if both are done
  mesh::SimplifyOptions simplify;
  simplify.most_error_m = 1e-6 * static_cast<double>(shape.simplify_um);
  simplify.least_triangles = shape.triangles;
  Result<output::TriangleMesh> result =
      simplifies ? mesh::simplified(mesh, simplify, step_of(progress, 0, fills ? kHalf : 1))
                 : std::move(mesh);
  if (!result.ok() || !fills) return result;
  return mesh::holes_filled(*result, {1e-3 * static_cast<double>(shape.fill_mm), shape.closes},
                            step_of(progress, simplifies ? kHalf : 0, 1));
}

}  // namespace

Result<output::Cloud> ExportBuilder::read_points(const std::string& scan_id,
                                                 const std::string& name) {
  const Result<output::PlyShape> shape = read_ply(blobs_, scan_id, name, kMaxExportCloud_bytes);
  if (!shape.ok()) return shape.error();
  if (shape->positions.empty()) return Error{ErrorCode::kInvalidArgument, name + " has no points"};
  return output::cloud_of(*shape);
}

// An imported mesh keeps its own texture, if it has one.
Status ExportBuilder::read_imported(const std::string& scan_id) {
  const Result<std::string> version = blobs_.version(scan_id, std::string(kImportedMeshFile));
  if (!version.ok()) return version.error();
  if (mesh_ && mesh_->scan_id == scan_id && mesh_->source_version == *version) return Done{};
  mesh_.reset();  // before there are two
  const Result<std::string> bytes =
      read_blob(blobs_, scan_id, std::string(kImportedMeshFile), imports::kMaxModel_bytes);
  if (!bytes.ok()) return bytes.error();
  Result<imports::ImportedModel> model = imports::read_model(*bytes, {});
  if (!model.ok()) return model.error();
  mesh_ = KnownMesh{scan_id, *version, std::move(model->mesh), {}, {}, {}, {}};
  return Done{};
}

Status ExportBuilder::check_memory(const std::string& scan_id, const std::string& source) const {
  const Result<std::uint64_t> size_bytes = blobs_.size_bytes(scan_id, source);
  if (!size_bytes.ok()) return size_bytes.error();
  if (*size_bytes > kMaxMeshedCloud_bytes)
    return Error{ErrorCode::kTooLarge,
                 fmt::format("no mesh is made of {} of points, at most of {}",
                             mib(static_cast<double>(*size_bytes)),
                             mib(static_cast<double>(kMaxMeshedCloud_bytes)))};
  return check_free_memory("its mesh", kMeshMemory * static_cast<double>(*size_bytes),
                           free_memory_);
}

Status ExportBuilder::make_mesh(const std::string& scan_id, double share,
                                const BuildProgress& progress) {
  if (blobs_.size_bytes(scan_id, std::string(kImportedMeshFile)).ok())
    return read_imported(scan_id);
  const std::string source =
      blobs_.size_bytes(scan_id, kSurfelsFile).ok() ? kSurfelsFile : kCloudFile;
  const Result<std::string> version = blobs_.version(scan_id, source);
  if (!version.ok()) return version.error();
  if (mesh_ && mesh_->scan_id == scan_id && mesh_->source_version == *version) return Done{};
  mesh_.reset();  // before there are two
  if (const Status memory = check_memory(scan_id, source); !memory.ok()) return memory;
  Result<output::Cloud> cloud = read_points(scan_id, source);
  if (!cloud.ok()) return cloud.error();
  if (std::none_of(cloud->begin(), cloud->end(),
                   [](const output::CloudPoint& point) { return point.normal.squaredNorm() > 0; }))
    return Error{ErrorCode::kInvalidArgument,
                 "its points have no normals: the sides of a surface cannot be told"};
  const std::size_t point_count = cloud->size();
  Result<output::TriangleMesh> mesh =
      mesh::contour(*std::move(cloud), {}, [&](double done) { return progress(share * done); });
  if (!mesh.ok()) return mesh.error();
  if (mesh->triangles.empty())
    return Error{
        ErrorCode::kInvalidArgument,
        fmt::format("the {} points of the scan are too few or too far apart to make a surface",
                    point_count)};
  mesh_ = KnownMesh{scan_id, *version, *std::move(mesh), {}, {}, {}, {}};
  return Done{};
}

Status ExportBuilder::make_shape(const std::string& scan_id, const MeshShape& shape, double from,
                                 double to, const BuildProgress& progress) {
  Result<edit::ScanEdits> edits = read_edits(blobs_, scan_id);
  if (!edits.ok()) return edits.error();
  if (mesh_->shape == shape && mesh_->edits == edits->edits)
    return progress(to) ? Status(Done{}) : Error{ErrorCode::kBusy, "stopped"};
  mesh_->shape = {};
  mesh_->edits.clear();
  mesh_->shaped.reset();
  mesh_->textured.reset();
  if (!progress(from)) return Error{ErrorCode::kBusy, "stopped"};
  if (!shape.is_plain() || !edits->edits.empty()) {
    Result<output::TriangleMesh> mesh =
        shaped(edit::edited(mesh_->mesh, edits->edits), shape, step_of(progress, from, to));
    if (!mesh.ok()) return mesh.error();
    mesh_->shaped = *std::move(mesh);
  }
  mesh_->shape = shape;
  mesh_->edits = std::move(edits->edits);
  return progress(to) ? Status(Done{}) : Error{ErrorCode::kBusy, "stopped"};
}

Result<output::TriangleMesh> ExportBuilder::texture(const std::string& scan_id,
                                                    const BuildProgress& progress) {
  Result<std::unique_ptr<dataset::Sequence>> recording = open_frames_(scan_id);
  if (!recording.ok()) return recording.error();
  const Result<std::string> report = read_blob(blobs_, scan_id, kReportFile, kMaxExportCloud_bytes);
  if (!report.ok()) return report.error();
  const Result<std::unique_ptr<dataset::Sequence>> frames =
      exports::as_scanned(*std::move(recording), *report);
  if (!frames.ok()) return frames.error();
  const Result<dataset::Trajectory> path = read_path(blobs_, scan_id);
  if (!path.ok()) return path.error();
  texture::TextureOptions options;
  options.max_views = view_count_for((*frames)->camera());
  std::atomic<double> told = kShaping;
  options.is_stopped = [&] { return !progress(told); };
  return texture::textured(mesh_->finished(), exports::texture_frames_of(**frames, *path), options,
                           [&](double done) {
                             told = kShaping + (kTexturing - kShaping) * done;
                             return progress(told);
                           });
}

// Without frames, or when no frame shows the mesh, it keeps its vertex colours.
Status ExportBuilder::make_texture(const std::string& scan_id, const BuildProgress& progress) {
  if (mesh_->textured || !mesh_->mesh.pages.empty()) return Done{};
  Result<output::TriangleMesh> mesh = texture(scan_id, progress);
  if (!mesh.ok() && mesh.error().code == ErrorCode::kBusy) return mesh.error();
  if (mesh.ok()) {
    mesh_->textured = *std::move(mesh);
  } else {
    spdlog::info("scan {}: its mesh has no texture: {}", scan_id, mesh.error().message);
  }
  return Done{};
}

// Scans of older servers and imported ones may lack the trajectory or the report: their plans have
// no intervals.
Result<plan::FloorPlan> ExportBuilder::make_plan(const std::string& scan_id) {
  const Result<edit::ScanEdits> edits = read_edits(blobs_, scan_id);
  if (!edits.ok()) return edits.error();
  Result<output::Cloud> cloud = read_points(
      scan_id, blobs_.size_bytes(scan_id, kSurfelsFile).ok() ? kSurfelsFile : kCloudFile);
  if (!cloud.ok()) return cloud.error();
  *cloud = edit::edited(*std::move(cloud), edits->edits);
  if (cloud->empty()) return kNothingLeft;
  const Result<dataset::Trajectory> path = read_path(blobs_, scan_id);
  const Result<measure::MapKnowledge> map = read_map_knowledge(blobs_, scan_id);
  for (const Error& error : {path.ok() ? Error() : path.error(), map.ok() ? Error() : map.error()})
    if (!error.message.empty() && error.code != ErrorCode::kNotFound) return error;
  const Eigen::Vector3f up = thumbnail::best_up(*cloud, read_measured_up(blobs_, scan_id));
  return plan::floor_plan_of(
      {*cloud, up.cast<double>(), path.ok() ? &*path : nullptr, map.ok() ? &*map : nullptr});
}

Result<output::NamedFiles> ExportBuilder::files_of(const exports::ExportFormat& format,
                                                   const ExportSpec& spec,
                                                   const std::string& scan_id,
                                                   const BuildProgress& progress) {
  const Error stopped{ErrorCode::kBusy, "stopped"};
  if (!progress(0)) return stopped;
  if (format.of_mesh) {
    const double contouring = format.takes_texture ? kContouring : kShaping;
    if (Status made = make_mesh(scan_id, contouring, progress); !made.ok()) return made.error();
    const double shaping = format.takes_texture ? kShaping : kTexturing;
    if (Status made = make_shape(scan_id, spec.shape, contouring, shaping, progress); !made.ok())
      return made.error();
    if (!format.takes_texture) return format.of_mesh(mesh_->finished());
    if (Status made = make_texture(scan_id, progress); !made.ok()) return made.error();
    return progress(kTexturing) ? format.of_mesh(mesh_->with_texture()) : stopped;
  }
  if (format.of_plan) {
    const Result<plan::FloorPlan> plan = make_plan(scan_id);
    return plan.ok() ? format.of_plan(*plan) : plan.error();
  }
  if (format.of_trajectory) {
    const Result<dataset::Trajectory> path = read_path(blobs_, scan_id);
    return path.ok() ? format.of_trajectory(*path) : path.error();
  }
  CHECK(format.of_cloud, "an offer is made of results");
  const Result<edit::ScanEdits> edits = read_edits(blobs_, scan_id);
  if (!edits.ok()) return edits.error();
  Result<output::Cloud> cloud = read_points(scan_id, kCloudFile);
  if (!cloud.ok()) return cloud.error();
  *cloud = edit::edited(*std::move(cloud), edits->edits);
  if (cloud->empty()) return kNothingLeft;
  return progress(kTexturing) ? format.of_cloud(*cloud) : stopped;
}

// With the thumbnail first, if the one of the scan is not of this mesh.
Result<output::NamedFiles> ExportBuilder::with_thumbnail(const std::string& scan_id,
                                                         output::NamedFile mesh) const {
  if (mesh_->edits.empty() && blobs_.size_bytes(scan_id, thumbnail::kThumbnailName).ok())
    return output::NamedFiles{std::move(mesh)};
  Result<std::string> thumbnail = thumbnail::thumbnail_jpeg(
      thumbnail::points_on(mesh_->with_texture(), thumbnail::kThumbnailPoints),
      read_measured_up(blobs_, scan_id));
  if (!thumbnail.ok()) return thumbnail.error();
  return output::NamedFiles{{kMeshThumbnailFile, *std::move(thumbnail)}, std::move(mesh)};
}

// Formats of several files are sent as one archive.
Result<output::NamedFiles> ExportBuilder::build(const ExportSpec& spec, const std::string& scan_id,
                                                const BuildProgress& told) {
  // Once stopped, progress is not asked again, and unread frames do not count as errors.
  std::atomic<bool> stopped = false;
  const BuildProgress progress = [&](double done) {
    if (!stopped && !told(done)) stopped = true;
    return !stopped;
  };
  if (spec.is_comparison()) {
    forget();  // comparing needs the memory
    return build_comparison(blobs_, free_memory_, {scan_id, spec.other_scan_id}, progress);
  }
  CHECK(!spec.offer->is_result, "a result is there already");
  const Result<exports::ExportFormat> format = exports::export_format_named(spec.offer->name);
  if (!format.ok()) return format.error();
  Result<output::NamedFiles> files = files_of(*format, spec, scan_id, progress);
  if (!progress(kWritten)) return Error{ErrorCode::kBusy, "stopped"};
  if (!files.ok()) return files.error();
  if (!format->is_folder) {
    output::NamedFile file{spec.file(), std::move(files->front().bytes)};
    return spec.is_viewer_mesh() ? with_thumbnail(scan_id, std::move(file))
                                 : output::NamedFiles{std::move(file)};
  }
  archive::ZipEntries entries;
  for (output::NamedFile& file : *files)
    entries.emplace_back(std::move(file.name), std::move(file.bytes));
  Result<std::string> archive = archive::format_zip(entries);
  if (!archive.ok()) return archive.error();
  return output::NamedFiles{{spec.file(), *std::move(archive)}};
}

}  // namespace hermite::server
