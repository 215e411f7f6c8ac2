// One chunk as a file, so that both ends are held to the same bytes: this test says that the server
// encodes it so, the viewer's web/src/connection/draco.test.ts that the browser's decoder reads it
// so. To write it again after a wanted change of the encoding:
//
//   HERMITE_WRITE_GOLDEN=1 test_data --gtest_filter='GoldenChunk*'
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numbers>

#include "core/output/chunks.h"
#include "tests/source_root/source_root.h"
#include "tests/support/file_bytes.h"

namespace hermite::output {
namespace {

constexpr int kPointCount = 500;
constexpr float kSphereRadius_m = 0.1f;

// A sphere in the middle of chunk (0, 0, 0); colour and confidence grow with the position, so that
// every point can be checked by itself.
std::vector<SlotChange> sphere() {
  std::vector<SlotChange> changes;
  for (int i = 0; i < kPointCount; ++i) {
    const double z = 1 - 2 * (i + 0.5) / kPointCount;
    // Golden angle: evenly spread.
    const double turn_rad = i * std::numbers::pi * (3 - std::sqrt(5.0));
    const double ring = std::sqrt(1 - z * z);
    SlotChange change;
    change.slot = static_cast<std::uint32_t>(i);
    change.alive = true;
    change.point.normal =
        Eigen::Vector3d(ring * std::cos(turn_rad), ring * std::sin(turn_rad), z).cast<float>();
    change.point.position_m =
        Eigen::Vector3f::Constant(kChunkEdge_m / 2) + kSphereRadius_m * change.point.normal;
    const Eigen::Vector3f share = change.point.position_m / kChunkEdge_m;
    const auto byte = [](float value) {
      return static_cast<std::uint8_t>(std::lround(255 * value));
    };
    change.point.color = {byte(share.x()), byte(share.y()), byte(share.z())};
    change.point.confidence = 20 * share.z();
    changes.push_back(change);
  }
  return changes;
}

TEST(GoldenChunk, IsEncodedAsTheViewersTestReadsIt) {
  const std::filesystem::path root = hermite::test::source_root();
  const std::filesystem::path golden = root / "web/src/connection/testdata/sphere_chunk.drc";
  ChunkedModel model;
  model.apply(sphere());
  const auto chunk = model.encode(ChunkKey{});
  ASSERT_TRUE(chunk.ok()) << chunk.error().message;
  EXPECT_EQ(chunk->point_count, static_cast<std::uint32_t>(kPointCount));
  if (std::getenv("HERMITE_WRITE_GOLDEN") != nullptr)
    std::ofstream(golden, std::ios::binary) << chunk->draco;
  const std::vector<std::uint8_t> expected = test::file_bytes(golden);
  ASSERT_FALSE(expected.empty()) << golden;
  EXPECT_TRUE(std::equal(expected.begin(), expected.end(), chunk->draco.begin(), chunk->draco.end(),
                         [](std::uint8_t a, char b) { return a == static_cast<std::uint8_t>(b); }))
      << chunk->draco.size() << " bytes now, " << expected.size() << " in " << golden;
}

}  // namespace
}  // namespace hermite::output
