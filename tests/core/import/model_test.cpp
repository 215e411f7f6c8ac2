#include "core/import/model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <limits>

#include "core/output/mesh_check.h"
#include "core/output/mesh_ply.h"
#include "core/output/ply.h"
#include "tests/support/analytic_mesh.h"
#include "tests/support/glb_bytes.h"
#include "tests/support/temporary_folder.h"

namespace hermite::imports {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::string ascii_ply(int vertices, const std::string& rows, const std::string& faces = "",
                      int face_count = 0) {
  return "ply\nformat ascii 1.0\nelement vertex " + std::to_string(vertices) +
         "\nproperty double x\nproperty double y\nproperty double z\nelement face " +
         std::to_string(face_count) + "\nproperty list uchar int vertex_indices\nend_header\n" +
         rows + faces;
}

std::string why_no_model(const std::string& bytes) {
  const auto model = read_model(bytes, {});
  return model.ok() ? "" : model.error().message;
}

TEST(Model, APlyHasZUpUnlessWeOrSomebodySaysElse) {
  const std::string one = ascii_ply(1, "1 2 3\n");
  EXPECT_EQ(read_model(one, {})->cloud[0].position_m, Eigen::Vector3f(1, -3, 2));
  EXPECT_EQ(read_model(one, {0.001, UpAxis::kY})->cloud[0].position_m,
            Eigen::Vector3f(1, -2, -3) * 0.001f);
  EXPECT_EQ(read_model(one, {1, UpAxis::kMinusY})->cloud[0].position_m, Eigen::Vector3f(1, 2, 3));
  output::Cloud cloud(1);
  cloud[0].position_m = {1, 2, 3};
  EXPECT_EQ(read_model(output::format_ply(cloud), {})->cloud[0].position_m,
            Eigen::Vector3f(1, 2, 3))
      << "our own is as it was";
}

TEST(Model, OurMeshIsAsItWas) {
  const output::TriangleMesh sphere = test::sphere_mesh(4, 6);
  const auto model = read_model(output::format_mesh_ply(sphere), {});
  ASSERT_TRUE(model.ok()) << model.error().message;
  EXPECT_EQ(model->mesh.positions_m, sphere.positions_m);
  EXPECT_EQ(model->mesh.triangles, sphere.triangles);
  EXPECT_EQ(model->mesh.colors, sphere.colors);
}

TEST(Model, MarksOfWhatIsFilledGoWithTheirTriangles) {
  output::TriangleMesh sphere = test::sphere_mesh(4, 6);
  sphere.is_filled.assign(sphere.triangles.size(), 0);
  sphere.is_filled.back() = 1;
  sphere.positions_m[sphere.triangles.front()[0]].x() = std::numeric_limits<float>::quiet_NaN();
  const auto model = read_model(output::format_mesh_ply(sphere), {});
  ASSERT_TRUE(model.ok()) << model.error().message;
  EXPECT_LT(model->mesh.triangles.size(), sphere.triangles.size());
  EXPECT_TRUE(output::check_mesh(model->mesh).ok());
  EXPECT_EQ(model->mesh.is_filled.back(), 1);
  EXPECT_EQ(std::count(model->mesh.is_filled.begin(), model->mesh.is_filled.end(), 1), 1);
}

TEST(Model, CoordinatesOfAMapLoseNoDigits) {
  const auto model =
      read_model(ascii_ply(2, "500000.125 4649776.25 30\n500000.126 4649776.25 30\n"), {});
  ASSERT_TRUE(model.ok()) << model.error().message;
  EXPECT_NEAR(model->cloud[1].position_m.x() - model->cloud[0].position_m.x(), 0.001, 1e-5);
  EXPECT_THAT(remarks_about(*model, {}),
              testing::Contains(HasSubstr("500000, 4649800, 0 was subtracted")));
}

TEST(Model, MillimetresAreDoubted) {
  const std::string room = ascii_ply(2, "0 0 0\n4200 3000 2400\n");
  EXPECT_THAT(
      remarks_about(*read_model(room, {}), {}),
      testing::Contains(HasSubstr("spans 4200 m, taken as metres: if the file is in millimetres")));
  const ImportOptions millimetres{0.001, {}};
  EXPECT_EQ(remarks_about(*read_model(room, millimetres), millimetres).size(), 1u);
  EXPECT_THAT(why_no_model(ascii_ply(2, "0 0 0\n1e30 0 0\n")),
              HasSubstr("the limit is 20000 m; for a file in millimetres use the scale 0.001"));
}

TEST(Model, WhatIsNotFiniteIsLeftOutAndCounted) {
  const auto cloud = read_model(ascii_ply(3, "nan 0 0\n0 1 2\ninf 0 0\n"), {});
  ASSERT_TRUE(cloud.ok()) << cloud.error().message;
  EXPECT_EQ(cloud->cloud.size(), 1u);
  EXPECT_EQ(cloud->left_out_vertices, 2u);
  const auto mesh =
      read_model(ascii_ply(4, "0 0 0\n1 0 0\n0 1 0\nnan 0 0\n", "3 0 1 2\n3 1 2 3\n", 2), {});
  ASSERT_TRUE(mesh.ok()) << mesh.error().message;
  EXPECT_THAT(mesh->mesh.triangles, ElementsAre(output::TriangleCorners{0, 1, 2}));
  EXPECT_TRUE(output::check_mesh(mesh->mesh).ok());
  EXPECT_THAT(remarks_about(*mesh, {}),
              testing::Contains("1 vertices are not finite and left out, with 1 triangles."));
  EXPECT_THAT(why_no_model(ascii_ply(1, "nan 0 0\n")),
              HasSubstr("the positions of all 1 vertices are not finite"));
}

TEST(Model, WhatIsWrongIsSaidInAMessage) {
  EXPECT_THAT(why_no_model(""), HasSubstr("neither PLY nor GLB"));
  EXPECT_THAT(why_no_model("Dear reader,\n"), HasSubstr("neither PLY nor GLB"));
  EXPECT_THAT(why_no_model("ply\n"), HasSubstr("header does not end"));
  EXPECT_THAT(why_no_model(ascii_ply(0, "")), HasSubstr("there is nothing in it"));
  EXPECT_THAT(why_no_model(ascii_ply(20'000'001, "0 0 0\n")),
              HasSubstr("more than 20000000 vertices"));
  EXPECT_THAT(why_no_model(ascii_ply(2, "0 0 0\n")), HasSubstr("cut at vertex 1 of 2"));
  EXPECT_THAT(why_no_model(ascii_ply(3, "0 0 0\n1 0 0\n0 1 0\n", "3 0 1 3\n", 1)),
              HasSubstr("names a vertex that is not there"));
  EXPECT_THAT(why_no_model("glTF"), HasSubstr("GLB"));
}

TEST(Model, OptionsAreTexts) {
  EXPECT_EQ(*parse_import_options({}), ImportOptions());
  EXPECT_EQ(*parse_import_options({{"scale", "0.001"}, {"up", "-y"}}),
            (ImportOptions{0.001, UpAxis::kMinusY}));
  for (const char* scale : {"0", "-1", "nan", "inf", "1e7", "1m", ""})
    EXPECT_FALSE(parse_import_options({{"scale", scale}}).ok()) << scale;
  EXPECT_THAT(parse_import_options({{"up", "x"}}).error().message, HasSubstr("y, z or -y"));
  EXPECT_THAT(parse_import_options({{"icp.levels", "3"}}).error().message,
              HasSubstr("is not an import setting"));
  EXPECT_TRUE(is_import_option("up"));
  EXPECT_FALSE(is_import_option("icp.levels"));
}

TEST(Model, IsRecognisedByItsFirstBytes) {
  const test::TemporaryFolder folder;
  const auto is = [&folder](const std::string& bytes) {
    std::ofstream(folder / "file", std::ios::binary) << bytes;
    return *is_model_file(folder / "file");
  };
  EXPECT_TRUE(is("ply\r\n"));
  EXPECT_TRUE(is("glTF"));
  EXPECT_FALSE(is("plyer"));
  EXPECT_FALSE(is(""));
  EXPECT_FALSE(is_model_file(folder / "nothing").ok());
}

}  // namespace
}  // namespace hermite::imports
