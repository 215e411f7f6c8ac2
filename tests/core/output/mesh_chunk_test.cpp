#include "core/output/mesh_chunk.h"

#include <draco/compression/decode.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>

#include "tests/source_root/source_root.h"
#include "tests/support/file_bytes.h"

namespace hermite::output {
namespace {

constexpr double kChunkCell_m = 0.016;
constexpr float kStep_m = static_cast<float>(kMeshChunkStep_cells * kChunkCell_m);

// A wavy strip of squares from x = `first` cells on, one cell apart.
TriangleMesh strip(int first, int count) {
  TriangleMesh mesh;
  for (int x = first; x <= first + count; ++x)
    for (int y = 0; y < 2; ++y) {
      const auto cell_m = static_cast<float>(kChunkCell_m);
      mesh.positions_m.emplace_back(static_cast<float>(x) * cell_m + 0.001f,
                                    static_cast<float>(y) * cell_m,
                                    0.005f * std::sin(static_cast<float>(x)));
      mesh.normals.push_back(Eigen::Vector3f(0.1f, 0, 1).normalized());
      mesh.colors.push_back({static_cast<std::uint8_t>(x), 20, 30});
    }
  for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(count); ++i) {
    mesh.triangles.push_back({2 * i, 2 * i + 2, 2 * i + 1});
    mesh.triangles.push_back({2 * i + 1, 2 * i + 2, 2 * i + 3});
  }
  return mesh;
}

// As a viewer does it.
std::unique_ptr<draco::Mesh> decoded(const EncodedMesh& chunk) {
  draco::DecoderBuffer buffer;
  buffer.Init(chunk.draco.data(), chunk.draco.size());
  auto mesh = draco::Decoder().DecodeMeshFromBuffer(&buffer);
  EXPECT_TRUE(mesh.ok());
  return std::move(mesh).value();
}

TriangleMesh strip_with_confidences() {
  TriangleMesh mesh = strip(10, 20);
  for (const Rgb8& color : mesh.colors)
    mesh.confidence_eighths.push_back(static_cast<std::uint8_t>(8 * color.r));
  return mesh;
}

void expect_golden(const std::string& name, const TriangleMesh& mesh) {
  const std::filesystem::path golden =
      std::filesystem::path(test::source_root()) / "web/src/connection/testdata" / name;
  const Result<EncodedMesh> chunk = encode_mesh_chunk(mesh, kChunkCell_m);
  ASSERT_TRUE(chunk.ok());
  if (std::getenv("HERMITE_WRITE_GOLDEN") != nullptr)
    std::ofstream(golden, std::ios::binary) << chunk->draco;
  const std::vector<std::uint8_t> expected = test::file_bytes(golden);
  EXPECT_EQ(std::string(expected.begin(), expected.end()), chunk->draco);
}

template <class T>
std::array<T, 3> value(const draco::Mesh& mesh, std::uint32_t unique_id, std::uint32_t point) {
  const draco::PointAttribute& attribute = *mesh.GetAttributeByUniqueId(unique_id);
  std::array<T, 3> read{};
  EXPECT_TRUE((
      attribute.ConvertValue<T, 3>(attribute.mapped_index(draco::PointIndex(point)), read.data())));
  return read;
}

TEST(MeshChunk, KeepsPlacesToHalfAStepAndColoursAsTheyAre) {
  const TriangleMesh mesh = strip(10, 20);
  const Result<EncodedMesh> chunk = encode_mesh_chunk(mesh, kChunkCell_m);
  ASSERT_TRUE(chunk.ok());
  EXPECT_EQ(chunk->triangle_count, 40u);
  EXPECT_EQ(chunk->draco, encode_mesh_chunk(mesh, kChunkCell_m)->draco);
  const auto read = decoded(*chunk);
  ASSERT_EQ(read->num_faces(), 40u);
  ASSERT_EQ(read->num_points(), 42u);
  for (std::uint32_t i = 0; i < read->num_points(); ++i) {
    const auto [x, y, z] = value<float>(*read, 0, i);
    const auto [red, green, blue] = value<std::uint8_t>(*read, 2, i);
    const auto [nx, ny, nz] = value<float>(*read, 1, i);
    const Eigen::Vector3f read_m(x, y, z);
    const auto was = std::find_if(
        mesh.positions_m.begin(), mesh.positions_m.end(), [&](const Eigen::Vector3f& position_m) {
          return (position_m - read_m).cwiseAbs().maxCoeff() <= 0.51f * kStep_m;
        });
    ASSERT_NE(was, mesh.positions_m.end());
    const auto place = static_cast<std::size_t>(was - mesh.positions_m.begin());
    EXPECT_EQ(red, mesh.colors[place].r);
    EXPECT_EQ(green, 20);
    EXPECT_EQ(blue, 30);
    EXPECT_GT(mesh.normals[place].dot(Eigen::Vector3f(nx, ny, nz)), 0.999f);
  }
}

// Both ends are held to the same bytes: web/src/connection/mesh_piece.test.ts says that the
// browser's decoder reads them so. To write them again after a wanted change of the encoding:
// HERMITE_WRITE_GOLDEN=1 test_data --gtest_filter='MeshChunk.*'
TEST(MeshChunk, IsEncodedAsTheViewersTestReadsIt) {
  expect_golden("mesh_piece.drc", strip(10, 20));
  expect_golden("mesh_piece_with_confidence.drc", strip_with_confidences());
}

// Older viewers ask for the attributes 0 to 2 only.
TEST(MeshChunk, ConfidencesAreAFurtherAttributeAndChangeNoOther) {
  const TriangleMesh mesh = strip_with_confidences();
  const auto with = decoded(*encode_mesh_chunk(mesh, kChunkCell_m)),
             without = decoded(*encode_mesh_chunk(strip(10, 20), kChunkCell_m));
  EXPECT_EQ(without->num_attributes(), 3);
  ASSERT_EQ(with->num_attributes(), 4);
  const draco::PointAttribute& confidence = *with->GetAttributeByUniqueId(3);
  EXPECT_EQ(confidence.attribute_type(), draco::GeometryAttribute::GENERIC);
  EXPECT_EQ(confidence.data_type(), draco::DT_UINT8);
  EXPECT_EQ(confidence.num_components(), 1);
  ASSERT_EQ(with->num_faces(), without->num_faces());
  for (draco::FaceIndex i(0); i < with->num_faces(); ++i)
    EXPECT_EQ(with->face(i), without->face(i));
  ASSERT_EQ(with->num_points(), without->num_points());
  for (std::uint32_t i = 0; i < with->num_points(); ++i) {
    EXPECT_EQ(value<float>(*with, 0, i), value<float>(*without, 0, i));
    EXPECT_EQ(value<float>(*with, 1, i), value<float>(*without, 1, i));
    EXPECT_EQ(value<std::uint8_t>(*with, 2, i), value<std::uint8_t>(*without, 2, i));
    std::uint8_t eighths = 0;
    confidence.GetMappedValue(draco::PointIndex(i), &eighths);
    EXPECT_EQ(eighths, 8 * value<std::uint8_t>(*with, 2, i)[0]);
  }
}

TEST(MeshChunk, WhatTwoPiecesShareIsTheSameInBoth) {
  const auto left = decoded(*encode_mesh_chunk(strip(0, 10), kChunkCell_m));
  const auto right = decoded(*encode_mesh_chunk(strip(10, 10), kChunkCell_m));
  const auto near_seam = [](const draco::Mesh& mesh) {
    std::set<std::array<long, 3>> places;  // in hundredths of a millimetre
    for (std::uint32_t i = 0; i < mesh.num_points(); ++i) {
      const auto [x, y, z] = value<float>(mesh, 0, i);
      if (std::abs(x - 10 * static_cast<float>(kChunkCell_m)) < 0.004f)
        places.insert({std::lround(x * 1e5f), std::lround(y * 1e5f), std::lround(z * 1e5f)});
    }
    return places;
  };
  EXPECT_EQ(near_seam(*left).size(), 2u);
  EXPECT_EQ(near_seam(*left), near_seam(*right));
}

TEST(MeshChunk, NothingIsNoBytesAndTooMuchIsRefused) {
  const Result<EncodedMesh> nothing = encode_mesh_chunk({}, kChunkCell_m);
  ASSERT_TRUE(nothing.ok());
  EXPECT_EQ(nothing->triangle_count, 0u);
  EXPECT_TRUE(nothing->draco.empty());
  TriangleMesh wide = strip(0, 2);
  wide.positions_m[0].x() = 1e6f;
  EXPECT_EQ(encode_mesh_chunk(wide, kChunkCell_m).error().code, ErrorCode::kTooLarge);
  TriangleMesh many = strip(0, 2);
  many.triangles.assign(kMaxTrianglesPerChunk + 1, {0, 1, 2});
  EXPECT_EQ(encode_mesh_chunk(many, kChunkCell_m).error().code, ErrorCode::kTooLarge);
}

}  // namespace
}  // namespace hermite::output
