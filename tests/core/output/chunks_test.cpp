#include "core/output/chunks.h"

#include <draco/compression/decode.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <random>
#include <set>

namespace hermite::output {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

CloudPoint point_at(const Eigen::Vector3f& position_m, float confidence = 5,
                    std::uint32_t submap = 0) {
  CloudPoint point;
  point.position_m = position_m;
  point.normal = Eigen::Vector3f(1, 2, -3).normalized();
  point.color = {10, 20, 30};
  point.confidence = confidence;
  point.submap = submap;
  return point;
}

SlotChange set(std::uint32_t slot, const CloudPoint& point) { return {slot, true, point}; }
SlotChange gone(std::uint32_t slot) { return {slot, false, {}}; }

void apply_changes(ChunkedModel& model, const std::vector<SlotChange>& changes) {
  model.apply(changes);
}

struct Decoded {
  std::vector<Eigen::Vector3f> positions_m, normals;
  std::vector<Rgb8> colors;
  std::vector<std::uint8_t> confidences;
};

template <class T, int kCount>
std::array<T, kCount> read(const draco::PointAttribute& attribute, std::uint32_t point) {
  std::array<T, kCount> value{};
  EXPECT_TRUE((attribute.ConvertValue<T, kCount>(attribute.mapped_index(draco::PointIndex(point)),
                                                 value.data())));
  return value;
}

// With libdraco's own decoder, as a viewer does it.
Decoded decode(const EncodedChunk& chunk) {
  Decoded decoded;
  draco::DecoderBuffer buffer;
  buffer.Init(chunk.draco.data(), chunk.draco.size());
  draco::Decoder decoder;
  auto result = decoder.DecodePointCloudFromBuffer(&buffer);
  EXPECT_TRUE(result.ok()) << result.status().error_msg_string();
  if (!result.ok()) return decoded;
  const std::unique_ptr<draco::PointCloud> cloud = std::move(result).value();
  EXPECT_EQ(cloud->num_points(), chunk.point_count);
  const auto* positions = cloud->GetNamedAttribute(draco::GeometryAttribute::POSITION);
  const auto* normals = cloud->GetNamedAttribute(draco::GeometryAttribute::NORMAL);
  const auto* colors = cloud->GetNamedAttribute(draco::GeometryAttribute::COLOR);
  const auto* confidences = cloud->GetNamedAttribute(draco::GeometryAttribute::GENERIC);
  EXPECT_EQ(cloud->num_attributes(), normals ? 4 : 3);
  if (!positions || !colors || !confidences) {
    ADD_FAILURE() << "an attribute is missing";
    return decoded;
  }
  EXPECT_EQ(positions->data_type(), draco::DT_FLOAT32);
  EXPECT_EQ(colors->data_type(), draco::DT_UINT8);
  EXPECT_EQ(colors->num_components(), 3);
  EXPECT_EQ(confidences->data_type(), draco::DT_UINT8);
  EXPECT_EQ(confidences->num_components(), 1);
  for (std::uint32_t i = 0; i < cloud->num_points(); ++i) {
    const auto position = read<float, 3>(*positions, i);
    const auto color = read<std::uint8_t, 3>(*colors, i);
    decoded.positions_m.emplace_back(position[0], position[1], position[2]);
    if (normals) decoded.normals.emplace_back(read<float, 3>(*normals, i).data());
    decoded.colors.push_back({color[0], color[1], color[2]});
    decoded.confidences.push_back(read<std::uint8_t, 1>(*confidences, i)[0]);
  }
  return decoded;
}

EncodedChunk encoded(const ChunkedModel& model, const ChunkKey& key) {
  Result<EncodedChunk> chunk = model.encode(key);
  EXPECT_TRUE(chunk.ok());
  return chunk.ok() ? *std::move(chunk) : EncodedChunk();
}

std::vector<SlotChange> random_points(std::uint32_t count, float reach_m, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> coordinate(-reach_m, reach_m), unit(-1, 1),
      confidence(0, 40);
  std::vector<SlotChange> changes;
  for (std::uint32_t slot = 0; slot < count; ++slot) {
    CloudPoint point = point_at({coordinate(random), coordinate(random), coordinate(random)},
                                confidence(random), slot % 3);
    point.normal = Eigen::Vector3f(unit(random), unit(random), unit(random)).normalized();
    point.color = {static_cast<std::uint8_t>(random()), static_cast<std::uint8_t>(random()),
                   static_cast<std::uint8_t>(random())};
    changes.push_back(set(slot, point));
  }
  return changes;
}

TEST(ChunkedModel, KeysRoundDownOnBothSidesOfZero) {
  ChunkedModel model;
  apply_changes(model,
                {set(0, point_at({0.1f, 0.1f, 0.1f})), set(1, point_at({-0.001f, 0.1f, -0.3201f})),
                 set(2, point_at({0.32f, -0.32f, 0.6399f}, 5, 7))});
  EXPECT_THAT(model.take_dirty(), ElementsAre(ChunkKey{0, 0, -1, 0, -2}, ChunkKey{0, 0, 0, 0, 0},
                                              ChunkKey{7, 0, 1, -1, 1}));
  EXPECT_THAT(model.take_dirty(), IsEmpty());
}

TEST(ChunkedModel, DecodesToWhatWentIn) {
  ChunkedModel model;
  CloudPoint point = point_at({1.0f, -2.0f, 0.5f}, 7.49f, 4);
  apply_changes(model, {set(3, point)});
  const std::vector<ChunkKey> keys = model.take_dirty();
  ASSERT_THAT(keys, ElementsAre(ChunkKey{4, 0, 3, -7, 1}));
  const EncodedChunk chunk = encoded(model, keys[0]);
  EXPECT_EQ(chunk.key, keys[0]);
  ASSERT_EQ(chunk.point_count, 1u);
  const Decoded decoded = decode(chunk);
  ASSERT_EQ(decoded.positions_m.size(), 1u);
  EXPECT_LT((decoded.positions_m[0] - point.position_m).cwiseAbs().maxCoeff(),
            kVoxelEdge_m / 16 + 1e-6f);
  EXPECT_GT(decoded.normals[0].dot(point.normal), 0.999f);
  EXPECT_EQ(decoded.colors[0], point.color);
  EXPECT_EQ(decoded.confidences[0], 60);  // round(7.49 * 8)
}

TEST(ChunkedModel, NoPointIsOffByMoreThanASixteenthVoxel) {
  ChunkedModel model;
  const std::vector<SlotChange> changes = random_points(60'000, 1.0f, 1);
  model.apply(changes);
  std::size_t point_count = 0;
  double worst_m = 0, worst_normal_rad = 0;
  for (const ChunkKey& key : model.take_dirty()) {
    const EncodedChunk chunk = encoded(model, key);
    const Decoded decoded = decode(chunk);
    ASSERT_EQ(decoded.positions_m.size(), chunk.point_count);
    point_count += chunk.point_count;
    // Colours are random: they say which point it was.
    for (std::size_t i = 0; i < decoded.positions_m.size(); ++i) {
      const SlotChange* best = nullptr;
      float best_m = 1;
      for (const SlotChange& change : changes) {
        if (!(change.point.color == decoded.colors[i]) || change.point.submap != key.submap)
          continue;
        const float distance_m =
            (change.point.position_m - decoded.positions_m[i]).cwiseAbs().maxCoeff();
        if (distance_m < best_m) best = &change, best_m = distance_m;
      }
      ASSERT_NE(best, nullptr);
      worst_m = std::max(worst_m, static_cast<double>(best_m));
      worst_normal_rad =
          std::max(worst_normal_rad,
                   std::acos(std::min(
                       1.0, static_cast<double>(best->point.normal.dot(decoded.normals[i])))));
    }
    if (point_count > 3000) break;  // every point is compared with all
  }
  EXPECT_GT(point_count, 3000u);
  EXPECT_LE(worst_m, kVoxelEdge_m / 16 + 1e-6);
  EXPECT_LE(worst_normal_rad, 0.02);  // 8-bit octahedral
}

TEST(ChunkedModel, CornersOfAChunkStayInIt) {
  const float last_m = std::nextafter(kChunkEdge_m, 0.0f);
  ChunkedModel model;
  apply_changes(model, {set(0, point_at({0, 0, 0})), set(1, point_at({last_m, last_m, last_m})),
                        set(2, point_at({0, last_m, 0}))});
  ASSERT_THAT(model.take_dirty(), ElementsAre(ChunkKey{}));
  const Decoded decoded = decode(encoded(model, ChunkKey{}));
  ASSERT_EQ(decoded.positions_m.size(), 3u);
  for (const Eigen::Vector3f& position_m : decoded.positions_m) {
    EXPECT_GT(position_m.minCoeff(), 0.0f);
    EXPECT_LT(position_m.maxCoeff(), kChunkEdge_m);
    const Eigen::Vector3f rest_m =
        position_m.unaryExpr([&](float x_m) { return std::min(x_m, last_m - x_m); });
    EXPECT_LE(rest_m.maxCoeff(), kVoxelEdge_m / 16 + 1e-6f);
  }
}

TEST(ChunkedModel, NeighboursShareOneGrid) {
  // A row of points across a border: the steps between their decoded places are whole steps of 1/8
  // voxel.
  ChunkedModel model;
  std::vector<SlotChange> row;
  for (std::uint32_t i = 0; i < 40; ++i)
    row.push_back(set(i, point_at({0.2201f + static_cast<float>(i) * 0.005f, 0.1f, 0.1f})));
  model.apply(row);
  std::vector<float> xs_m;
  for (const ChunkKey& key : model.take_dirty()) {
    for (const Eigen::Vector3f& position_m : decode(encoded(model, key)).positions_m)
      xs_m.push_back(position_m.x());
  }
  ASSERT_EQ(xs_m.size(), 40u);
  std::sort(xs_m.begin(), xs_m.end());
  for (std::size_t i = 1; i < xs_m.size(); ++i) {
    const float steps = (xs_m[i] - xs_m[0]) / (kVoxelEdge_m / 8);
    EXPECT_NEAR(steps, std::round(steps), 2e-3f) << i;
  }
}

TEST(ChunkedModel, KeepsTheMostConfidentThenTheLowestSlotOfAVoxel) {
  ChunkedModel model;
  CloudPoint weak = point_at({0.001f, 0.001f, 0.001f}, 3), strong = weak, twin = weak, other = weak;
  strong.confidence = twin.confidence = 9;
  strong.color = {1, 1, 1};
  twin.color = {2, 2, 2};
  other.position_m.x() = 0.006f;
  other.color = {3, 3, 3};
  apply_changes(model, {set(9, strong), set(8, twin), set(1, weak), set(4, other)});
  EncodedChunk chunk = encoded(model, ChunkKey{});
  EXPECT_EQ(chunk.point_count, 2u);
  EXPECT_THAT(decode(chunk).colors, ::testing::UnorderedElementsAre(twin.color, other.color));
  apply_changes(model, {gone(8)});
  EXPECT_THAT(decode(encoded(model, ChunkKey{})).colors,
              ::testing::UnorderedElementsAre(strong.color, other.color));
  apply_changes(model, {gone(9)});
  EXPECT_THAT(decode(encoded(model, ChunkKey{})).colors,
              ::testing::UnorderedElementsAre(weak.color, other.color));
}

TEST(ChunkedModel, MovingDirtiesBothChunksAndLeavingEmptiesOne) {
  ChunkedModel model;
  apply_changes(model, {set(5, point_at({0.1f, 0.1f, 0.1f}))});
  model.take_dirty();
  apply_changes(model, {set(5, point_at({0.4f, 0.1f, 0.1f}))});
  EXPECT_THAT(model.take_dirty(), ElementsAre(ChunkKey{0, 0, 0, 0, 0}, ChunkKey{0, 0, 1, 0, 0}));
  const EncodedChunk empty = encoded(model, ChunkKey{0, 0, 0, 0, 0});
  EXPECT_EQ(empty.point_count, 0u);
  EXPECT_TRUE(empty.draco.empty());
  apply_changes(model, {set(5, point_at({0.4f, 0.1f, 0.1f}, 5, 2))});  // to another submap
  EXPECT_THAT(model.take_dirty(), ElementsAre(ChunkKey{0, 0, 1, 0, 0}, ChunkKey{2, 0, 1, 0, 0}));
  apply_changes(model, {gone(5)});
  EXPECT_THAT(model.take_dirty(), ElementsAre(ChunkKey{2, 0, 1, 0, 0}));
  // The slot is used again, the chunk comes back.
  apply_changes(model, {set(5, point_at({0.1f, 0.1f, 0.1f}))});
  EXPECT_THAT(model.take_dirty(), ElementsAre(ChunkKey{0, 0, 0, 0, 0}));
  EXPECT_EQ(encoded(model, ChunkKey{}).point_count, 1u);
}

TEST(ChunkedModel, WhatDoesNotChangeTouchesNothing) {
  ChunkedModel model;
  apply_changes(model, {gone(17)});
  EXPECT_THAT(model.take_dirty(), IsEmpty());
  apply_changes(model, {set(1, point_at({0.1f, 0.1f, 0.1f}))});
  model.take_dirty();
  apply_changes(model, {set(1, point_at({0.1f, 0.1f, 0.1f})), gone(2), gone(4'000'000)});
  EXPECT_THAT(model.take_dirty(), IsEmpty());
  apply_changes(model, {set(1, point_at({0.1f, 0.1f, 0.1f}, 6))});
  EXPECT_THAT(model.take_dirty(), ElementsAre(ChunkKey{}));
}

TEST(ChunkedModel, LeavesOutAndCountsWhatCannotBeShown) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  ChunkedModel model;
  CloudPoint bad_normal = point_at({0.1f, 0.1f, 0.1f}), bad_confidence = bad_normal;
  bad_normal.normal.y() = kNan;
  bad_confidence.confidence = kInfinity;
  apply_changes(
      model, {set(0, point_at({kNan, 0, 0})), set(1, point_at({0, kInfinity, 0})),
              set(2, point_at({0, 0, 1e30f})), set(3, point_at({-11000, 0, 0})), set(4, bad_normal),
              set(5, bad_confidence), set(6, point_at({10485.8f, 0, 0}))});
  EXPECT_EQ(model.rejected_point_count(), 7u);
  EXPECT_THAT(model.take_dirty(), IsEmpty());
  apply_changes(model, {set(7, point_at({10485.0f, -10485.0f, 0}))});  // just within the key
  EXPECT_EQ(model.rejected_point_count(), 7u);
  const std::vector<ChunkKey> keys = model.take_dirty();
  ASSERT_EQ(keys.size(), 1u);
  EXPECT_EQ(decode(encoded(model, keys[0])).positions_m.size(), 1u);
  // The slot holds nothing that can be shown any more.
  apply_changes(model, {set(7, point_at({kNan, 0, 0}))});
  EXPECT_EQ(model.rejected_point_count(), 8u);
  EXPECT_EQ(model.take_dirty(), keys);
  EXPECT_EQ(encoded(model, keys[0]).point_count, 0u);
}

TEST(ChunkedModel, OddNormalsAndConfidencesAreTakenIntoRange) {
  ChunkedModel model;
  CloudPoint flat = point_at({0.1f, 0.1f, 0.1f}, 1e9f),
             long_normal = point_at({0.2f, 0.1f, 0.1f}, -4);
  flat.normal.setZero();
  long_normal.normal = {0, 0, 1e30f};
  apply_changes(model, {set(0, flat), set(1, long_normal)});
  EXPECT_EQ(model.rejected_point_count(), 0u);
  const Decoded decoded = decode(encoded(model, ChunkKey{}));
  ASSERT_EQ(decoded.confidences.size(), 2u);
  EXPECT_THAT(decoded.confidences, ::testing::UnorderedElementsAre(0, 255));
  const std::size_t upward = decoded.confidences[0] == 0 ? 0 : 1;
  EXPECT_GT(decoded.normals[upward].z(), 0.999f);
}

TEST(ChunkedModel, PointsWithoutNormalsHaveNoneWhenDecoded) {
  ChunkedModel model;
  CloudPoint point = point_at({0.1f, 0.1f, 0.1f});
  point.normal.setZero();
  apply_changes(model, {set(0, point)});
  EXPECT_THAT(decode(encoded(model, ChunkKey{})).normals, IsEmpty());
  apply_changes(model, {set(1, point_at({0.2f, 0.1f, 0.1f}))});
  EXPECT_EQ(decode(encoded(model, ChunkKey{})).normals.size(), 2u);
}

TEST(ChunkedModel, EqualContentGivesEqualBytesWhateverTheWay) {
  const std::vector<SlotChange> changes = random_points(20'000, 0.3f, 2);
  ChunkedModel forward, backward, detour;
  forward.apply(changes);
  const std::vector<ChunkKey> keys = forward.take_dirty();
  std::vector<SlotChange> reversed(changes.rbegin(), changes.rend());
  backward.apply(reversed);
  detour.apply(random_points(25'000, 0.5f, 3));
  std::vector<SlotChange> removals;
  for (std::uint32_t slot = 0; slot < 25'000; slot += 2) removals.push_back(gone(slot));
  for (std::uint32_t slot = 20'001; slot < 25'000; slot += 2) removals.push_back(gone(slot));
  detour.apply(removals);
  detour.apply(changes);
  for (const ChunkKey& key : keys) {
    const EncodedChunk chunk = encoded(forward, key);
    EXPECT_GT(chunk.point_count, 0u);
    EXPECT_EQ(chunk.draco, encoded(backward, key).draco);
    EXPECT_EQ(chunk.draco, encoded(detour, key).draco);
  }
}

TEST(ChunkedModel, AFullChunkHoldsItsLimit) {
  ChunkedModel model;
  std::vector<SlotChange> changes;
  for (std::uint32_t slot = 0; slot < kMaxPointsPerChunk; ++slot) {
    const Eigen::Vector3i voxel(static_cast<int>(slot & 63u), static_cast<int>((slot >> 6) & 63u),
                                static_cast<int>(slot >> 12));
    changes.push_back(
        set(slot, point_at((voxel.cast<float>().array() + 0.5f).matrix() * kVoxelEdge_m)));
  }
  for (std::uint32_t i = 0; i < 1000; ++i)
    changes.push_back(set(kMaxPointsPerChunk + i, changes[i * 7].point));
  model.apply(changes);
  const EncodedChunk chunk = encoded(model, ChunkKey{});
  EXPECT_EQ(chunk.point_count, kMaxPointsPerChunk);
  EXPECT_EQ(decode(chunk).positions_m.size(), kMaxPointsPerChunk);
}

TEST(ChunkedModel, UnknownKeysAreEmpty) {
  const ChunkedModel model;
  EXPECT_EQ(encoded(model, ChunkKey{3, 0, 1, 2, 3}).point_count, 0u);
  EXPECT_EQ(encoded(model, ChunkKey{0, 1, 0, 0, 0}).point_count, 0u);
}

// A textured wall as a scan leaves it: what a frame costs, and how small its chunks are.
TEST(ChunkedModel, IsSmallAndFastOnASurface) {
  std::mt19937 random(4);
  std::normal_distribution<float> noise_m(0, 0.001f);
  std::vector<SlotChange> wall;
  for (std::uint32_t slot = 0; slot < 300'000; ++slot) {
    const float x_m = static_cast<float>(slot % 600) * 0.005f,
                y_m = static_cast<float>(slot / 600) * 0.005f;
    CloudPoint point = point_at({x_m + noise_m(random), y_m + noise_m(random),
                                 2 + 0.2f * std::sin(3 * x_m) + noise_m(random)},
                                8);
    point.normal =
        Eigen::Vector3f(-0.6f * std::cos(3 * x_m), noise_m(random) * 30, -1).normalized();
    const auto grey = static_cast<std::uint8_t>(128 + 60 * std::sin(20 * x_m) * std::cos(17 * y_m) +
                                                static_cast<float>(random() % 6));
    point.color = {grey, grey, static_cast<std::uint8_t>(grey / 2)};
    wall.push_back(set(slot, point));
  }
  const auto seconds_since = [](auto begin) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  };
  ChunkedModel model;
  const auto begin_apply = std::chrono::steady_clock::now();
  model.apply(wall);
  const double apply_s = seconds_since(begin_apply);
  const auto begin_encode = std::chrono::steady_clock::now();
  std::size_t bytes = 0, points = 0;
  for (const ChunkKey& key : model.take_dirty()) {
    const EncodedChunk chunk = encoded(model, key);
    bytes += chunk.draco.size();
    points += chunk.point_count;
  }
  const double encode_s = seconds_since(begin_encode);
  RecordProperty("bits_per_point",
                 std::to_string(8.0 * static_cast<double>(bytes) / static_cast<double>(points)));
  RecordProperty("apply_points_per_s", std::to_string(300'000 / apply_s));
  RecordProperty("encode_points_per_s", std::to_string(static_cast<double>(points) / encode_s));
  EXPECT_LT(8.0 * static_cast<double>(bytes) / static_cast<double>(points), 60.0);  // 128 + 24 raw
}

TEST(Chunks, ACoarserLevelIsTheSameTwiceAsLarge) {
  ChunkedModel fine, coarse(3);
  std::vector<SlotChange> points = random_points(300, 2.0f, 5);
  apply_changes(fine, points);
  for (SlotChange& change : points) change.point.position_m *= 8;
  apply_changes(coarse, points);
  const std::vector<ChunkKey> fine_keys = fine.take_dirty(), coarse_keys = coarse.take_dirty();
  ASSERT_EQ(fine_keys.size(), coarse_keys.size());
  for (std::size_t i = 0; i < fine_keys.size(); ++i) {
    EXPECT_EQ(coarse_keys[i],
              (ChunkKey{fine_keys[i].submap, 3, fine_keys[i].x, fine_keys[i].y, fine_keys[i].z}));
    const Decoded small = decode(encoded(fine, fine_keys[i])),
                  large = decode(encoded(coarse, coarse_keys[i]));
    ASSERT_EQ(small.positions_m.size(), large.positions_m.size());
    for (std::size_t k = 0; k < small.positions_m.size(); ++k)
      EXPECT_LT((8 * small.positions_m[k] - large.positions_m[k]).norm(), 1e-3f);
  }
}

}  // namespace
}  // namespace hermite::output
