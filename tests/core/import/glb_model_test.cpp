#include "core/import/glb_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "core/image/image_codec.h"
#include "core/output/glb.h"
#include "tests/support/analytic_mesh.h"
#include "tests/support/glb_bytes.h"

namespace hermite::imports {
namespace {

using nlohmann::json;
using testing::HasSubstr;

std::string glb(const output::TriangleMesh& mesh,
                output::GlbCompression compression = output::GlbCompression::kNone) {
  return *output::format_mesh_glb(mesh, compression);
}

TEST(GlbModel, WhatWeWriteComesBackInTheWorldOfTheScan) {
  const output::TriangleMesh sphere = test::sphere_mesh(6, 8);
  const auto model = read_glb_model(glb(sphere), {});
  ASSERT_TRUE(model.ok()) << model.error().message;
  EXPECT_TRUE(model->unchanged);
  ASSERT_EQ(model->mesh.triangles.size(), sphere.triangles.size());
  for (std::size_t i = 0; i < sphere.triangles.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t here = model->mesh.triangles[i][k], there = sphere.triangles[i][k];
      EXPECT_EQ(model->mesh.positions_m[here], sphere.positions_m[there]);
      EXPECT_EQ(model->mesh.colors[here], sphere.colors[there]) << "linear and back";
      EXPECT_LT((model->mesh.normals[here] - sphere.normals[there]).norm(), 1e-5f);
    }
}

float area_of(const output::TriangleMesh& mesh, std::size_t triangle) {
  const auto& [a, b, c] = mesh.triangles[triangle];
  return (mesh.positions_m[b] - mesh.positions_m[a])
             .cross(mesh.positions_m[c] - mesh.positions_m[a])
             .norm() /
         2;
}

TEST(GlbModel, MarksOfWhatIsFilledComeBackFromOurFilesAlone) {
  output::TriangleMesh sphere = test::sphere_mesh(6, 8);
  sphere.is_filled.assign(sphere.triangles.size(), 0);
  std::fill_n(sphere.is_filled.begin(), 5, std::uint8_t{1});
  for (const output::GlbCompression compression :
       {output::GlbCompression::kNone, output::GlbCompression::kDraco}) {
    const auto model = read_glb_model(glb(sphere, compression), {});
    ASSERT_TRUE(model.ok()) << model.error().message;
    const std::vector<std::uint8_t>& marks = model->mesh.is_filled;
    ASSERT_EQ(marks.size(), model->mesh.triangles.size());
    EXPECT_EQ(std::count(marks.begin(), marks.end(), 1), 5);
    float area_m2 = 0, filled_m2 = 0;  // the triangles may have another order
    for (std::size_t i = 0; i < marks.size(); ++i)
      area_m2 += marks[i] != 0 ? area_of(model->mesh, i) : 0;
    for (std::size_t i = 0; i < 5; ++i) filled_m2 += area_of(sphere, i);
    EXPECT_NEAR(area_m2, filled_m2, 1e-3f * filled_m2);
  }
  std::string foreign = glb(sphere);
  const std::size_t name = foreign.find("Hermite");
  foreign.replace(name, 7, "Blender");
  EXPECT_TRUE(read_glb_model(foreign, {})->mesh.is_filled.empty());
  sphere.is_filled.clear();
  EXPECT_TRUE(read_glb_model(glb(sphere), {})->mesh.is_filled.empty());
}

TEST(GlbModel, DracoComesBackToo) {
  const output::TriangleMesh sphere = test::sphere_mesh(6, 8);
  const auto model = read_glb_model(glb(sphere, output::GlbCompression::kDraco), {});
  ASSERT_TRUE(model.ok()) << model.error().message;
  EXPECT_EQ(model->mesh.triangles.size(), sphere.triangles.size());
  for (const Eigen::Vector3f& position : model->mesh.positions_m)
    EXPECT_NEAR((position - Eigen::Vector3f(0.5f, -0.25f, 2)).norm(), 0.5f, 2e-4f);
}

TEST(GlbModel, TexturesAreOnePageForEachImage) {
  const auto model = read_glb_model(glb(test::textured_plane(4, 2, 16)), {});
  ASSERT_TRUE(model.ok()) << model.error().message;
  ASSERT_EQ(model->mesh.pages.size(), 2u);
  EXPECT_EQ(model->mesh.pages[1].first_triangle, 4u);
  EXPECT_NEAR(model->mesh.pages[1].image.pixels[0].r, 40, 3);
  EXPECT_NEAR(model->mesh.colors[model->mesh.triangles[4][0]].b, 120, 3)
      << "vertices have the colour of the image there";
}

TEST(GlbModel, WhatHasNoImageBesideImagesHasTheColourOfItsMaterial) {
  const std::string image = [] {
    const auto bytes = *image::encode_png(ColorImage(4, 4));
    return std::string(bytes.begin(), bytes.end());
  }();
  json all = test::triangle_json();
  const std::string binary = test::triangle_binary() + std::string(2, '\0') + image;
  all["buffers"][0]["byteLength"] = binary.size();
  all["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", 44}, {"byteLength", image.size()}});
  all["images"] = {{{"bufferView", 2}, {"mimeType", "image/png"}}};
  all["textures"] = {{{"source", 0}}};
  all["materials"] =
      json::parse(R"([{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}, )"
                  R"({"pbrMetallicRoughness": {"baseColorFactor": [1, 0, 0, 1]}}])");
  json plain = all["meshes"][0]["primitives"][0];
  plain["material"] = 1;
  json& textured = all["meshes"][0]["primitives"][0];
  textured["material"] = 0;
  all["accessors"].push_back(
      {{"bufferView", 0}, {"componentType", 5126}, {"type", "VEC2"}, {"count", 3}});
  textured["attributes"]["TEXCOORD_0"] = 2;
  all["meshes"][0]["primitives"].push_back(plain);
  const auto model = read_glb_model(test::glb_of(all.dump(), binary), {});
  ASSERT_TRUE(model.ok()) << model.error().message;
  ASSERT_EQ(model->mesh.pages.size(), 2u);
  EXPECT_EQ(model->mesh.pages[1].image.pixels[0], (Rgb8{255, 0, 0}));
  // An image of 16384 x 16384 in 33 bytes is counted before it is decoded.
  std::string bomb = image;
  bomb.replace(16, 8, std::string("\0\0\x40\0\0\0\x40\x01", 8));
  EXPECT_THAT(
      read_glb_model(
          test::glb_of(all.dump(), test::triangle_binary() + std::string(2, '\0') + bomb), {})
          .error()
          .message,
      HasSubstr("images[0]"));
}

TEST(GlbModel, AMirrorTurnsTrianglesOver) {
  json all = test::triangle_json();
  const auto plain = read_glb_model(test::glb_of(all.dump(), test::triangle_binary()), {});
  all["nodes"][0]["scale"] = {-1, 1, 1};
  const auto mirrored = read_glb_model(test::glb_of(all.dump(), test::triangle_binary()), {});
  ASSERT_TRUE(plain.ok() && mirrored.ok());
  // Up in the file is z towards the eye for both, and in the world -z.
  EXPECT_EQ(plain->mesh.normals[0], Eigen::Vector3f(0, 0, -1));
  EXPECT_EQ(mirrored->mesh.normals[0], Eigen::Vector3f(0, 0, -1));
  EXPECT_EQ(mirrored->mesh.positions_m[1].x(), -1);
}

TEST(GlbModel, FarOffNodesLoseNothing) {
  json all = test::triangle_json();
  all["nodes"][0]["translation"] = {500000.125, 4649776.25, 30};
  const auto model = read_glb_model(test::glb_of(all.dump(), test::triangle_binary()), {});
  ASSERT_TRUE(model.ok()) << model.error().message;
  EXPECT_EQ(model->origin, Eigen::Vector3d(500000, 4649800, 0));
  EXPECT_EQ(model->mesh.positions_m[1], Eigen::Vector3f(1.125f, 23.75f, -30))
      << "y up is turned down";
  EXPECT_FALSE(model->unchanged);
}

}  // namespace
}  // namespace hermite::imports
