#include "core/output/glb_draco_decode.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/output/glb_draco.h"
#include "tests/support/analytic_mesh.h"

namespace hermite::output {
namespace {

using testing::HasSubstr;

TEST(GlbDracoDecode, ReadsWhatWeWrite) {
  const std::vector<GlbPart> parts = glb_parts(test::textured_plane(2, 1, 16));
  const DracoPart encoded = *encode_draco_part(parts[0], draco_grid_of(parts), 16);
  const DracoIds ids{encoded.position, encoded.normal, -1, encoded.texture_coordinate};
  const auto mesh =
      decode_draco_mesh(encoded.bytes, ids, encoded.vertex_count, encoded.triangle_count);
  ASSERT_TRUE(mesh.ok()) << mesh.error().message;
  EXPECT_EQ(mesh->triangles.size(), 4u);
  ASSERT_EQ(mesh->texture_coordinates.size(), mesh->positions.size());
  EXPECT_TRUE(mesh->colors.empty());
  for (const Eigen::Vector3f& position : mesh->positions) EXPECT_NEAR(position.z(), -1, 1e-4);
}

TEST(GlbDracoDecode, WhatTheGltfSaysElseIsAnError) {
  const std::vector<GlbPart> parts = glb_parts(test::sphere_mesh(4, 6));
  const DracoPart encoded = *encode_draco_part(parts[0], draco_grid_of(parts), 0);
  const std::uint64_t vertices = encoded.vertex_count, triangles = encoded.triangle_count;
  const auto why = [&](std::string_view bytes, const DracoIds& ids, std::uint64_t vertex_count) {
    const auto mesh = decode_draco_mesh(bytes, ids, vertex_count, triangles);
    return mesh.ok() ? "" : mesh.error().message;
  };
  EXPECT_THAT(why(encoded.bytes, {encoded.position}, vertices - 1),
              HasSubstr("where the glTF says"));
  EXPECT_THAT(why(encoded.bytes, {77}, vertices), HasSubstr("there is no attribute 77"));
  for (std::size_t length = 0; length < encoded.bytes.size(); length += 7)
    EXPECT_THAT(
        why(std::string_view(encoded.bytes).substr(0, length), {encoded.position}, vertices),
        HasSubstr("Draco"));
}

}  // namespace
}  // namespace hermite::output
