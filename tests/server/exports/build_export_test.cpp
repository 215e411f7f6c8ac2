// Exports made of real clouds. Who asks for them and when they are made: exports_test.cpp.
#include "server/exports/build_export.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "core/output/ply.h"
#include "core/output/ply_reader.h"
#include "server/store/file_blobs.h"
#include "server/store/scan_id.h"
#include "tests/support/plane_cloud.h"
#include "tests/support/temporary_folder.h"

namespace hermite {
namespace {

using testing::HasSubstr;

class BuildExport : public testing::Test {
 protected:
  void put(const Cloud& cloud) { ASSERT_TRUE(blobs_.put(scan_, "cloud.ply", format_ply(cloud)).ok()); }
  Result<std::string> build(const std::string& name) {
    calls_ = 0;
    return builder_.build(*find_export_offer(name), scan_, [this](double) { return ++calls_ != stop_at_; });
  }
  std::size_t triangles_of(const Result<std::string>& ply) { return ply.ok() ? parse_ply(*ply)->triangles.size() : 0; }

  const test::TemporaryFolder folder_;
  FileBlobs blobs_{folder_.path()};
  ExportBuilder builder_{blobs_};
  const std::string scan_ = new_scan_id();
  int calls_ = 0, stop_at_ = 0;
};

TEST_F(BuildExport, EveryFormatOfTheTableIsMadeOrIsAResult) {
  put(test::plane_cloud(30));
  ASSERT_TRUE(blobs_.put(scan_, "trajectory.txt", "0.0 0 0 0 0 0 0 1\n0.1 0.5 0 0 0 0 0 1\n").ok());
  for (const ExportOffer& format : export_offers()) {
    EXPECT_TRUE(is_blob_name(format.file)) << format.name;
    EXPECT_EQ(find_export_offer(format.name), &format) << "names are there once";
    if (format.is_result) continue;
    const Result<std::string> bytes = build(std::string(format.name));
    ASSERT_TRUE(bytes.ok()) << format.name << ": " << bytes.error().message;
    EXPECT_FALSE(bytes->empty()) << format.name;
    EXPECT_EQ(*build(std::string(format.name)), *bytes) << format.name << ": the same cloud gives the same bytes";
  }
  EXPECT_EQ(find_export_offer("fbx"), nullptr);
  ASSERT_NE(find_export_offer(kViewerMesh), nullptr);
}

TEST_F(BuildExport, TheMeshIsKeptForTheNextFormatUntilTheCloudIsAnother) {
  put(test::plane_cloud(30));
  const std::size_t small = triangles_of(build("ply"));
  EXPECT_GT(small, 100u);
  EXPECT_GT(calls_, 2);
  EXPECT_EQ(triangles_of(build("ply")), small);
  EXPECT_EQ(calls_, 2) << "nothing was contoured";
  put(test::plane_cloud(60));
  EXPECT_GT(triangles_of(build("ply")), small);
  builder_.forget();
  EXPECT_GT(triangles_of(build("ply")), small);
  EXPECT_GT(calls_, 2);
}

TEST_F(BuildExport, AMeshIsOfTheSurfelsWhereThereAreSome) {
  put(test::plane_cloud(30));
  const std::size_t of_cloud = triangles_of(build("ply"));
  ASSERT_TRUE(blobs_.put(scan_, "surfels.ply", format_ply(test::plane_cloud(60))).ok());
  EXPECT_GT(triangles_of(build("ply")), 2 * of_cloud);
}

TEST_F(BuildExport, SaysWhatACloudLacks) {
  EXPECT_EQ(build("ply").error().code, ErrorCode::kNotFound);
  put({});
  EXPECT_EQ(build("ply").error().code, ErrorCode::kInvalidArgument);
  EXPECT_THAT(build("ply").error().message, HasSubstr("no points"));
  put(test::plane_cloud(1));
  EXPECT_THAT(build("ply").error().message, HasSubstr("too few"));
  Cloud nowhere = test::plane_cloud(3);
  for (CloudPoint& point : nowhere) point.position_m.x() = std::numeric_limits<float>::quiet_NaN();
  put(nowhere);
  EXPECT_EQ(build("ply").error().code, ErrorCode::kInvalidArgument);
  ASSERT_TRUE(blobs_.put(scan_, "cloud.ply", "ply points").ok());
  EXPECT_EQ(build("ply").error().code, ErrorCode::kCorruptData);
  EXPECT_THAT(build("ply").error().message, HasSubstr("cloud.ply"));
}

TEST_F(BuildExport, APathNeedsNoPoints) {
  put({});
  EXPECT_EQ(build("kitti").error().code, ErrorCode::kNotFound);
  ASSERT_TRUE(blobs_.put(scan_, "trajectory.txt", "0.0 1 2 3 0 0 0 1\n0.1 4 5 6 0 0 0 1\n").ok());
  EXPECT_THAT(*build("kitti"), HasSubstr("4.000000000"));
  EXPECT_THAT(*build("log"), HasSubstr("1 1 2"));
  ASSERT_TRUE(blobs_.put(scan_, "trajectory.txt", "not a path").ok());
  EXPECT_THAT(build("kitti").error().message, HasSubstr("trajectory.txt"));
}

TEST_F(BuildExport, StopsWhereverItIsTold) {
  put(test::plane_cloud(30));
  ASSERT_TRUE(build("ply").ok());
  for (const int last = calls_; stop_at_ < last;) {
    builder_.forget();
    ++stop_at_;
    EXPECT_EQ(build("ply").error().code, ErrorCode::kBusy) << stop_at_ << " of " << last;
  }
}

}  // namespace
}  // namespace hermite
