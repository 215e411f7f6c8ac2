#include "core/output/obj.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "tests/support/analytic_mesh.h"

namespace hermite::output {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<std::string> obj_names(const NamedFiles& files) {
  std::vector<std::string> names;
  for (const NamedFile& file : files) names.push_back(file.name);
  return names;
}

TEST(Obj, ColouredVerticesReadBackAsTheSameFloats) {
  const TriangleMesh mesh = test::sphere_mesh(4, 5);
  const Result<NamedFiles> files = format_obj(mesh);
  ASSERT_TRUE(files.ok()) << files.error().message;
  EXPECT_THAT(obj_names(*files), ElementsAre("mesh.obj"));
  std::istringstream lines(files->front().bytes);
  std::size_t vertex = 0, face = 0;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string keyword;
    words >> keyword;
    if (keyword == "v") {
      float x = 0, y = 0, z = 0, r = 0, g = 0, b = 0;
      words >> x >> y >> z >> r >> g >> b;
      const Eigen::Vector3f& position = mesh.positions_m[vertex];
      EXPECT_EQ(Eigen::Vector3f(x, -y, -z), position);
      EXPECT_EQ(std::lround(255 * g), mesh.colors[vertex++].g);
    }
    if (keyword == "f") {
      for (const std::uint32_t corner : mesh.triangles[face]) {
        std::string word;
        words >> word;
        EXPECT_EQ(word, std::to_string(corner + 1) + "//" + std::to_string(corner + 1));
      }
      ++face;
    }
  }
  EXPECT_EQ(vertex, mesh.positions_m.size());
  EXPECT_EQ(face, mesh.triangles.size());
}

TEST(Obj, PagesAreMaterialsWithImages) {
  const Result<NamedFiles> files = format_obj(test::textured_plane(3, 2, 1));
  ASSERT_TRUE(files.ok()) << files.error().message;
  EXPECT_THAT(obj_names(*files),
              ElementsAre("mesh.obj", "texture_0.jpg", "texture_1.jpg", "mesh.mtl"));
  EXPECT_THAT(files->front().bytes, HasSubstr("mtllib mesh.mtl\n"));
  EXPECT_THAT(files->front().bytes, HasSubstr("usemtl texture_0\nf 1/1/1 3/3/3 2/2/2\n"));
  EXPECT_THAT(files->front().bytes, HasSubstr("usemtl texture_1\nf 9/9/9 "));
  EXPECT_THAT(files->front().bytes, HasSubstr("\nvt 0 1\nvt 1 1\nvt 1 0\nvt 0 0\n"))
      << "upside down";
  EXPECT_THAT(files->front().bytes, HasSubstr("\nv 0 -0 -1\n"))
      << "a colour would be multiplied with the texture";
  EXPECT_THAT(files->back().bytes, HasSubstr("newmtl texture_1\n"));
  EXPECT_THAT(files->back().bytes, HasSubstr("map_Kd texture_1.jpg\n"));
  EXPECT_EQ((*files)[1].bytes.substr(0, 2), "\xff\xd8");
}

TEST(Obj, WhatIsNoMeshIsRefused) {
  TriangleMesh mesh = test::sphere_mesh(3, 3);
  mesh.normals[2].y() = std::nanf("");
  EXPECT_THAT(format_obj(mesh).error().message, HasSubstr("normal of vertex 2"));
  EXPECT_THAT(format_obj({}).error().message, HasSubstr("no triangle"));
}

}  // namespace
}  // namespace hermite::output
