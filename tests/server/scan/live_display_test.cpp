#include "server/scan/live_display.h"

#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "proto/wire/server_message.h"

namespace hermite::server::live_display_test {
namespace {

class LiveDisplayTest : public testing::Test {
 protected:
  LiveDisplayTest() {
    auto joined = Subscribers::join(subscribers_, {"admin", true}, {}, [] {});
    EXPECT_TRUE(joined.ok());
    if (joined.ok()) viewer_ = *std::move(joined);
  }

  // What viewer and camera were shown last since it was asked before.
  std::optional<wire::ScanState> seen_by_viewer() {
    std::optional<wire::ScanState> seen;
    while (const SharedBytes bytes = viewer_->next())
      if (const auto message = wire::parse_server_message(*bytes); message.ok())
        if (const auto* state = std::get_if<wire::ScanState>(&*message)) seen = *state;
    return seen;
  }
  std::optional<wire::ScanState> heard_by_camera() { return std::exchange(heard_, std::nullopt); }

  CameraLink link() {
    CameraLink link;
    link.send = [this](const wire::ServerMessage& message) {
      if (const auto* state = std::get_if<wire::ScanState>(&message)) heard_ = *state;
    };
    link.can_pause = true;
    return link;
  }

  const std::shared_ptr<Subscribers> subscribers_ =
      std::make_shared<Subscribers>(SceneInfo{"id", "title", {}});
  std::unique_ptr<Viewer> viewer_;
  std::optional<wire::ScanState> heard_;
  ScanCamera camera_{std::chrono::milliseconds(1000), std::chrono::milliseconds(1000)};
  ReceivedFrames frames_{16, 0, {}};
  ScanLifecycle lifecycle_{false};
  LiveDisplay display_{{frames_, lifecycle_, camera_}, *subscribers_};
};

TEST_F(LiveDisplayTest, ACameraIsShownNothingBeforeItIsGreeted) {
  camera_.attach(link());
  display_.show_state_to_viewers();
  EXPECT_FALSE(heard_by_camera());
  ASSERT_TRUE(seen_by_viewer());
  ASSERT_TRUE(frames_.receive(0).ok());
  display_.show_state();
  const auto heard = heard_by_camera(), seen = seen_by_viewer();
  ASSERT_TRUE(heard && seen);
  EXPECT_EQ(heard->frames_received, 1u);
  EXPECT_TRUE(seen->can_pause);
}

TEST_F(LiveDisplayTest, TheCameraComesBeforeTheWorkerAndThatBeforeTheWarning) {
  camera_.attach(link());
  display_.warn("the disk is nearly full");
  EXPECT_EQ(heard_by_camera()->message, "the disk is nearly full");
  display_.warn("the disk is nearly full");
  EXPECT_FALSE(heard_by_camera()) << "that is no news";
  display_.worker_says("hold the camera still");
  EXPECT_EQ(heard_by_camera()->message, "hold the camera still");
  camera_.pause(true);
  display_.show_state();
  EXPECT_EQ(heard_by_camera()->message, "paused by its camera");
  camera_.pause(false);
  display_.worker_says("");
  EXPECT_EQ(heard_by_camera()->message, "the disk is nearly full");
}

TEST_F(LiveDisplayTest, ThatTheSurfaceHasEndedIsSaidWhenThereIsNoWarning) {
  MeshUpdate update;
  update.ended = true;
  display_.mesh_changed(update);
  EXPECT_NE(seen_by_viewer()->message, "");
  display_.warn("the disk is nearly full");
  EXPECT_EQ(seen_by_viewer()->message, "the disk is nearly full");
}

TEST_F(LiveDisplayTest, TheModelGrows) {
  ModelUpdate update;
  update.keyframes = 3;
  update.loops = 1;
  update.gpu_memory_bytes = 1000;
  display_.model_changed(update);
  const auto seen = seen_by_viewer();
  ASSERT_TRUE(seen);
  EXPECT_EQ(seen->keyframes, 3u);
  EXPECT_EQ(seen->loops, 1u);
  EXPECT_EQ(display_.gpu_memory_bytes(), 1000u);
  EXPECT_FALSE(display_.arrivals().points_delay()) << "no chunk has changed";
}

TEST_F(LiveDisplayTest, AfterTheLastStateViewersAreDone) {
  ScanEnd end;
  end.phase = wire::ScanPhase::kFinished;
  lifecycle_.ended(end);
  display_.warn("too late");
  EXPECT_EQ(display_.close("a remark about the map").phase, wire::ScanPhase::kFinished);
  EXPECT_EQ(seen_by_viewer()->message, "a remark about the map");
  EXPECT_TRUE(viewer_->complete());
}

}  // namespace
}  // namespace hermite::server::live_display_test
