// Exports made of real clouds. Who asks for them and when they are made: exports_test.cpp.
#include "server/exports/build_export.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <atomic>
#include <limits>

#include "core/output/glb.h"
#include "core/output/ply.h"
#include "core/output/ply_reader.h"
#include "core/source/open_sequence.h"
#include "server/store/file_blobs.h"
#include "server/store/scan_id.h"
#include "tests/support/analytic_mesh.h"
#include "tests/support/plane_cloud.h"
#include "tests/support/room_cloud.h"
#include "tests/support/temporary_folder.h"

namespace hermite::server {
namespace {

using testing::HasSubstr;
using testing::Not;

class BuildExport : public testing::Test {
 protected:
  void put(const output::Cloud& cloud) {
    ASSERT_TRUE(blobs_.put(scan_, "cloud.ply", output::format_ply(cloud)).ok());
  }
  Result<std::string> build(const std::string& name) {
    calls_ = 0;
    const Result<output::NamedFiles> files = builder_.build(
        *export_spec_named(name), scan_, [this](double) { return ++calls_ != stop_at_; });
    if (!files.ok()) return files.error();
    EXPECT_EQ(files->size(), name == "glb-draco" ? 2u : 1u)
        << "the mesh of the viewer has a thumbnail with it";
    EXPECT_EQ(files->back().name, export_spec_named(name)->file());
    return files->back().bytes;
  }
  std::size_t triangles_of(const Result<std::string>& ply) {
    return ply.ok() ? output::parse_ply(*ply)->triangles.size() : 0;
  }

  const test::TemporaryFolder folder_;
  FileBlobs blobs_{folder_.path()};
  std::string frames_;  // a sequence; empty: they were removed
  ExportBuilder builder_{blobs_,
                         [this](const std::string&) -> Result<std::unique_ptr<dataset::Sequence>> {
                           if (frames_.empty())
                             return Error{ErrorCode::kNotFound, "its frames were removed"};
                           return source::open_sequence(frames_);
                         }};
  const std::string scan_ = new_scan_id();
  std::atomic<int> calls_ = 0;  // of several threads, while texture is made
  int stop_at_ = 0;
};

TEST_F(BuildExport, EveryFormatOfTheTableIsMadeOrIsAResult) {
  put(test::plane_cloud(30));
  ASSERT_TRUE(blobs_.put(scan_, "trajectory.txt", "0.0 0 0 0 0 0 0 1\n0.1 0.5 0 0 0 0 0 1\n").ok());
  for (const ExportOffer& format : export_offers()) {
    EXPECT_TRUE(is_blob_name(format.file)) << format.name;
    EXPECT_EQ(find_export_offer(format.name), &format) << "names are there once";
    // Plans need more than a plane: below.
    if (format.is_result || format.kind == ExportKind::kPlan) continue;
    const Result<std::string> bytes = build(std::string(format.name));
    ASSERT_TRUE(bytes.ok()) << format.name << ": " << bytes.error().message;
    EXPECT_FALSE(bytes->empty()) << format.name;
    EXPECT_EQ(*build(std::string(format.name)), *bytes)
        << format.name << ": the same cloud gives the same bytes";
  }
  EXPECT_EQ(find_export_offer("fbx"), nullptr);
  ASSERT_NE(find_export_offer(kViewerMesh), nullptr);
}

TEST_F(BuildExport, AFloorPlanIsOfWhatTheEditsLeave) {
  test::RoomCloud room;
  room.room({0, 2}, {0, 1.5}, 2.2);
  put(room.cloud());
  Result<std::string> json = build("plan-json");
  ASSERT_TRUE(json.ok()) << json.error().message;
  EXPECT_NE(json->find("\"area_half_width_m2\": null"), std::string::npos)
      << "without a trajectory nothing is known of its error";
  EXPECT_NE(json->find("\"words\": \"3.0"), std::string::npos) << *json;
  for (const char* name : {"plan-svg", "plan-dxf"}) EXPECT_TRUE(build(name).ok()) << name;
  ASSERT_TRUE(blobs_.put(scan_, "trajectory.txt", "0.0 0 0 0 0 0 0\n").ok());
  json = build("plan-json");
  ASSERT_FALSE(json.ok()) << "a damaged one is no missing one";
  EXPECT_EQ(json.error().code, ErrorCode::kCorruptData);
  ASSERT_TRUE(blobs_.put(scan_, "trajectory.txt", "0.0 0 0 0 0 0 0 1\n").ok());
  put(test::plane_cloud(100));
  json = build("plan-json");
  ASSERT_FALSE(json.ok());
  EXPECT_EQ(json.error().code, ErrorCode::kInvalidArgument);
  EXPECT_NE(json.error().message.find("no floor"), std::string::npos) << json.error().message;
}

TEST_F(BuildExport, AnImportedMeshIsWhatItIs) {
  ASSERT_TRUE(blobs_
                  .put(scan_, std::string(kImportedMeshFile),
                       *output::format_mesh_glb(test::textured_plane(4, 2, 16),
                                                output::GlbCompression::kNone))
                  .ok());
  EXPECT_EQ(triangles_of(build("ply")), 8u);
  const Result<std::string> draco = build("glb-draco");
  ASSERT_TRUE(draco.ok()) << draco.error().message;
  EXPECT_NE(draco->find("image/jpeg"), std::string::npos) << "with its texture";
  EXPECT_THAT(build("ply_s1000").error().message, HasSubstr("simplified before it is textured"));
  EXPECT_THAT(build("stl_c").error().message, HasSubstr("filled before a mesh is textured"));
  EXPECT_EQ(triangles_of(build("ply")), 8u);
}

TEST_F(BuildExport, AnImportedMeshWithoutATextureIsFinishedAsAsked) {
  output::TriangleMesh open = test::sphere_mesh(8, 12);
  open.triangles.resize(open.triangles.size() - 20);
  ASSERT_TRUE(blobs_
                  .put(scan_, std::string(kImportedMeshFile),
                       *output::format_mesh_glb(open, output::GlbCompression::kNone))
                  .ok());
  const std::size_t plain = triangles_of(build("ply"));
  EXPECT_GT(triangles_of(build("ply_c")), plain);
  EXPECT_LT(triangles_of(build("ply_s100000")), plain);
}

TEST_F(BuildExport, PointsWithoutNormalsHaveNoSurface) {
  output::Cloud cloud = test::plane_cloud(30);
  for (output::CloudPoint& point : cloud) point.normal.setZero();
  put(cloud);
  EXPECT_THAT(build("ply").error().message, testing::HasSubstr("no normals"));
}

TEST_F(BuildExport, TheMeshIsKeptForTheNextFormatUntilTheCloudIsAnother) {
  put(test::plane_cloud(30));
  const std::size_t small = triangles_of(build("ply"));
  EXPECT_GT(small, 100u);
  EXPECT_GT(calls_, 2);
  EXPECT_EQ(triangles_of(build("ply")), small);
  EXPECT_EQ(calls_, 3) << "nothing was contoured";
  put(test::plane_cloud(60));
  EXPECT_GT(triangles_of(build("ply")), small);
  builder_.forget();
  EXPECT_GT(triangles_of(build("ply")), small);
  EXPECT_GT(calls_, 2);
}

TEST_F(BuildExport, AMeshIsFinishedAsAskedAndTheNextAsItIs) {
  output::Cloud cloud = test::plane_cloud(30);
  put(cloud);
  const std::size_t plain = triangles_of(build("ply"));
  EXPECT_LT(2 * triangles_of(build("ply_s1000")), plain);
  EXPECT_GT(triangles_of(build("ply_c")), plain);
  EXPECT_THAT(*build("ply_c"), HasSubstr("property uchar filled"));
  EXPECT_EQ(triangles_of(build("ply")), plain);
  EXPECT_THAT(*build("glb_c"), HasSubstr("\"name\":\"filled\""));
}

TEST_F(BuildExport, WhatMemoryDoesNotSufficeForIsNotBegun) {
  put(test::plane_cloud(30));
  ExportBuilder small(
      blobs_,
      [](const std::string&) -> Result<std::unique_ptr<dataset::Sequence>> {
        return Error{ErrorCode::kNotFound, "none"};
      },
      [] { return std::uint64_t{1000}; });
  const Result<output::NamedFiles> built =
      small.build(*export_spec_named("ply"), scan_, [](double) { return true; });
  EXPECT_EQ(built.error().code, ErrorCode::kTooLarge);
  EXPECT_THAT(built.error().message, HasSubstr("this machine has"));
  EXPECT_GT(free_memory_bytes(), std::uint64_t{1} << 20);
}

TEST_F(BuildExport, AMeshIsOfTheSurfelsWhereThereAreSome) {
  put(test::plane_cloud(30));
  const std::size_t of_cloud = triangles_of(build("ply"));
  ASSERT_TRUE(blobs_.put(scan_, "surfels.ply", output::format_ply(test::plane_cloud(60))).ok());
  EXPECT_GT(triangles_of(build("ply")), 2 * of_cloud);
}

// What the first frame of a sequence has seen, in the world of its true poses.
output::Cloud cloud_of_first_frame(const dataset::Sequence& sequence) {
  const frame::RgbdFrame frame = *dataset::decode_frame(*sequence.read(0));
  const Camera& camera = sequence.camera();
  const Rigid3 pose = sequence.groundtruth().front().world_from_camera;
  const auto point_at = [&](int x, int y) {
    return camera.unproject(
        x, y, static_cast<double>(frame.depth.at(x, y)) / camera.depth_units_per_metre);
  };
  output::Cloud cloud;
  for (int y = 0; y + 1 < frame.depth.height; ++y)
    for (int x = 0; x + 1 < frame.depth.width; ++x) {
      const Eigen::Vector3d at = point_at(x, y);
      const Eigen::Vector3d normal =
          (point_at(x, y + 1) - at).cross(point_at(x + 1, y) - at).normalized();
      if (!(at.z() > 0) || !normal.allFinite()) continue;
      output::CloudPoint point;
      point.position_m = (pose * at).cast<float>();
      point.normal = (pose.rotation * normal).cast<float>();
      point.confidence = 5;
      cloud.push_back(point);
    }
  return cloud;
}

TEST_F(BuildExport, AMeshHasATextureWhileTheScanHasItsFrames) {
  const std::string source = "synthetic:frames=3,width=160,height=120";
  const std::unique_ptr<dataset::Sequence> sequence = *source::open_sequence(source);
  put(cloud_of_first_frame(*sequence));
  ASSERT_TRUE(
      blobs_.put(scan_, "trajectory.txt", dataset::format_tum_trajectory(sequence->groundtruth()))
          .ok());
  ASSERT_TRUE(blobs_.put(scan_, "report.json", "{}").ok());
  const std::string without = *build("glb");
  EXPECT_THAT(without, HasSubstr("COLOR_0"));
  EXPECT_THAT(without, Not(HasSubstr("image/jpeg")));
  const std::size_t triangles = triangles_of(build("ply"));
  frames_ = source;
  EXPECT_THAT(*build("glb"), HasSubstr("image/jpeg"));
  EXPECT_THAT(*build("glb-draco"), HasSubstr("image/jpeg"));
  EXPECT_EQ(triangles_of(build("ply")), triangles)
      << "no vertices of charts in a file without a texture";
  builder_.forget();
  ASSERT_TRUE(blobs_.put(scan_, "report.json", R"({"corrected_camera": {"width": 1}})").ok());
  EXPECT_THAT(*build("glb"), HasSubstr("COLOR_0")) << "a camera that is none";
  ASSERT_TRUE(blobs_.put(scan_, "report.json", "{}").ok());
  builder_.forget();
  ASSERT_TRUE(build("ply").ok());
  stop_at_ = 4;
  EXPECT_EQ(build("glb").error().code, ErrorCode::kBusy) << "while it is textured";
}

TEST_F(BuildExport, SaysWhatACloudLacks) {
  EXPECT_EQ(build("ply").error().code, ErrorCode::kNotFound);
  put({});
  EXPECT_EQ(build("ply").error().code, ErrorCode::kInvalidArgument);
  EXPECT_THAT(build("ply").error().message, HasSubstr("no points"));
  put(test::plane_cloud(1));
  EXPECT_THAT(build("ply").error().message, HasSubstr("too few"));
  output::Cloud nowhere = test::plane_cloud(3);
  for (output::CloudPoint& point : nowhere)
    point.position_m.x() = std::numeric_limits<float>::quiet_NaN();
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
}  // namespace hermite::server
