#include "core/output/stl.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>

#include "tests/support/analytic_mesh.h"

namespace hermite::output {
namespace {

using ::testing::HasSubstr;

TEST(Stl, HasMillimetresStandingUpright) {
  const TriangleMesh mesh = test::sphere_mesh(5, 6);
  const Result<std::string> stl = format_stl(mesh);
  ASSERT_TRUE(stl.ok()) << stl.error().message;
  ASSERT_EQ(stl->size(), 84 + 50 * mesh.triangles.size());
  EXPECT_NE(stl->substr(0, 5), "solid");
  std::uint32_t count = 0;
  std::memcpy(&count, stl->data() + 80, 4);
  EXPECT_EQ(count, mesh.triangles.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    std::array<float, 12> values{};
    std::memcpy(values.data(), stl->data() + 84 + 50 * i, sizeof values);
    const Eigen::Vector3f& corner = mesh.positions_m[mesh.triangles[i][1]];
    EXPECT_NEAR(values[6], 1000 * corner.x(), 1e-3);
    EXPECT_NEAR(values[7], 1000 * corner.z(), 1e-3);
    EXPECT_NEAR(values[8], -1000 * corner.y(), 1e-3);
    const Eigen::Vector3f expected = test::face_normal(mesh, mesh.triangles[i]).normalized();
    EXPECT_NEAR(values[0], expected.x(), 1e-4);
    EXPECT_NEAR(values[2], -expected.y(), 1e-4);
  }
}

TEST(Stl, ATriangleWithoutAnAreaHasNoNormal) {
  TriangleMesh mesh = test::sphere_mesh(3, 3);
  mesh.triangles = {{1, 1, 1}};
  const Result<std::string> stl = format_stl(mesh);
  ASSERT_TRUE(stl.ok()) << stl.error().message;
  EXPECT_EQ(stl->substr(84, 12), std::string(12, '\0'));
}

TEST(Stl, WhatIsNoMeshIsRefused) {
  TriangleMesh mesh = test::sphere_mesh(3, 3);
  mesh.positions_m[2].y() = std::nanf("");
  EXPECT_THAT(format_stl(mesh).error().message, HasSubstr("vertex 2"));
  EXPECT_THAT(format_stl({}).error().message, HasSubstr("no triangle"));
}

}  // namespace
}  // namespace hermite::output
