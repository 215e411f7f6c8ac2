#include "server/exports/export_offer.h"

#include <algorithm>
#include <array>

namespace hermite::server {

namespace {

constexpr const char* kGlbType = "model/gltf-binary";
constexpr const char* kBytesType = "application/octet-stream";
constexpr const char* kTextType = "text/plain; charset=utf-8";

constexpr std::array kOffers = {
    ExportOffer{kImportedMesh, kImportedMeshFile, kGlbType, "GLB, as it was imported",
                ExportKind::kMesh, true},
    ExportOffer{"glb", "mesh.glb", kGlbType, "GLB, opens nearly everywhere", ExportKind::kMesh},
    ExportOffer{kViewerMesh, "mesh.draco.glb", kGlbType, "GLB, small (Draco)", ExportKind::kMesh},
    ExportOffer{"obj", "mesh-obj.zip", "application/zip", "OBJ", ExportKind::kMesh},
    ExportOffer{"ply", "mesh.ply", kBytesType, "PLY", ExportKind::kMesh},
    ExportOffer{"stl", "mesh.stl", "model/stl", "STL, for printing", ExportKind::kMesh},
    ExportOffer{"cloud", "cloud.ply", kBytesType, "PLY, with all that is known", ExportKind::kCloud,
                true},
    ExportOffer{kEditedCloud, "points.ply", kBytesType, "PLY, as edited", ExportKind::kCloud},
    ExportOffer{"las", "cloud.las", "application/vnd.las", "LAS 1.4", ExportKind::kCloud},
    ExportOffer{"points-glb", "points.glb", kGlbType, "GLB", ExportKind::kCloud},
    ExportOffer{"splats", "splats.ply", kBytesType, "Gaussian splats", ExportKind::kCloud},
    ExportOffer{"plan-svg", "plan.svg", "image/svg+xml", "SVG, on paper", ExportKind::kPlan},
    ExportOffer{"plan-dxf", "plan.dxf", "image/vnd.dxf", "DXF, for drawing programs",
                ExportKind::kPlan},
    ExportOffer{"plan-json", "plan.json", "application/json", "JSON, numbers", ExportKind::kPlan},
    ExportOffer{"tum", "trajectory.txt", kTextType, "TUM", ExportKind::kPath, true},
    ExportOffer{"kitti", "poses.kitti.txt", kTextType, "KITTI", ExportKind::kPath},
    ExportOffer{"log", "trajectory.log", kTextType, "LOG, as Open3D has it", ExportKind::kPath},
};

}  // namespace

const char* name_of(ExportKind kind) {
  switch (kind) {
    case ExportKind::kMesh: return "mesh";
    case ExportKind::kCloud: return "cloud";
    case ExportKind::kPlan: return "plan";
    case ExportKind::kPath: return "path";
    case ExportKind::kComparison: return "comparison";
  }
  return "mesh";
}

const ExportOffer& comparison_offer() {
  static constexpr ExportOffer kComparison{"comparison", "comparison.json", "application/json",
                                           "Comparison", ExportKind::kComparison};
  return kComparison;
}

std::span<const ExportOffer> export_offers() { return kOffers; }

const ExportOffer* find_export_offer(std::string_view name) {
  const auto found = std::find_if(kOffers.begin(), kOffers.end(),
                                  [name](const ExportOffer& offer) { return offer.name == name; });
  return found == kOffers.end() ? nullptr : &*found;
}

}  // namespace hermite::server
