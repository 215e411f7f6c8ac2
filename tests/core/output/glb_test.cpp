#include "core/output/glb.h"

#include <draco/compression/decode.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "core/image/image_codec.h"
#include "core/output/axes.h"
#include "core/output/glb_parts.h"
#include "tests/support/analytic_mesh.h"

namespace hermite::output {
namespace {

using ::testing::HasSubstr;
using GlbJson = nlohmann::json;

// A GLB, taken apart by the specification alone.
struct TakenApart {
  GlbJson json;
  std::string binary;

  std::string view(std::size_t index) const {
    const GlbJson& view = json["bufferViews"][index];
    return binary.substr(view["byteOffset"], view["byteLength"]);
  }
  template <class Value>
  std::vector<Value> values(std::size_t accessor) const {
    const std::string bytes = view(json["accessors"][accessor]["bufferView"]);
    std::vector<Value> result(bytes.size() / sizeof(Value));
    std::memcpy(static_cast<void*>(result.data()), bytes.data(), bytes.size());
    return result;
  }
};

std::uint32_t word_at(const std::string& bytes, std::size_t at) {
  std::uint32_t word = 0;
  std::memcpy(&word, bytes.data() + at, sizeof word);
  return word;
}

TakenApart taken_apart(const Result<std::string>& glb) {
  EXPECT_TRUE(glb.ok()) << glb.error().message;
  EXPECT_EQ(glb->substr(0, 4), "glTF");
  EXPECT_EQ(word_at(*glb, 4), 2u);
  EXPECT_EQ(word_at(*glb, 8), glb->size());
  const std::uint32_t json_size = word_at(*glb, 12);
  EXPECT_EQ(json_size % 4, 0u);
  EXPECT_EQ(glb->substr(16, 4), "JSON");
  EXPECT_EQ(word_at(*glb, 20 + json_size), glb->size() - 28 - json_size);
  TakenApart result{GlbJson::parse(glb->substr(20, json_size)), glb->substr(28 + json_size)};
  EXPECT_EQ(result.json["buffers"][0]["byteLength"], result.binary.size());
  return result;
}

TEST(Glb, VerticesStandUprightAndKeepTheirNumbers) {
  const TriangleMesh mesh = test::sphere_mesh(6, 8);
  const TakenApart glb = taken_apart(format_mesh_glb(mesh, GlbCompression::kNone));
  const GlbJson& primitive = glb.json["meshes"][0]["primitives"][0];
  const auto positions = glb.values<Eigen::Vector3f>(primitive["attributes"]["POSITION"]);
  const auto normals = glb.values<Eigen::Vector3f>(primitive["attributes"]["NORMAL"]);
  const auto triangles = glb.values<TriangleCorners>(primitive["indices"]);
  ASSERT_EQ(triangles.size(), mesh.triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const Eigen::Vector3f &position = mesh.positions_m[mesh.triangles[i][k]],
                            &normal = mesh.normals[mesh.triangles[i][k]];
      EXPECT_EQ(positions[triangles[i][k]],
                Eigen::Vector3f(position.x(), -position.y(), -position.z()));
      EXPECT_LT(
          (normals[triangles[i][k]] - Eigen::Vector3f(normal.x(), -normal.y(), -normal.z())).norm(),
          1e-6f);
    }
  EXPECT_FALSE(glb.json["nodes"][0].contains("rotation")) << "turned twice";
}

TEST(Glb, ColoursOfVerticesAreLinear) {
  // 0.21586: sRGB of 128.
  EXPECT_EQ(linear_color({0, 255, 128}), (LinearRgba16{0, 65535, 14146, 65535}));
  TriangleMesh mesh = test::sphere_mesh(3, 3);
  mesh.colors.assign(mesh.colors.size(), Rgb8{128, 0, 255});
  const TakenApart glb = taken_apart(format_mesh_glb(mesh, GlbCompression::kNone));
  const GlbJson& primitive = glb.json["meshes"][0]["primitives"][0];
  const std::size_t accessor = primitive["attributes"]["COLOR_0"];
  EXPECT_EQ(glb.json["accessors"][accessor]["normalized"], true);
  EXPECT_EQ(glb.values<LinearRgba16>(accessor)[5], (LinearRgba16{14146, 0, 65535, 65535}));
}

TEST(Glb, EveryPageIsAPrimitiveWithAnImageOfItsOwn) {
  const TriangleMesh mesh = test::textured_plane(7, 3, 16);
  const TakenApart glb = taken_apart(format_mesh_glb(mesh, GlbCompression::kNone));
  ASSERT_EQ(glb.json["meshes"][0]["primitives"].size(), 3u);
  for (std::size_t page = 0; page < 3; ++page) {
    const GlbJson& primitive = glb.json["meshes"][0]["primitives"][page];
    EXPECT_FALSE(primitive["attributes"].contains("COLOR_0"))
        << "it would be multiplied with the texture";
    const GlbJson& material = glb.json["materials"][primitive["material"].get<std::size_t>()];
    EXPECT_EQ(material["doubleSided"], false);
    EXPECT_EQ(material["pbrMetallicRoughness"]["metallicFactor"], 0);
    EXPECT_EQ(material["pbrMetallicRoughness"]["roughnessFactor"], 1);
    const std::size_t texture = material["pbrMetallicRoughness"]["baseColorTexture"]["index"];
    const GlbJson& image =
        glb.json["images"][glb.json["textures"][texture]["source"].get<std::size_t>()];
    EXPECT_EQ(image["mimeType"], "image/jpeg");
    const std::string jpeg = glb.view(image["bufferView"]);
    const auto decoded = image::decode_color(
        {reinterpret_cast<const std::uint8_t*>(jpeg.data()), jpeg.size()}, {16, 16});
    ASSERT_TRUE(decoded.ok()) << decoded.error().message;
    EXPECT_NEAR(decoded->at(3, 3).r, 40 * static_cast<int>(page), 2);
    const auto coordinates = glb.values<Eigen::Vector2f>(primitive["attributes"]["TEXCOORD_0"]);
    EXPECT_EQ(coordinates.size(), 2u * mesh.pages[page].triangle_count);
  }
}

TEST(Glb, AnImageThatIsLaidSideBySideRepeatsItself) {
  TriangleMesh mesh = test::textured_plane(2, 1, 16);
  EXPECT_NE(format_mesh_glb(mesh, GlbCompression::kNone)->find("\"wrapS\":33071"),
            std::string::npos)
      << "the page of an atlas does not";
  for (Eigen::Vector2f& uv : mesh.texture_coordinates) uv *= 3;
  EXPECT_NE(format_mesh_glb(mesh, GlbCompression::kNone)->find("\"wrapS\":10497"),
            std::string::npos);
}

TEST(Glb, APageOfOnePixelAndOneWithoutTriangles) {
  TriangleMesh mesh = test::textured_plane(2, 2, 1);
  mesh.pages.push_back({mesh.pages[0].image, 4, 0});
  const TakenApart glb = taken_apart(format_mesh_glb(mesh, GlbCompression::kNone));
  EXPECT_EQ(glb.json["meshes"][0]["primitives"].size(), 2u);
  EXPECT_EQ(glb.json["images"].size(), 2u);
}

TEST(Glb, MoreVerticesThanSixteenBitsCount) {
  const TriangleMesh mesh = test::sphere_mesh(300, 300);
  ASSERT_GT(mesh.positions_m.size(), 65535u);
  const TakenApart glb = taken_apart(format_mesh_glb(mesh, GlbCompression::kNone));
  const std::size_t indices = glb.json["meshes"][0]["primitives"][0]["indices"];
  const auto triangles = glb.values<TriangleCorners>(indices);
  EXPECT_EQ(triangles.size(), mesh.triangles.size());
  std::uint32_t highest = 0;
  for (const TriangleCorners& corners : triangles)
    highest = std::max({highest, corners[0], corners[1], corners[2]});
  EXPECT_EQ(highest + 1, glb.json["accessors"][0]["count"]);
}

// The Draco bytes of a primitive, decoded.
std::unique_ptr<draco::Mesh> decoded_primitive(const TakenApart& glb, const GlbJson& primitive) {
  const GlbJson& extension = primitive["extensions"]["KHR_draco_mesh_compression"];
  const std::string bytes = glb.view(extension["bufferView"]);
  draco::DecoderBuffer buffer;
  buffer.Init(bytes.data(), bytes.size());
  auto mesh = draco::Decoder().DecodeMeshFromBuffer(&buffer);
  EXPECT_TRUE(mesh.ok()) << mesh.status().error_msg_string();
  std::unique_ptr<draco::Mesh> decoded = std::move(mesh).value();
  EXPECT_EQ(decoded->num_points(),
            glb.json["accessors"][primitive["attributes"]["POSITION"].get<std::size_t>()]["count"]);
  EXPECT_EQ(3 * decoded->num_faces(),
            glb.json["accessors"][primitive["indices"].get<std::size_t>()]["count"]);
  for (const auto& [name, id] : extension["attributes"].items())
    EXPECT_NE(decoded->GetAttributeByUniqueId(id.get<std::uint32_t>()), nullptr) << name;
  return decoded;
}

TEST(Glb, DracoDecodesWithinATenthOfAMillimetre) {
  const TriangleMesh mesh = test::sphere_mesh(20, 30, 1.5f);
  const Result<std::string> bytes = format_mesh_glb(mesh, GlbCompression::kDraco);
  const TakenApart glb = taken_apart(bytes);
  EXPECT_LT(3 * bytes->size(), format_mesh_glb(mesh, GlbCompression::kNone)->size());
  const GlbJson& primitive = glb.json["meshes"][0]["primitives"][0];
  const std::unique_ptr<draco::Mesh> decoded = decoded_primitive(glb, primitive);
  const GlbJson& ids = primitive["extensions"]["KHR_draco_mesh_compression"]["attributes"];
  const auto* positions = decoded->GetAttributeByUniqueId(ids["POSITION"].get<std::uint32_t>());
  const auto* colors = decoded->GetAttributeByUniqueId(ids["COLOR_0"].get<std::uint32_t>());
  const auto* normals = decoded->GetAttributeByUniqueId(ids["NORMAL"].get<std::uint32_t>());
  for (draco::PointIndex i(0); i < decoded->num_points(); ++i) {
    Eigen::Vector3f position, normal;
    std::array<std::uint16_t, 3> color{};
    positions->GetMappedValue(i, position.data());
    normals->GetMappedValue(i, normal.data());
    colors->GetMappedValue(i, color.data());
    std::size_t nearest = 0;
    for (std::size_t k = 1; k < mesh.positions_m.size(); ++k)
      if ((y_up(mesh.positions_m[k]) - position).norm() <
          (y_up(mesh.positions_m[nearest]) - position).norm())
        nearest = k;
    EXPECT_LT((y_up(mesh.positions_m[nearest]) - position).cwiseAbs().maxCoeff(), 1.01e-4f);
    EXPECT_LT((y_up(mesh.normals[nearest]) - normal).norm(), 0.005f);
    EXPECT_EQ(color[0], linear_color(mesh.colors[nearest])[0]);
  }
}

TEST(Glb, PagesThatMeetStayTogetherUnderDraco) {
  const TakenApart glb =
      taken_apart(format_mesh_glb(test::textured_plane(6, 2, 64), GlbCompression::kDraco));
  std::array<std::vector<float>, 2> borders;
  for (std::size_t page = 0; page < 2; ++page) {
    const std::unique_ptr<draco::Mesh> decoded =
        decoded_primitive(glb, glb.json["meshes"][0]["primitives"][page]);
    const auto* positions = decoded->GetNamedAttribute(draco::GeometryAttribute::POSITION);
    for (draco::PointIndex i(0); i < decoded->num_points(); ++i) {
      Eigen::Vector3f position;
      positions->GetMappedValue(i, position.data());
      borders[page].push_back(position.x());
    }
  }
  for (const float x : borders[0])  // the outermost two columns belong to one page only
    if (x > 0.01f && x < 0.99f) {
      EXPECT_THAT(borders[1], ::testing::Contains(x));
    }
}

TEST(Glb, TheSameMeshGivesTheSameBytes) {
  for (const GlbCompression compression : {GlbCompression::kNone, GlbCompression::kDraco})
    EXPECT_EQ(*format_mesh_glb(test::textured_plane(5, 2, 8), compression),
              *format_mesh_glb(test::textured_plane(5, 2, 8), compression));
}

TEST(Glb, WhatIsNoMeshIsRefused) {
  TriangleMesh mesh = test::sphere_mesh(3, 3);
  mesh.positions_m[4].x() = std::nanf("");
  for (const GlbCompression compression : {GlbCompression::kNone, GlbCompression::kDraco}) {
    EXPECT_THAT(format_mesh_glb(mesh, compression).error().message, HasSubstr("vertex 4"));
    EXPECT_THAT(format_mesh_glb({}, compression).error().message, HasSubstr("no triangle"));
  }
}

TEST(Glb, ATriangleWithoutAnAreaAndANormalWithoutALength) {
  TriangleMesh mesh = test::sphere_mesh(3, 4);
  mesh.triangles.push_back({0, 0, 0});
  mesh.normals[1].setZero();
  const TakenApart glb = taken_apart(format_mesh_glb(mesh, GlbCompression::kNone));
  for (const Eigen::Vector3f& normal :
       glb.values<Eigen::Vector3f>(glb.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"]))
    EXPECT_NEAR(normal.norm(), 1, 1e-5);
  const TakenApart compressed = taken_apart(format_mesh_glb(mesh, GlbCompression::kDraco));
  decoded_primitive(compressed, compressed.json["meshes"][0]["primitives"][0]);
}

TEST(Glb, OneTriangleOfOnePointUnderDraco) {
  TriangleMesh mesh = test::sphere_mesh(2, 3);
  mesh.triangles = {{0, 0, 0}};
  const Result<std::string> glb = format_mesh_glb(mesh, GlbCompression::kDraco);
  if (glb.ok()) {
    decoded_primitive(taken_apart(glb), taken_apart(glb).json["meshes"][0]["primitives"][0]);
  } else {
    EXPECT_THAT(glb.error().message, HasSubstr("Draco"));
  }
}

TEST(Glb, ACloudIsPoints) {
  Cloud cloud(3);
  for (CloudPoint& point : cloud) point.normal = {0, 0, -1};
  cloud[1].position_m = {1, 2, 3};
  cloud[1].color = {255, 0, 128};
  const TakenApart glb = taken_apart(format_cloud_glb(cloud));
  const GlbJson& primitive = glb.json["meshes"][0]["primitives"][0];
  EXPECT_EQ(primitive["mode"], 0);
  EXPECT_EQ(glb.values<Eigen::Vector3f>(primitive["attributes"]["POSITION"])[1],
            Eigen::Vector3f(1, -2, -3));
  EXPECT_EQ(glb.values<LinearRgba16>(primitive["attributes"]["COLOR_0"])[1],
            (LinearRgba16{65535, 0, 14146, 65535}));
  cloud[2].position_m.z() = INFINITY;
  EXPECT_THAT(format_cloud_glb(cloud).error().message, HasSubstr("point 2 of 3"));
  EXPECT_THAT(format_cloud_glb({}).error().message, HasSubstr("no point"));
}

}  // namespace
}  // namespace hermite::output
