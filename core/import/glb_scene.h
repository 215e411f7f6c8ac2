// The mesh placements of a glTF scene. Pure.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/import/glb_document.h"

namespace hermite::imports {

struct GlbPlacement {
  std::uint64_t mesh = 0;
  Eigen::Matrix4d world_from_mesh = Eigen::Matrix4d::Identity();  // affine
};

inline constexpr std::size_t kMaxGlbNodeDepth = 1000;

// Returns the meshes of the default scene, else of the first scene, else of all root nodes, in the
// order of nodes with parents before children. Returns kCorruptData for a missing node, a node that
// is its own ancestor or has two parents, an invalid matrix, nesting deeper than kMaxGlbNodeDepth,
// or no mesh at all.
Result<std::vector<GlbPlacement>> glb_placements(const GlbDocument& document);

}  // namespace hermite::imports
