// The exports that this server offers for a scan that has ended: the formats of core/export that
// can be made from its results, each with the name of its file, and results that are offered as
// they are.
#pragma once

#include <span>
#include <string_view>

namespace hermite::server {

enum class ExportKind { kMesh, kCloud, kPlan, kPath, kComparison };
const char* name_of(ExportKind kind);  // "mesh", "cloud", "plan", "path", "comparison"

struct ExportOffer {
  std::string_view name;  // of the format, in requests: "glb"
  std::string_view file;  // name of the file: "mesh.glb"
  const char* content_type;
  std::string_view label;  // for people: "GLB"
  ExportKind kind;
  bool is_result = false;  // a result of the scan: offered as it is
};

// The mesh of an imported scan, in metres, y up. All other mesh formats of the scan are made from
// it.
inline constexpr std::string_view kImportedMesh = "imported", kImportedMeshFile = "imported.glb";

// The format that the viewer shows, which is small and quick to decode. For an imported mesh it
// shows kImportedMesh.
inline constexpr std::string_view kViewerMesh = "glb-draco";

// The cloud of an edited scan as PLY. Without edits that is a result of the scan.
inline constexpr std::string_view kEditedCloud = "points-ply";

// What has changed between the scan and another one. It is no format, and has requests of its own
// (server/routes/comparison_routes.h).
const ExportOffer& comparison_offer();

// Returns the offers in the order in which they are listed.
std::span<const ExportOffer> export_offers();
const ExportOffer* find_export_offer(std::string_view name);  // null: no such offer

}  // namespace hermite::server
