// What this server offers of a scan that has ended: of the formats of core/export those that are made of its results, each with a file
// that it is kept as, and results that are there already.
#pragma once

#include <span>
#include <string_view>

namespace hermite {

enum class ExportKind { kMesh, kCloud, kPath };
const char* name_of(ExportKind kind);  // "mesh", "cloud", "path"

struct ExportOffer {
  std::string_view name;  // in requests, and of the format: "glb"
  std::string_view file;  // what it is called: "mesh.glb"
  const char* content_type;
  std::string_view words;  // for people, beside others of its kind: "GLB"
  ExportKind kind;
  bool is_result = false;  // the scan has left it
};

// What a mesh was brought along as that nobody has scanned: in metres, y up. There is nothing else that its other formats are made of.
inline constexpr std::string_view kImportedMesh = "imported", kImportedMeshFile = "imported.glb";

// The mesh of a scan that the viewer shows: small, and quick to be read. Of an imported one it shows that.
inline constexpr std::string_view kViewerMesh = "glb-draco";

std::span<const ExportOffer> export_offers();                 // in the order in which people are shown them
const ExportOffer* find_export_offer(std::string_view name);  // null: there is none

}  // namespace hermite
