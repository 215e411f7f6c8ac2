// Where the meshes of a glTF stand. Pure.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/import/glb_document.h"

namespace hermite {

struct GlbPlacement {
  std::uint64_t mesh = 0;
  Eigen::Matrix4d world_from_mesh = Eigen::Matrix4d::Identity();  // affine
};

inline constexpr std::size_t kMaxGlbNodeDepth = 1000;

// Of the scene that the file names, else the first, else of all nodes that nobody has as a child; in the order of the nodes, parents before
// children. kCorruptData: a node that is not there, that is below itself or below two others, a matrix that is none, deeper than
// kMaxGlbNodeDepth; no mesh at all.
Result<std::vector<GlbPlacement>> glb_placements(const GlbDocument& document);

}  // namespace hermite
