// Khronos' own validator reads what we write.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdio>
#include <string>

#include "core/output/glb.h"
#include "core/output/ply.h"
#include "tests/source_root/source_root.h"
#include "tests/support/analytic_mesh.h"
#include "tests/support/temporary_folder.h"

namespace hermite::output {
namespace {

using ::testing::HasSubstr;

constexpr int kNotInstalled = 77, kNoSuchProgram = 127;

struct Verdict {
  int status = -1;
  std::string message;
};

Verdict validate_glb(const std::string& bytes) {
  const test::TemporaryFolder folder;
  const std::string path = folder / "a scan.glb";
  EXPECT_TRUE(write_file_atomically(path, bytes).ok());
  const std::string command = "node '" + test::source_root().string() +
                              "/tests/core/output/validate_glb.mjs' '" + path + "' 2>&1";
  Verdict verdict;
  FILE* pipe = popen(command.c_str(), "r");
  if (!pipe) return verdict;
  char text[512];
  while (std::fgets(text, sizeof text, pipe)) verdict.message += text;
  verdict.status = WEXITSTATUS(pclose(pipe));
  return verdict;
}

void expect_valid(const Result<std::string>& glb, const std::string& message) {
  ASSERT_TRUE(glb.ok()) << glb.error().message;
  const Verdict verdict = validate_glb(*glb);
  if (verdict.status == kNotInstalled)
    GTEST_SKIP() << "gltf-validator is not installed: npm ci --prefix web";
  if (verdict.status == kNoSuchProgram) GTEST_SKIP() << "there is no node";
  EXPECT_EQ(verdict.status, 0) << verdict.message;
  EXPECT_THAT(verdict.message, HasSubstr(message));
}

TEST(GlbValidator, TakesColouredVertices) {
  expect_valid(format_mesh_glb(test::sphere_mesh(6, 8), GlbCompression::kNone),
               "56 vertices, 80 triangles");
}

TEST(GlbValidator, TakesATexture) {
  expect_valid(format_mesh_glb(test::textured_plane(7, 3, 16), GlbCompression::kNone),
               "28 vertices, 14 triangles");
}

TEST(GlbValidator, TakesAPageOfOnePixelAndAMeshWithoutAnArea) {
  TriangleMesh mesh = test::textured_plane(1, 1, 1);
  mesh.triangles[1] = {0, 0, 0};
  mesh.normals[0].setZero();
  expect_valid(format_mesh_glb(mesh, GlbCompression::kNone), "3 vertices, 2 triangles");
}

TEST(GlbValidator, TakesMoreVerticesThanSixteenBitsCount) {
  expect_valid(format_mesh_glb(test::sphere_mesh(300, 300), GlbCompression::kNone),
               "90300 vertices, 179400 triangles");
}

TEST(GlbValidator, TakesWhatIsAroundDraco) {
  expect_valid(format_mesh_glb(test::sphere_mesh(6, 8), GlbCompression::kDraco), "triangles");
  expect_valid(format_mesh_glb(test::textured_plane(7, 3, 16), GlbCompression::kDraco),
               "14 triangles");
}

TEST(GlbValidator, TakesPoints) {
  Cloud cloud(5);
  for (CloudPoint& point : cloud) point.normal = {0, 0.6f, -0.8f};
  expect_valid(format_cloud_glb(cloud), "5 vertices");
}

TEST(GlbValidator, SeesWhatIsWrong) {
  std::string glb = *format_mesh_glb(test::sphere_mesh(6, 8), GlbCompression::kNone);
  const std::size_t at = glb.find("\"POSITION\":0");
  ASSERT_NE(at, std::string::npos);
  glb[at + 11] = '9';
  const Verdict verdict = validate_glb(glb);
  if (verdict.status == kNotInstalled || verdict.status == kNoSuchProgram)
    GTEST_SKIP() << "no node, or gltf-validator is not installed";
  EXPECT_EQ(verdict.status, 1) << verdict.message;
}

}  // namespace
}  // namespace hermite::output
