// What every mesh that we make must be.
#pragma once

#include <gtest/gtest.h>

#include "core/evaluate/mesh_validity.h"

namespace hermite::mesh {

// Its edges may end at a border; beyond that nothing may be wrong with its triangles and vertices.
inline void expect_sound(const output::TriangleMesh& mesh) {
  const evaluate::MeshValidity validity = evaluate::mesh_validity(mesh);
  EXPECT_EQ(validity.overfull_edges, 0);
  EXPECT_EQ(validity.disagreeing_edges, 0);
  EXPECT_EQ(validity.flipped_faces, 0);
  EXPECT_EQ(validity.degenerate_faces, 0);
  EXPECT_EQ(validity.repeated_faces, 0);
  EXPECT_EQ(validity.pinched_vertices, 0);
  EXPECT_EQ(validity.loose_vertices, 0);
  EXPECT_EQ(validity.not_finite_vertices, 0);
}

}  // namespace hermite::mesh
