#include "server/exports/build_comparison.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/compare/compare_output.h"
#include "core/dataset/trajectory.h"
#include "core/output/ply.h"
#include "core/output/ply_reader.h"
#include "server/exports/export_spec.h"
#include "server/store/file_blobs.h"
#include "server/store/scan_id.h"
#include "tests/core/compare/made_corner.h"
#include "tests/support/temporary_folder.h"

namespace hermite::server {
namespace {

using testing::HasSubstr;

class BuildComparison : public testing::Test {
 protected:
  std::string add(const output::Cloud& cloud) {
    const std::string id = new_scan_id();
    EXPECT_TRUE(blobs_.put(id, "surfels.ply", output::format_ply(cloud)).ok());
    return id;
  }
  Result<output::NamedFiles> build(const std::string& first, const std::string& second,
                                   double stop_at = 2) {
    return build_comparison(
        blobs_, [this] { return free_bytes_; }, {first, second},
        [&](double done) { return done < stop_at; });
  }

  const test::TemporaryFolder folder_;
  FileBlobs blobs_{folder_.path()};
  std::uint64_t free_bytes_ = 0;  // unknown
};

TEST_F(BuildComparison, HasAReportAndThePointsOfBothScans) {
  std::vector<test::MadeBox> boxes = test::usual_boxes();
  boxes[0].low_m.x() += 0.02;
  boxes[0].high_m.x() += 0.02;
  const std::string first = add(test::corner_cloud(test::usual_boxes(), 1)),
                    second = add(test::corner_cloud(boxes, 2));
  ASSERT_TRUE(blobs_.put(second, "trajectory.txt", "0 0 0 0 0 0 0 1\n").ok());
  ASSERT_TRUE(blobs_.put(second, "report.json", R"({"mapping": {"parts": 2}})").ok());
  const Result<output::NamedFiles> files = build(first, second);
  ASSERT_TRUE(files.ok()) << files.error().message;
  ASSERT_EQ(files->size(), 2u);
  EXPECT_EQ(files->at(0).name, comparison_points_file(second));
  EXPECT_EQ(files->at(1).name, comparison_with(second).file());
  const auto report = nlohmann::json::parse(files->at(1).bytes);
  EXPECT_EQ(report["verdict"], "same_place");
  EXPECT_FALSE(report["regions"].empty());
  EXPECT_EQ(report["parts_of_a"], 1);
  EXPECT_EQ(report["parts_of_b"], 2);
  const Result<output::PlyShape> points = output::parse_ply(files->at(0).bytes);
  ASSERT_TRUE(points.ok()) << points.error().message;
  EXPECT_EQ(points->positions.size(), test::corner_cloud(test::usual_boxes(), 1).size() +
                                          test::corner_cloud(boxes, 2).size());
  EXPECT_THAT(files->at(0).bytes,
              HasSubstr("property uchar state\nproperty uchar scan\nproperty int region\n"));
  EXPECT_EQ(build(first, second)->at(0).bytes, files->at(0).bytes) << "the same bytes";
}

TEST_F(BuildComparison, OfDifferentPlacesThereAreNoPoints) {
  const std::string first = add(test::corner_cloud(test::usual_boxes(), 1));
  output::Cloud ball;
  for (int i = 0; i < 4000; ++i) {
    const double turn = 2.39996 * i, z = 1 - 2 * (i + 0.5) / 4000, r = std::sqrt(1 - z * z);
    output::CloudPoint point;
    point.normal = Eigen::Vector3d(r * std::cos(turn), r * std::sin(turn), z).cast<float>();
    point.position_m = 0.4f * point.normal;
    ball.push_back(point);
  }
  const Result<output::NamedFiles> files = build(first, add(ball));
  ASSERT_TRUE(files.ok()) << files.error().message;
  ASSERT_EQ(files->size(), 1u);
  EXPECT_NE(nlohmann::json::parse(files->at(0).bytes)["verdict"], "same_place");
}

TEST_F(BuildComparison, SaysWhatCannotBeCompared) {
  const output::Cloud corner = test::corner_cloud(test::usual_boxes(), 1);
  const std::string good = add(corner), none = new_scan_id(), one = add({corner.front()}),
                    empty = add({});
  output::Cloud flat = corner;
  for (output::CloudPoint& point : flat) point.normal.setZero();
  const auto message_of = [&](const std::string& first, const std::string& second) {
    const Result<output::NamedFiles> files = build(first, second);
    return files.ok() ? std::string("compared") : files.error().message;
  };
  EXPECT_THAT(message_of(good, none), HasSubstr("scan " + none + " has no points"));
  EXPECT_THAT(message_of(good, one), HasSubstr("the second scan"));
  EXPECT_THAT(message_of(one, good), HasSubstr("the first scan"));
  EXPECT_THAT(message_of(good, empty), HasSubstr("the second scan has no points"));
  EXPECT_THAT(message_of(add(flat), good), HasSubstr("the first scan"));
  free_bytes_ = 1000;
  EXPECT_THAT(message_of(good, good),
              HasSubstr("MiB left: it can be asked for again when there is more"));
}

TEST_F(BuildComparison, StopsWhenNobodyWantsIt) {
  const std::string first = add(test::corner_cloud(test::usual_boxes(), 1)),
                    second = add(test::corner_cloud(test::usual_boxes(), 2));
  for (const double stop_at : {0.0, 0.05, 0.2, 0.7, 1.0}) {
    const Result<output::NamedFiles> files = build(first, second, stop_at);
    ASSERT_FALSE(files.ok()) << stop_at;
    EXPECT_EQ(files.error().code, ErrorCode::kBusy) << stop_at << ": " << files.error().message;
  }
}

}  // namespace
}  // namespace hermite::server
