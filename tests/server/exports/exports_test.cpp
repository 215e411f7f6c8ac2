// Who gets what, and when; what is left when something goes wrong. Real clouds and files; the
// threads are in the test's hands.
#include "server/exports/exports.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "core/output/glb.h"
#include "core/output/ply.h"
#include "core/output/ply_reader.h"
#include "tests/support/analytic_mesh.h"
#include "tests/support/exports_fixture.h"
#include "tests/support/plane_cloud.h"

namespace hermite::server {
namespace {

using testing::HasSubstr;

class ExportsTest : public test::ExportsFixture {
 protected:
  std::string add_scan(const output::Cloud& cloud = test::plane_cloud(30),
                       ScanPhase phase = ScanPhase::kFinished) {
    return add_scan_with("cloud.ply", output::format_ply(cloud), phase);
  }
  Status ask(const std::string& scan, const std::string& format,
             const std::string& token = "somebody", bool admin = false) {
    return exports_->request({scan, format, token, admin});
  }
  ExportState state(const std::string& scan, const std::string& format) {
    return *exports_->state(scan, format);
  }
};

TEST_F(ExportsTest, WhatIsAskedForIsMadeAndStaysOverARestart) {
  const std::string scan = add_scan();
  EXPECT_EQ(state(scan, "ply").phase, ExportPhase::kMissing);
  ASSERT_TRUE(ask(scan, "ply").ok());
  EXPECT_EQ(state(scan, "ply").phase, ExportPhase::kRunning);
  make_one();
  EXPECT_GT(state(scan, "ply").done, 0.5);
  settle();
  const ExportState ready = state(scan, "ply");
  EXPECT_EQ(ready.phase, ExportPhase::kReady);
  const std::string bytes = *read_blob(blobs_, scan, "mesh.ply", 1 << 24);
  EXPECT_EQ(ready.size_bytes, bytes.size());
  EXPECT_GT(output::parse_ply(bytes)->triangles.size(), 100u);
  EXPECT_EQ(stored_count_, 1);
  start();
  EXPECT_EQ(state(scan, "ply").phase, ExportPhase::kReady);
}

TEST_F(ExportsTest, TheSameTwiceIsMadeOnce) {
  const std::string scan = add_scan();
  ASSERT_TRUE(ask(scan, "ply").ok());
  ASSERT_TRUE(ask(scan, "ply").ok());
  EXPECT_EQ(exports_->waiting_count(), 0u);
  settle();
  const std::string version = *blobs_.version(scan, "mesh.ply");
  ASSERT_TRUE(ask(scan, "ply").ok());
  settle();
  EXPECT_EQ(*blobs_.version(scan, "mesh.ply"), version);
  EXPECT_EQ(stored_count_, 1);
}

TEST_F(ExportsTest, ListsWhatTheScanHasOrHasSomethingToMakeOf) {
  const auto names = [this](const std::string& scan) {
    std::vector<std::string_view> all;
    const auto states = exports_->list(scan);  // it must live as long as the loop
    for (const ExportState& one : *states) all.push_back(one.format->name);
    return all;
  };
  using testing::ElementsAre;
  const std::string scan = add_scan();
  EXPECT_THAT(names(scan),
              ElementsAre("glb", "glb-draco", "obj", "ply", "stl", "cloud", "las", "points-glb",
                          "splats", "plan-svg", "plan-dxf", "plan-json"));
  const auto states = exports_->list(scan);
  for (const ExportState& one : *states)
    EXPECT_EQ(one.phase,
              one.format->file == "cloud.ply" ? ExportPhase::kReady : ExportPhase::kMissing)
        << one.format->name;
  ASSERT_TRUE(blobs_.put(scan, "trajectory.txt", "0 0 0 0 0 0 0 1\n").ok());
  EXPECT_EQ(names(scan).size(), export_offers().size() - 2)
      << "it was not imported, and not edited";
}

TEST_F(ExportsTest, OfAnImportedMeshThereAreMeshes) {
  const std::string scan = add_scan();
  ASSERT_TRUE(blobs_.remove(scan, "cloud.ply").ok());
  ASSERT_TRUE(
      blobs_
          .put(scan, "imported.glb",
               *output::format_mesh_glb(test::sphere_mesh(4, 6), output::GlbCompression::kNone))
          .ok());
  EXPECT_EQ(exports_->list(scan)->size(), 6u);
  EXPECT_EQ(state(scan, "imported").phase, ExportPhase::kReady);
  EXPECT_EQ(exports_->remove(scan, "imported").error().code, ErrorCode::kInvalidArgument);
  ASSERT_TRUE(ask(scan, "ply").ok());
  settle();
  EXPECT_EQ(output::parse_ply(*read_blob(blobs_, scan, "mesh.ply", 1 << 24))->triangles.size(),
            test::sphere_mesh(4, 6).triangles.size());
  EXPECT_EQ(ask(scan, "las").error().code, ErrorCode::kNotFound);
}

TEST_F(ExportsTest, OnesWithOptionsAreListedBehindTheFormatsStayAndAreBounded) {
  const std::string scan = add_scan();
  ASSERT_TRUE(ask(scan, "ply_s1000").ok());
  settle();
  EXPECT_EQ(state(scan, "ply_s1000").phase, ExportPhase::kReady);
  EXPECT_EQ(state(scan, "ply").phase, ExportPhase::kMissing);
  EXPECT_THAT(files(scan), testing::ElementsAre("cloud.ply", "mesh_s1000.ply"));
  start();
  const std::vector<ExportState> states = *exports_->list(scan);
  ASSERT_EQ(states.size(), 13u);
  EXPECT_EQ(states.back().shape.simplify_um, 1000);
  EXPECT_EQ(states.back().phase, ExportPhase::kReady);
  for (std::size_t i = 1; i < kMaxShapedExports; ++i) {
    ASSERT_TRUE(ask(scan, "ply_f" + std::to_string(i), "token" + std::to_string(i % 4)).ok()) << i;
  }
  EXPECT_THAT(ask(scan, "ply_c").error().message, HasSubstr("exports with options, of at most 16"));
  EXPECT_TRUE(ask(scan, "ply_s1000").ok());
  EXPECT_TRUE(ask(scan, "ply").ok());
  ASSERT_TRUE(exports_->remove(scan, "ply_s1000").ok());
  EXPECT_TRUE(ask(scan, "ply_c").ok());
}

TEST_F(ExportsTest, WhatCannotBeIsSaidInAMessage) {
  const std::string scan = add_scan(), empty = add_scan({}),
                    running = add_scan(test::plane_cloud(3), ScanPhase::kRunning);
  EXPECT_EQ(ask(new_scan_id(), "ply").error().code, ErrorCode::kNotFound);
  EXPECT_THAT(ask(scan, "fbx").error().message, HasSubstr("there is no format 'fbx'; known are "));
  EXPECT_EQ(ask(running, "ply").error().code, ErrorCode::kBusy);
  EXPECT_THAT(ask(running, "ply").error().message, HasSubstr("is running"));
  EXPECT_EQ(exports_->list(running).error().code, ErrorCode::kBusy);
  EXPECT_EQ(ask(empty, "ply").error().code, ErrorCode::kInvalidArgument);
  EXPECT_THAT(ask(empty, "ply").error().message, HasSubstr("no points"));
  ASSERT_TRUE(blobs_.remove(scan, "cloud.ply").ok());
  EXPECT_EQ(ask(scan, "ply").error().code, ErrorCode::kNotFound);
  EXPECT_EQ(ask(scan, "cloud").error().code, ErrorCode::kNotFound) << "it is not made of anything";
  EXPECT_EQ(exports_->remove(scan, "ply").error().code, ErrorCode::kNotFound);
  EXPECT_EQ(exports_->remove(empty, "cloud").error().code, ErrorCode::kInvalidArgument)
      << "a result is no export";
  EXPECT_TRUE(making_.empty());
}

TEST_F(ExportsTest, OneThatHasFailedSaysWhyAndMayBeAskedForAgain) {
  const std::string scan = add_scan();
  ASSERT_TRUE(blobs_.put(scan, "cloud.ply", "ply points").ok());
  ASSERT_TRUE(ask(scan, "ply").ok());
  settle();
  EXPECT_EQ(state(scan, "ply").phase, ExportPhase::kFailed);
  EXPECT_THAT(state(scan, "ply").message, HasSubstr("cloud.ply"));
  EXPECT_THAT(files(scan), testing::ElementsAre("cloud.ply"));
  ASSERT_TRUE(blobs_.put(scan, "cloud.ply", output::format_ply(test::plane_cloud(30))).ok());
  ASSERT_TRUE(ask(scan, "ply").ok());
  settle();
  EXPECT_EQ(state(scan, "ply").phase, ExportPhase::kReady);
}

TEST_F(ExportsTest, OneThatIsStoppedOrRemovedLeavesNothing) {
  const std::string scan = add_scan();
  ASSERT_TRUE(ask(scan, "ply").ok());
  ASSERT_TRUE(exports_->remove(scan, "ply").ok());
  EXPECT_EQ(state(scan, "ply").phase, ExportPhase::kMissing);
  EXPECT_EQ(ask(scan, "ply").error().code, ErrorCode::kBusy)
      << "its thread has not heard of it yet";
  settle();
  EXPECT_THAT(files(scan), testing::ElementsAre("cloud.ply"));

  ASSERT_TRUE(ask(scan, "ply").ok());
  make_one();
  hear();  // its bytes are to be written
  ASSERT_TRUE(exports_->remove(scan, "ply").ok());
  settle();
  EXPECT_THAT(files(scan), testing::ElementsAre("cloud.ply"));

  ASSERT_TRUE(ask(scan, "ply").ok());
  settle();
  ASSERT_TRUE(exports_->remove(scan, "ply").ok());
  EXPECT_THAT(files(scan), testing::ElementsAre("cloud.ply"));
  EXPECT_EQ(state(scan, "ply").phase, ExportPhase::kMissing);
}

TEST_F(ExportsTest, AScanThatIsRemovedMeanwhileDoesNotComeBack) {
  const std::string scan = add_scan(), other = add_scan();
  ASSERT_TRUE(ask(scan, "ply").ok());
  ASSERT_TRUE(ask(scan, "glb").ok());
  remove_scan(scan);
  settle();
  EXPECT_TRUE(files(scan).empty());
  EXPECT_EQ(exports_->waiting_count(), 0u);

  ASSERT_TRUE(ask(other, "ply").ok());
  make_one();
  hear();
  remove_scan(other);
  make_one();  // writes, and makes the folder again
  EXPECT_FALSE(files(other).empty());
  settle();
  EXPECT_TRUE(files(other).empty());
}

TEST_F(ExportsTest, OfAScanThatIsMadeAnewNothingOldIsKept) {
  const std::string scan = add_scan();
  ASSERT_TRUE(ask(scan, "ply").ok());
  make_one();
  rows_[scan].finished_at_ms += 1;
  settle();
  EXPECT_THAT(files(scan), testing::ElementsAre("cloud.ply"));
}

TEST_F(ExportsTest, ADiskWithoutRoomIsWaitedFor) {
  const std::string scan = add_scan();
  room_ = 10;
  ASSERT_TRUE(ask(scan, "ply").ok());
  settle();
  EXPECT_EQ(state(scan, "ply").phase, ExportPhase::kQueued);
  EXPECT_THAT(state(scan, "ply").message,
              HasSubstr("no room; it is tried again when there is room"));
  room_ = *blobs_.size_bytes(scan, "cloud.ply");  // for that, and not for the mesh
  now_ += std::chrono::seconds(6);
  settle();
  EXPECT_EQ(state(scan, "ply").phase, ExportPhase::kQueued);
  EXPECT_THAT(files(scan), testing::ElementsAre("cloud.ply"));
  room_ = 1'000'000'000;
  settle();
  EXPECT_EQ(state(scan, "ply").phase, ExportPhase::kQueued) << "not at once: twice as long";
  now_ += std::chrono::seconds(11);
  settle();
  EXPECT_EQ(state(scan, "ply").phase, ExportPhase::kReady);
}

TEST_F(ExportsTest, ADiskThatTakesNothingIsWaitedForAndOthersGoOn) {
  const std::string scan = add_scan(), other = add_scan();
  std::filesystem::create_directory(folder_ / scan + "/mesh.ply");  // nothing can be put there
  ASSERT_TRUE(ask(scan, "ply").ok());
  ASSERT_TRUE(ask(other, "ply").ok());
  settle();
  EXPECT_EQ(state(scan, "ply").phase, ExportPhase::kQueued);
  EXPECT_THAT(files(scan), testing::ElementsAre("cloud.ply", "mesh.ply")) << "nothing unfinished";
  EXPECT_EQ(state(other, "ply").phase, ExportPhase::kReady);
  std::filesystem::remove(folder_ / scan + "/mesh.ply");
  now_ += std::chrono::seconds(6);
  settle();
  EXPECT_EQ(state(scan, "ply").phase, ExportPhase::kReady);
}

TEST_F(ExportsTest, TokensTakeTurnsAndMeshesThatNobodyAskedForComeLast) {
  const std::string scan = add_scan(), finished = add_scan(), first = add_scan(),
                    second = add_scan();
  ASSERT_TRUE(ask(scan, "ply", "greedy").ok());  // begins at once
  exports_->make_mesh(rows_[finished]);
  ASSERT_TRUE(ask(first, "ply", "greedy").ok());
  ASSERT_TRUE(ask(second, "ply", "other").ok());
  std::vector<std::string> order;
  while (!making_.empty()) {
    for (const std::string& id : {scan, finished, first, second})
      if (state(id, id == finished ? std::string(kViewerMesh) : "ply").phase ==
              ExportPhase::kRunning &&
          (order.empty() || order.back() != id))
        order.push_back(id);
    make_one();
    hear();
    exports_->tick(now_);
  }
  EXPECT_THAT(order, testing::ElementsAre(scan, second, first, finished));
}

TEST_F(ExportsTest, SoManyMayWaitAndNoMore) {
  const auto take = [this](const std::string& token, bool admin) {
    return ask(add_scan(test::plane_cloud(2)), "ply", token, admin).ok();
  };
  int taken = 0;
  while (taken < 100 && take("greedy", false)) ++taken;
  EXPECT_EQ(taken, kExportShare.per_token);
  while (taken < 100 && take("token" + std::to_string(taken), false)) ++taken;
  EXPECT_EQ(taken, kExportShare.in_all - kExportShare.for_admins);
  exports_->make_mesh(rows_[add_scan()]);
  while (taken < 100 && take("admin", true)) ++taken;
  EXPECT_EQ(taken, kExportShare.in_all);
}

TEST_F(ExportsTest, TheMeshOfAFinishedScanIsMadeByItself) {
  const std::string scan = add_scan(), empty = add_scan({}), few = add_scan(test::plane_cloud(1));
  for (const std::string& id : {scan, empty, few}) exports_->make_mesh(rows_[id]);
  settle();
  EXPECT_EQ(state(scan, std::string(kViewerMesh)).phase, ExportPhase::kReady);
  EXPECT_EQ(state(empty, std::string(kViewerMesh)).phase, ExportPhase::kMissing);
  EXPECT_EQ(state(few, std::string(kViewerMesh)).phase, ExportPhase::kMissing)
      << "nobody has asked: it is no failure";
}

TEST_F(ExportsTest, AServerThatStopsBeginsNothingAndLeavesNothing) {
  const std::string scan = add_scan(), other = add_scan();
  ASSERT_TRUE(ask(scan, "ply").ok());
  ASSERT_TRUE(ask(other, "ply").ok());
  exports_->stop();
  EXPECT_EQ(ask(other, "glb").error().code, ErrorCode::kBusy);
  settle();
  EXPECT_EQ(exports_->running_count(), 0u);
  EXPECT_THAT(files(scan), testing::ElementsAre("cloud.ply"));
  start();
  EXPECT_EQ(state(scan, "ply").phase, ExportPhase::kMissing);
}

edit::ScanEdits half_of_the_plane(std::int64_t version) {
  edit::EditBox box;
  box.low_m = {0.145, -9, -9};
  box.high_m = {9, 9, 9};
  return {version, {{edit::EditKind::kKeepInside, box, 0}}};
}

TEST_F(ExportsTest, AnEditRemovesWhatWasMadeWithoutItAndTheViewersMeshIsMadeAnew) {
  const std::string scan = add_scan();
  ASSERT_TRUE(blobs_.put(scan, "trajectory.txt", "0 0 0 0 0 0 0 1\n").ok());
  for (const char* format : {"ply", "ply_s1000", "las", "kitti"})
    ASSERT_TRUE(ask(scan, format).ok());
  settle();
  const std::size_t whole =
      output::parse_ply(*read_blob(blobs_, scan, "mesh.ply", 1 << 24))->triangles.size();
  EXPECT_EQ(exports_->change_edits(scan, half_of_the_plane(0))->version, 1);
  EXPECT_THAT(files(scan),
              testing::ElementsAre("cloud.ply", "edits.json", "poses.kitti.txt", "trajectory.txt"));
  EXPECT_EQ(state(scan, "glb-draco").phase, ExportPhase::kRunning);
  ASSERT_TRUE(ask(scan, "ply").ok());
  settle();
  EXPECT_EQ(state(scan, "glb-draco").phase, ExportPhase::kReady);
  EXPECT_THAT(files(scan), testing::Contains("mesh-thumbnail.jpg"));
  const output::PlyShape half = *output::parse_ply(*read_blob(blobs_, scan, "mesh.ply", 1 << 24));
  EXPECT_LT(half.triangles.size(), 0.6 * static_cast<double>(whole));
  for (const auto& position_m : half.positions) EXPECT_GT(position_m[0], 0.1449);
  EXPECT_EQ(state(scan, "points-ply").phase, ExportPhase::kMissing);
  EXPECT_EQ(exports_->change_edits(scan, half_of_the_plane(1))->version, 1)
      << "nothing has changed";
  EXPECT_EQ(state(scan, "ply").phase, ExportPhase::kReady);
}

TEST_F(ExportsTest, AMeshThatIsBeingMadeWhileSomebodyEditsIsNotKept) {
  const std::string scan = add_scan();
  ASSERT_TRUE(ask(scan, "ply").ok());
  make_one();  // made, and not heard of yet
  ASSERT_TRUE(exports_->change_edits(scan, half_of_the_plane(0)).ok());
  hear();
  while (state(scan, "ply").phase == ExportPhase::kRunning) settle();
  EXPECT_EQ(state(scan, "ply").phase, ExportPhase::kMissing);
  settle();
  EXPECT_EQ(files(scan), (std::vector<std::string>{"cloud.ply", "edits.json", "mesh-thumbnail.jpg",
                                                   "mesh.draco.glb"}));
}

TEST_F(ExportsTest, TheViewersMeshBringsAThumbnailWhereThereIsNoneOrAnotherOne) {
  const std::string scan = add_scan();
  const auto make = [&] {
    ASSERT_TRUE(ask(scan, "glb-draco").ok());
    settle();
  };
  make();
  EXPECT_THAT(files(scan), testing::Contains("mesh-thumbnail.jpg"))
      << "it is older than thumbnails";
  ASSERT_TRUE(exports_->remove(scan, "glb-draco").ok());
  EXPECT_EQ(files(scan), std::vector<std::string>{"cloud.ply"});
  ASSERT_TRUE(blobs_.put(scan, "thumbnail.jpg", "of the scan").ok());
  make();
  EXPECT_EQ(files(scan),
            (std::vector<std::string>{"cloud.ply", "mesh.draco.glb", "thumbnail.jpg"}));
  ASSERT_TRUE(exports_->change_edits(scan, half_of_the_plane(0)).ok());
  settle();
  EXPECT_THAT(files(scan), testing::Contains("mesh-thumbnail.jpg")) << "of what is left";
  ASSERT_TRUE(exports_->change_edits(scan, {1, {}}).ok());
  settle();
  EXPECT_EQ(files(scan), (std::vector<std::string>{"cloud.ply", "edits.json", "mesh.draco.glb",
                                                   "thumbnail.jpg"}));
}

TEST_F(ExportsTest, EditsThatLeaveNothingAreSaid) {
  const std::string scan = add_scan();
  edit::ScanEdits edits = half_of_the_plane(0);
  edits.edits.front().box.low_m.x() = 8;
  ASSERT_TRUE(exports_->change_edits(scan, edits).ok());
  for (const char* format : {"stl", "las"}) {
    ASSERT_TRUE(ask(scan, format).ok());
    settle();
    EXPECT_EQ(state(scan, format).phase, ExportPhase::kFailed);
    EXPECT_THAT(state(scan, format).message, HasSubstr("leave nothing"));
  }
  ASSERT_TRUE(exports_->change_edits(scan, {1, {}}).ok());
  EXPECT_EQ(state(scan, "stl").phase, ExportPhase::kMissing) << "why it failed is forgotten";
  ASSERT_TRUE(ask(scan, "stl").ok());
  settle();
  EXPECT_EQ(state(scan, "stl").phase, ExportPhase::kReady);
}

TEST_F(ExportsTest, EditsAreOfScansThatHaveEnded) {
  EXPECT_EQ(
      exports_
          ->change_edits(add_scan(test::plane_cloud(9), ScanPhase::kRunning), half_of_the_plane(0))
          .error()
          .code,
      ErrorCode::kBusy);
  EXPECT_EQ(exports_->edits(new_scan_id()).error().code, ErrorCode::kNotFound);
}

}  // namespace
}  // namespace hermite::server
