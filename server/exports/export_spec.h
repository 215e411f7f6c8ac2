// Identifies an export: a format and, for meshes, the processing options. Each has a unique name in
// requests and as a file. Plain value.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"
#include "server/exports/export_offer.h"

namespace hermite::server {

inline constexpr std::int64_t kLeastSimplify_um = 10, kMostSimplify_um = 100'000,
                              kMostMeshTriangles = 100'000'000, kMostFill_mm = 10'000;
// Exports with options that one scan may have.
inline constexpr std::size_t kMaxShapedExports = 16;

// Comparisons that one scan may have with others, as the first of both.
inline constexpr std::size_t kMaxComparisons = 16;

// A drawing of the viewer's mesh, put with it if the scan was edited or has no thumbnail of its
// own.
inline constexpr const char* kMeshThumbnailFile = "mesh-thumbnail.jpg";

// How a mesh is processed before it is written. Whole numbers, so that equal options have equal
// names.
struct MeshShape {
  std::int64_t simplify_um = 0;  // simplification error; 0: not simplified
  std::int64_t triangles = 0;    // simplification stops at this many
  std::int64_t fill_mm = 0;      // holes up to this width are filled; 0: none
  bool closes = false;           // close all boundaries

  bool operator==(const MeshShape&) const = default;
  bool is_plain() const { return *this == MeshShape(); }
};

struct ExportSpec {
  const ExportOffer* offer = nullptr;  // an entry of export_offers()
  MeshShape shape;                     // only for meshes

  std::string other_scan_id = {};  // only of a comparison: the second scan

  bool is_comparison() const { return !other_scan_id.empty(); }
  bool is_viewer_mesh() const { return offer->name == kViewerMesh && shape.is_plain(); }
  std::string name() const;  // "glb", "glb_s1000_t50000_f100_c", "comparison_SCAN"
  std::string file() const;  // "mesh.glb", "mesh_s1000_t50000_f100_c.glb", "comparison_SCAN.json"
  // All files that it may have, in the order in which they are put: the export is ready when the
  // last one, file(), is there.
  std::vector<std::string> files() const;
};

// The comparison of a scan with another one, which has the points of both scans in a second file.
ExportSpec comparison_with(const std::string& other_scan_id);
std::string comparison_points_file(const std::string& other_scan_id);  // "comparison_SCAN.ply"

// Returns the other scan of a comparison whose file() this is; empty for other files.
std::string compared_scan_of_file(std::string_view file);

// A comparison also leaves a blob of this name with the second scan, so that it is found when that
// one is deleted.
std::string comparison_mark(const std::string& first_scan_id);
std::string first_scan_of_mark(std::string_view file);  // empty for other files

// kInvalidArgument: a field is outside its limits (the message uses the names in requests), or the
// format is not a mesh.
Status check_shape(const ExportOffer& offer, const MeshShape& shape);

// Parses a name that name() has made. kNotFound: no such format, the message lists the known ones;
// kInvalidArgument: as check_shape.
Result<ExportSpec> export_spec_named(std::string_view name);

// Parses a file name that file() has made, of an export with options. offer is null for other
// files.
ExportSpec shaped_export_of_file(std::string_view file);

}  // namespace hermite::server
