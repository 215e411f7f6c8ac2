#include "server/jobs/import_results.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/output/glb.h"
#include "core/output/ply.h"
#include "core/thumbnail/mesh_points.h"
#include "core/thumbnail/thumbnail.h"
#include "server/exports/export_offer.h"
#include "server/operations/json_text.h"

namespace hermite::server {

namespace {

using Json = nlohmann::ordered_json;

constexpr int kVoxelsPerChunk_bits = 6;

std::uint64_t cell_of(const Eigen::Vector3f& position_m, double edge_m) {
  std::uint64_t cell = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto index =
        static_cast<std::int64_t>(std::floor(static_cast<double>(position_m[axis]) / edge_m));
    cell = (cell << 21) | (static_cast<std::uint64_t>(index) & 0x1fffff);
  }
  return cell;
}

std::size_t count_cells(const output::Cloud& cloud, double edge_m) {
  std::vector<std::uint64_t> cells(cloud.size());
  std::transform(
      cloud.begin(), cloud.end(), cells.begin(),
      [edge_m](const output::CloudPoint& point) { return cell_of(point.position_m, edge_m); });
  std::sort(cells.begin(), cells.end());
  return static_cast<std::size_t>(std::unique(cells.begin(), cells.end()) - cells.begin());
}

// Chunks cost a viewer about as much as hundreds of points: of a sparse cloud each would hold one
// or two.
constexpr std::size_t kManyChunks = 2000;
constexpr double kKeptShare = 0.99;

std::uint8_t level_for(const output::Cloud& cloud) {
  std::uint8_t level = 0;
  for (; level < output::kCoarsestLevel; ++level) {
    const double voxel_m = static_cast<double>(output::kVoxelEdge_m) * (1 << level);
    const bool few_points =
        cloud.size() <= kMostShownPoints || count_cells(cloud, voxel_m) <= kMostShownPoints;
    if (few_points && count_cells(cloud, voxel_m * (1 << kVoxelsPerChunk_bits)) <= kMostShownChunks)
      break;
  }
  const auto points_at = [&cloud](int at) {
    return count_cells(cloud, static_cast<double>(output::kVoxelEdge_m) * (1 << at));
  };
  while (level < output::kCoarsestLevel && points_at(level + kVoxelsPerChunk_bits) > kManyChunks &&
         static_cast<double>(points_at(level + 1)) >=
             kKeptShare * static_cast<double>(points_at(level)))
    ++level;
  return level;
}

// The vertices of a mesh as points, for viewers.
output::Cloud vertices_of(const output::TriangleMesh& mesh) {
  output::Cloud cloud(mesh.positions_m.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    cloud[i].position_m = mesh.positions_m[i];
    cloud[i].normal = mesh.normals[i];
    cloud[i].color = mesh.colors[i];
  }
  return cloud;
}

std::string report_of(const imports::ImportedModel& model, const imports::ImportOptions& options,
                      const std::vector<std::string>& remarks) {
  Json import;
  import["format"] = model.format;
  import["points"] = model.cloud.size();
  import["vertices"] = model.mesh.positions_m.size();
  import["triangles"] = model.mesh.triangles.size();
  import["images"] = model.mesh.pages.size();
  import["scale"] = options.scale;
  import["up"] = name_of(model.up);
  import["subtracted"] = {model.origin.x(), model.origin.y(), model.origin.z()};
  import["words"] = remarks;
  return json_text({{"import", import}});
}

Result<output::NamedFile> shown_file(const imports::ImportedModel& model, std::string bytes) {
  if (!model.is_mesh()) return output::NamedFile{"cloud.ply", output::format_ply(model.cloud)};
  if (model.unchanged) return output::NamedFile{std::string(kImportedMeshFile), std::move(bytes)};
  Result<std::string> glb = output::format_mesh_glb(model.mesh, output::GlbCompression::kNone);
  if (!glb.ok()) return glb.error();
  return output::NamedFile{std::string(kImportedMeshFile), *std::move(glb)};
}

}  // namespace

Result<StoredChunks> chunks_of_points(const output::Cloud& cloud) {
  output::ChunkedModel model(level_for(cloud));
  std::vector<output::SlotChange> changes;
  constexpr std::size_t kAtOnce = 65536;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    changes.push_back({static_cast<std::uint32_t>(i), true, cloud[i]});
    if (changes.size() < kAtOnce && i + 1 < cloud.size()) continue;
    model.apply(changes);
    changes.clear();
  }
  StoredChunks stored;
  stored.submaps.push_back({0, Rigid3()});
  for (const output::ChunkKey& key : model.take_dirty()) {
    Result<output::EncodedChunk> chunk = model.encode(key);
    if (!chunk.ok()) return chunk.error();
    stored.chunks.push_back(*std::move(chunk));
  }
  return stored;
}

Result<ImportResults> results_of_import(std::string bytes, const imports::ImportOptions& options,
                                        const std::function<bool()>& go_on) {
  const Error stopped{ErrorCode::kBusy, "stopped"};
  Result<imports::ImportedModel> model = imports::read_model(bytes, options);
  if (!model.ok()) return model.error();
  if (!go_on()) return stopped;
  ImportResults results;
  results.remarks = imports::remarks_about(*model, options);
  results.may_be_meshed = !model->is_mesh() && model->has_normals();
  results.files.push_back({"report.json", report_of(*model, options, results.remarks)});
  Result<output::NamedFile> file = shown_file(*model, std::move(bytes));
  if (!file.ok()) return file.error();
  results.files.push_back(*std::move(file));
  if (!go_on()) return stopped;
  const Result<StoredChunks> chunks = model->is_mesh() ? chunks_of_points(vertices_of(model->mesh))
                                                       : chunks_of_points(model->cloud);
  if (!chunks.ok()) return chunks.error();
  results.files.push_back({kChunksName, format_chunk_file(*chunks)});
  if (!go_on()) return stopped;
  Result<std::string> thumbnail = thumbnail::thumbnail_jpeg(
      model->is_mesh() ? thumbnail::points_on(model->mesh, thumbnail::kThumbnailPoints)
                       : model->cloud);
  if (!thumbnail.ok()) return thumbnail.error();
  results.files.push_back({thumbnail::kThumbnailName, *std::move(thumbnail)});
  return results;
}

}  // namespace hermite::server
