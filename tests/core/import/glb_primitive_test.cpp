#include "core/import/glb_primitive.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/glb_bytes.h"

namespace hermite::imports {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;

Result<GlbPrimitive> primitive_of(const json& all, GlbBudget budget = {100, 100}) {
  const std::string bytes = test::glb_of(all.dump(), test::triangle_binary());
  const Result<GlbDocument> document = GlbDocument::parse(bytes);
  if (!document.ok()) return document.error();
  return read_glb_primitive(*document, document->json()["meshes"][0]["primitives"][0], "it",
                            budget);
}

TEST(GlbPrimitive, IsReadWithItsTriangles) {
  json all = test::triangle_json();
  const auto triangle = primitive_of(all);
  ASSERT_TRUE(triangle.ok()) << triangle.error().message;
  EXPECT_THAT(triangle->triangles, ElementsAre(output::TriangleCorners{0, 1, 2}));
  EXPECT_EQ(triangle->positions[1], Eigen::Vector3f(1, 0, 0));
  all["meshes"][0]["primitives"][0].erase("indices");
  EXPECT_THAT(primitive_of(all)->triangles, ElementsAre(output::TriangleCorners{0, 1, 2}));
  all["meshes"][0]["primitives"][0]["mode"] = 0;
  EXPECT_TRUE(primitive_of(all)->is_points);
}

TEST(GlbPrimitive, StripsAndFansAreTriangles) {
  json all = test::triangle_json();
  all["accessors"][1] = {
      {"bufferView", 1}, {"componentType", 5121}, {"type", "SCALAR"}, {"count", 5}};  // 0 0 1 0 2
  all["meshes"][0]["primitives"][0]["mode"] = 5;
  EXPECT_THAT(primitive_of(all)->triangles,
              ElementsAre(output::TriangleCorners{0, 0, 1}, output::TriangleCorners{1, 0, 0},
                          output::TriangleCorners{1, 0, 2}));
  all["meshes"][0]["primitives"][0]["mode"] = 6;
  EXPECT_THAT(primitive_of(all)->triangles,
              ElementsAre(output::TriangleCorners{0, 0, 1}, output::TriangleCorners{0, 1, 0},
                          output::TriangleCorners{0, 0, 2}));
}

TEST(GlbPrimitive, WhatIsWrongIsNamed) {
  const auto why = [](const std::string& pointer, const json& value,
                      GlbBudget budget = {100, 100}) {
    json all = test::triangle_json();
    all[json::json_pointer(pointer)] = value;
    const auto primitive = primitive_of(all, budget);
    return primitive.ok() ? "" : primitive.error().message;
  };
  EXPECT_THAT(why("/meshes/0/primitives/0/mode", 1), HasSubstr("it.mode is 1; known are points"));
  EXPECT_THAT(why("/meshes/0/primitives/0/attributes", json::object()),
              HasSubstr("it has no POSITION"));
  EXPECT_THAT(why("/meshes/0/primitives/0/attributes/NORMAL", 7), HasSubstr("no accessors[7]"));
  EXPECT_THAT(why("/meshes/0/primitives/0/material", 0), HasSubstr("no materials[0]"));
  EXPECT_THAT(why("/accessors/0/count", 2), HasSubstr("index 2 is 2, there are 2 vertices"));
  EXPECT_THAT(why("/nodes/0/name", "x", {2, 100}),
              HasSubstr("accessors[0].count is 3, 2 are left of the limit"));
  EXPECT_THAT(why("/nodes/0/name", "x", {100, 0}),
              HasSubstr("accessors[1].count is 3, 0 are left of the limit"));
  EXPECT_THAT(
      why("/meshes/0/primitives/0/extensions",
          {{"KHR_draco_mesh_compression", {{"bufferView", 0}, {"attributes", {{"POSITION", 0}}}}}}),
      HasSubstr("Draco"));
}

TEST(GlbPrimitive, ATextureMayLieTurnedAndMoved) {
  json all = test::triangle_json();
  all["images"] = {{{"bufferView", 0}}};
  all["textures"] = {{{"source", 0}}};
  all["accessors"].push_back({{"bufferView", 0},
                              {"componentType", 5126},
                              {"type", "VEC2"},
                              {"count", 3}});  // (0,0) (0,1) (0,0)
  all["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = 2;
  all["meshes"][0]["primitives"][0]["material"] = 0;
  all["materials"] = json::parse(R"([{"pbrMetallicRoughness": {"baseColorFactor": [0.5, 1, 1, 1], )"
                                 R"("baseColorTexture": {"index": 0}}}])");
  auto plain = primitive_of(all);
  ASSERT_TRUE(plain.ok()) << plain.error().message;
  EXPECT_TRUE(plain->material.is_plain);
  EXPECT_EQ(plain->material.factor.x(), 0.5f);
  all["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["extensions"]
     ["KHR_texture_transform"] = {{"offset", {0.25, 0}}, {"scale", {1, 2}}};
  const auto moved = primitive_of(all);
  ASSERT_TRUE(moved.ok()) << moved.error().message;
  EXPECT_FALSE(moved->material.is_plain);
  EXPECT_EQ(moved->texture_coordinates[1], Eigen::Vector2f(0.25f, 2));
}

}  // namespace
}  // namespace hermite::imports
