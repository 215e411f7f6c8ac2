#include "core/import/glb_scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/glb_bytes.h"

namespace hermite::imports {
namespace {

using nlohmann::json;
using testing::HasSubstr;

Result<std::vector<GlbPlacement>> placements_of(const char* nodes,
                                                const json& scenes = {{{"nodes", {0}}}}) {
  json all = test::triangle_json();
  all["nodes"] = json::parse(nodes);
  all["scenes"] = scenes;
  if (scenes.empty()) all.erase("scene");
  const std::string bytes = test::glb_of(all.dump(), test::triangle_binary());
  const Result<GlbDocument> document = GlbDocument::parse(bytes);
  return document.ok() ? glb_placements(*document)
                       : Result<std::vector<GlbPlacement>>(document.error());
}

TEST(GlbScene, ChildrenStandWhereTheirParentsPutThem) {
  const auto placed = placements_of(
      R"([{"translation": [1, 0, 0], "scale": [2, 2, 2], "children": [1]},)"
      R"( {"mesh": 3, "translation": [0, 1, 0], "rotation": [0, 0, 0.70710678, 0.70710678]}])");
  ASSERT_TRUE(placed.ok()) << placed.error().message;
  ASSERT_EQ(placed->size(), 1u);
  EXPECT_EQ((*placed)[0].mesh, 3u);
  // Turned to y, moved to (0, 2, 0), doubled, moved.
  const Eigen::Vector4d point = (*placed)[0].world_from_mesh * Eigen::Vector4d(1, 0, 0, 1);
  EXPECT_LT((point - Eigen::Vector4d(1, 4, 0, 1)).norm(), 1e-6) << point.transpose();
}

TEST(GlbScene, WithoutASceneEveryRootIsInIt) {
  const auto placed =
      placements_of(R"([{"mesh": 0}, {"children": [2]}, {"mesh": 1}])", json::array());
  ASSERT_TRUE(placed.ok()) << placed.error().message;
  EXPECT_EQ(placed->size(), 2u);
}

TEST(GlbScene, CirclesAndSharedChildrenAreErrors) {
  EXPECT_THAT(placements_of(R"([{"mesh": 0, "children": [1]}, {"children": [0]}])").error().message,
              HasSubstr("nodes[0] is below itself"));
  EXPECT_THAT(placements_of(R"([{"mesh": 0, "children": [0]}])").error().message,
              HasSubstr("nodes[0] is below itself"));
  EXPECT_THAT(placements_of(R"([{"children": [1, 1]}, {"mesh": 0}])").error().message,
              HasSubstr("nodes[1] is below itself, or below two others"));
  EXPECT_THAT(placements_of(R"([{"children": [9]}])").error().message,
              HasSubstr("no nodes[9], there are 1"));
  EXPECT_THAT(placements_of(R"([{"children": [-1]}])").error().message,
              HasSubstr("is not a node index"));
  EXPECT_THAT(placements_of(R"([{"name": "camera"}])").error().message,
              HasSubstr("no node of the scene has a mesh"));
  EXPECT_THAT(placements_of(R"([{"mesh": 0, "rotation": [0, 0, 0, 0]}])").error().message,
              HasSubstr("rotation is a quaternion of length 0"));
  EXPECT_THAT(placements_of(R"([{"mesh": 0, "matrix": [1]}])").error().message,
              HasSubstr("is not 16 finite numbers"));
  std::string deep = "[";
  for (int i = 0; i < 1100; ++i) deep += "{\"children\": [" + std::to_string(i + 1) + "]},";
  EXPECT_THAT(placements_of((deep + "{\"mesh\": 0}]").c_str()).error().message,
              HasSubstr("nested deeper than 1000"));
}

}  // namespace
}  // namespace hermite::imports
