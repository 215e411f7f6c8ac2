#include "server/jobs/import_results.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/output/glb.h"
#include "core/output/mesh_ply.h"
#include "core/output/ply.h"
#include "core/output/ply_reader.h"
#include "tests/support/analytic_mesh.h"
#include "tests/support/plane_cloud.h"

namespace hermite::server {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

bool always() { return true; }

std::vector<std::string> names_of(const ImportResults& results) {
  std::vector<std::string> names;
  for (const output::NamedFile& file : results.files) names.push_back(file.name);
  return names;
}

TEST(ImportResults, OfACloudAreThoseOfAScanWithoutAPath) {
  const output::Cloud cloud = test::plane_cloud(20);
  const auto results = results_of_import(output::format_ply(cloud), {}, always);
  ASSERT_TRUE(results.ok()) << results.error().message;
  EXPECT_THAT(names_of(*results),
              ElementsAre("report.json", "cloud.ply", "chunks.bin", "thumbnail.jpg"));
  EXPECT_TRUE(results->may_be_meshed);
  EXPECT_EQ(output::parse_ply(results->files[1].bytes)->positions.size(), cloud.size());
  const auto report = nlohmann::json::parse(results->files[0].bytes);
  EXPECT_EQ(report["import"]["points"], cloud.size());
  EXPECT_EQ(report["import"]["up"], "-y");
  std::size_t shown = 0;
  const auto chunk_file = parse_chunk_file(results->files[2].bytes);
  ASSERT_TRUE(chunk_file.ok());
  for (const output::EncodedChunk& chunk : chunk_file->chunks) shown += chunk.point_count;
  EXPECT_GT(shown, cloud.size() / 4);
}

TEST(ImportResults, AGlbIsKeptAsItIsUnlessItHasToBeAnother) {
  const std::string glb =
      *output::format_mesh_glb(test::textured_plane(4, 2, 16), output::GlbCompression::kDraco);
  const auto results = results_of_import(glb, {}, always);
  ASSERT_TRUE(results.ok()) << results.error().message;
  EXPECT_THAT(names_of(*results),
              ElementsAre("report.json", "imported.glb", "chunks.bin", "thumbnail.jpg"));
  EXPECT_EQ(results->files[1].bytes, glb);
  EXPECT_FALSE(results->may_be_meshed);
  const auto small = results_of_import(glb, {0.5, {}}, always);
  ASSERT_TRUE(small.ok()) << small.error().message;
  const auto model = imports::read_model(small->files[1].bytes, {});
  EXPECT_NEAR(model->high_m.x(), 0.5f, 1e-3f);
  EXPECT_EQ(model->mesh.pages.size(), 2u);
  EXPECT_EQ(results_of_import(output::format_mesh_ply(test::sphere_mesh(4, 6)), {}, always)
                ->files[1]
                .name,
            "imported.glb");
}

TEST(ImportResults, CanBeStopped) {
  EXPECT_EQ(results_of_import(output::format_ply(test::plane_cloud(5)), {}, [] { return false; })
                .error()
                .code,
            ErrorCode::kBusy);
}

TEST(ImportResults, WhatIsLargeIsShownCoarser) {
  output::Cloud cloud;
  for (int i = 0; i < 30'000; ++i) {
    output::CloudPoint point;
    // A metre apart: a chunk each, at the finest level.
    point.position_m = {static_cast<float>(i % 200), 0, static_cast<float>(i / 200)};
    cloud.push_back(point);
  }
  const auto chunks = chunks_of_points(cloud);
  ASSERT_TRUE(chunks.ok());
  EXPECT_LE(chunks->chunks.size(), 2000u) << "fewer than points by far";
  std::size_t shown = 0;
  for (const output::EncodedChunk& chunk : chunks->chunks) {
    EXPECT_GT(chunk.key.level, 0);
    shown += chunk.point_count;
  }
  EXPECT_EQ(shown, cloud.size()) << "voxels are still smaller than the distance of the points";
}

}  // namespace
}  // namespace hermite::server
