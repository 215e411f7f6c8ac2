#include "core/output/ply_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/output/mesh_ply.h"
#include "core/output/ply.h"
#include "tests/support/analytic_mesh.h"

namespace hermite::output {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const std::string kSquare =
    "ply\nformat ascii 1.0\ncomment by hand\nelement vertex 4\nproperty double x\nproperty uchar "
    "quality\nproperty float y\nproperty float "
    "z\n"
    "element face 1\nproperty list uchar int vertex_indices\nelement edge 1\nproperty int "
    "a\nend_header\n"
    "0 7 0 1\n1 7 0 1\n1 7 1 1.5\n0 7 1 1\n4 0 1 2 3\n9\n";

TEST(PlyReader, ReadsAPolygonAsAFan) {
  const auto shape = parse_ply(kSquare);
  ASSERT_TRUE(shape.ok()) << shape.error().message;
  ASSERT_EQ(shape->positions.size(), 4u);
  EXPECT_EQ(shape->positions[2], Eigen::Vector3f(1, 1, 1.5f));
  EXPECT_THAT(shape->triangles, ElementsAre(std::array<std::uint32_t, 3>{0, 1, 2},
                                            std::array<std::uint32_t, 3>{0, 2, 3}));
}

TEST(PlyReader, ReadsWhatWeWrite) {
  Cloud cloud(3);
  cloud[1].position_m = {1, -2, 3.25f};
  cloud[2].position_m = {0.5f, 0, -1};
  const auto shape = parse_ply(format_ply(cloud));
  ASSERT_TRUE(shape.ok()) << shape.error().message;
  ASSERT_EQ(shape->positions.size(), 3u);
  for (std::size_t i = 0; i < cloud.size(); ++i)
    EXPECT_EQ(shape->positions[i], cloud[i].position_m);
  EXPECT_TRUE(shape->triangles.empty());
}

TEST(PlyReader, ReadsNormalsAndRadiiWhereThereAreAny) {
  Cloud cloud(2);
  cloud[1].normal = {0, 0.6f, -0.8f};
  cloud[1].radius_m = 0.004f;
  const auto shape = parse_ply(format_ply(cloud));
  ASSERT_TRUE(shape.ok()) << shape.error().message;
  ASSERT_EQ(shape->normals.size(), 2u);
  ASSERT_EQ(shape->radii.size(), 2u);
  EXPECT_EQ(shape->normals[1], cloud[1].normal);
  EXPECT_EQ(shape->radii[1], cloud[1].radius_m);
  EXPECT_TRUE(parse_ply(kSquare)->normals.empty());
  EXPECT_TRUE(parse_ply(kSquare)->radii.empty());
}

TEST(PlyReader, ReadsBigEndian) {
  const std::string header =
      "ply\nformat binary_big_endian 1.0\nelement vertex 1\nproperty float x\nproperty double "
      "y\nproperty short z\nend_header\n";
  const auto shape =
      parse_ply(header + std::string("\x3f\xc0\0\0\xc0\x04\0\0\0\0\0\0\x01\x02", 14));
  ASSERT_TRUE(shape.ok()) << shape.error().message;
  EXPECT_EQ(shape->positions[0], Eigen::Vector3f(1.5f, -2.5f, 258));
}

TEST(PlyReader, SubtractsWhatIsFarOffWhenItIsAskedTo) {
  const std::string far =
      "ply\nformat ascii 1.0\ncomment somebody\nelement vertex 3\nproperty double x\nproperty "
      "double y\nproperty double z\nend_header\n"
      "nan 0 0\n4649776.001 0 -2000\n4649776.002 0 0\n";
  const auto shape = parse_ply(far, {.subtract_origin = true});
  ASSERT_TRUE(shape.ok()) << shape.error().message;
  EXPECT_EQ(shape->origin, Eigen::Vector3d(4649800, 0, -2000));
  EXPECT_NEAR(shape->positions[2].x() - shape->positions[1].x(), 0.001, 1e-5);
  EXPECT_THAT(shape->comments, ElementsAre("comment somebody"));
  EXPECT_EQ(parse_ply(far)->origin, Eigen::Vector3d::Zero());
  EXPECT_EQ(origin_near({999, -999, 0}), Eigen::Vector3d::Zero());
}

TEST(PlyReader, LimitsAreNamed) {
  EXPECT_THAT(parse_ply(kSquare, {.most_vertices = 3}).error().message,
              HasSubstr("more than 3 vertices"));
  EXPECT_THAT(parse_ply(kSquare, {.most_triangles = 1}).error().message,
              HasSubstr("more than 1 triangles"));
  std::string endless = "ply\nformat ascii 1.0\n";
  for (int i = 0; i < 2000; ++i) endless += "comment and so on, for a hundred gigabytes\n";
  EXPECT_THAT(parse_ply(endless).error().message, HasSubstr("all of it 65536"));
}

TEST(PlyReader, EveryCutIsAnErrorWithAMessage) {
  const std::string bytes = format_ply(Cloud(2));
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    const auto shape = parse_ply(std::string_view(bytes).substr(0, length));
    ASSERT_FALSE(shape.ok()) << length;
    EXPECT_THAT(shape.error().message, HasSubstr("PLY"));
  }
}

TEST(PlyReader, ACloudComesBackByteForByte) {
  Cloud cloud(3);
  cloud[1] = {
      {1.5f, -2.25f, 3.125f}, {0, 0.6f, -0.8f}, {10, 20, 255}, 12.5f, 40, -3, 0.004f, 4294967295u};
  const auto shape = parse_ply(format_ply(cloud));
  ASSERT_TRUE(shape.ok()) << shape.error().message;
  EXPECT_EQ(format_ply(cloud_of(*shape)), format_ply(cloud));
}

TEST(PlyReader, AMeshComesBackByteForByte) {
  const std::string bytes = format_mesh_ply(test::sphere_mesh(4, 6));
  auto shape = parse_ply(bytes);
  ASSERT_TRUE(shape.ok()) << shape.error().message;
  const auto mesh = mesh_of(*std::move(shape));
  ASSERT_TRUE(mesh.ok()) << mesh.error().message;
  EXPECT_EQ(format_mesh_ply(*mesh), bytes);
}

TEST(PlyReader, AMeshOfAnotherProgramGetsNormalsAndWhite) {
  const auto mesh = mesh_of(*parse_ply(kSquare));
  ASSERT_TRUE(mesh.ok()) << mesh.error().message;
  EXPECT_EQ(mesh->colors[2], (Rgb8{255, 255, 255}));
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(mesh->normals[i].norm(), 1, 1e-6);
    EXPECT_GT(mesh->normals[i].z(), 0.8f);
  }
  EXPECT_EQ(mesh_of(*parse_ply(format_ply(Cloud(2)))).error().code, ErrorCode::kNotFound);
}

std::string ascii_colors(const std::string& type, const std::string& values) {
  return "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty "
         "float z\nproperty " +
         type + " red\nproperty " + type + " green\nproperty " + type +
         " blue\nend_header\n1 2 3 " + values + "\n";
}

TEST(PlyReader, ColoursAreBytesWhateverTheirType) {
  EXPECT_THAT(parse_ply(ascii_colors("uchar", "0 128 255"))->colors,
              ElementsAre(Rgb8{0, 128, 255}));
  EXPECT_THAT(parse_ply(ascii_colors("ushort", "0 32896 65535"))->colors,
              ElementsAre(Rgb8{0, 128, 255}));
  EXPECT_THAT(parse_ply(ascii_colors("float", "0 0.5 1"))->colors, ElementsAre(Rgb8{0, 128, 255}));
  EXPECT_THAT(parse_ply(ascii_colors("float", "nan -3 1e30"))->colors, ElementsAre(Rgb8{0, 0, 0}))
      << "no colours at all";
  EXPECT_TRUE(parse_ply(kSquare)->colors.empty());
}

std::string with(std::string from, const std::string& to) {
  std::string text = kSquare;
  text.replace(text.find(from), from.size(), to);
  return text;
}

TEST(PlyReader, NamesWhatIsWrong) {
  EXPECT_THAT(parse_ply(with("ply", "obj")).error().message, HasSubstr("does not start"));
  EXPECT_EQ(parse_ply(with("ascii", "binary_middle_endian")).error().code, ErrorCode::kUnsupported);
  EXPECT_THAT(parse_ply(with("double", "quad")).error().message, HasSubstr("quad"));
  EXPECT_THAT(parse_ply(with("vertex 4", "vertex 999999999999")).error().message,
              HasSubstr("vertex"));
  EXPECT_THAT(parse_ply(with("float y", "float u")).error().message, HasSubstr("lack x, y and z"));
  EXPECT_THAT(parse_ply(with("4 0 1 2 3", "4 0 1 2 4")).error().message, HasSubstr("not there"));
  EXPECT_THAT(parse_ply(with("4 0 1 2 3", "-1")).error().message, HasSubstr("face 0"));
  EXPECT_THAT(parse_ply(with("1.5", "up")).error().message, HasSubstr("vertex 2"));
  EXPECT_THAT(parse_ply(with("element edge", "element vertex")).error().message,
              HasSubstr("'vertex' is declared twice"));
  EXPECT_THAT(parse_ply(with("property int a\n", "")).error().message,
              HasSubstr("'edge' has no properties"));
}

}  // namespace
}  // namespace hermite::output
