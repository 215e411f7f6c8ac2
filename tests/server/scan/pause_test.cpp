// A viewer asks for a pause, from the request to the camera's answer.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>

#include <nlohmann/json.hpp>

#include "tests/support/scan_server_test.h"

namespace hermite::server::pause_test {
namespace {

using test::RawClient;
using test::room;
using testing::HasSubstr;

class PauseTest : public test::ScanServerTest {
 protected:
  std::unique_ptr<RawClient> start(std::uint32_t protocol_minor) {
    auto camera = hello(wire::StartScan{"a test",
                                        room().camera(),
                                        {wire::DepthCodec::kRvlZstd},
                                        {wire::ColorCodec::kJpeg},
                                        wire::Mode::kBatch,
                                        {},
                                        0},
                        protocol_minor);
    const auto welcome = camera->read<wire::Welcome>();
    EXPECT_TRUE(welcome);
    if (welcome) scan_id_ = welcome->scan_id;
    return camera;
  }
  nlohmann::json ask(const std::string& wish) { return ask_http("POST", scan_id_ + "/" + wish); }

  std::string scan_id_;
};

TEST_F(PauseTest, TheCameraIsAskedAndSaysWhenItHasPaused) {
  const auto camera = start(wire::kProtocolMinor);
  EXPECT_EQ(ask("pause").value("asked", ""), "pause");
  auto request = camera->read<wire::PauseRequest>();
  ASSERT_TRUE(request);
  EXPECT_TRUE(request->paused);
  camera->send_message(wire::Pause{});
  const auto state = camera->read<wire::ScanState>();
  ASSERT_TRUE(state);
  EXPECT_TRUE(state->paused && state->can_pause);
  EXPECT_EQ(ask("unpause").value("asked", ""), "unpause");
  request = camera->read<wire::PauseRequest>();
  ASSERT_TRUE(request);
  EXPECT_FALSE(request->paused);
  camera->send_message(wire::Discard{});
}

TEST_F(PauseTest, ACameraOfAnOlderProtocolIsNotAsked) {
  const auto camera = start(wire::kMinorWithPauseRequest - 1);
  EXPECT_THAT(ask("pause").dump(), HasSubstr("this camera cannot be asked to pause"));
  camera->send_message(wire::Pause{});
  const auto state = camera->read<wire::ScanState>();
  ASSERT_TRUE(state);
  EXPECT_TRUE(state->paused);
  EXPECT_FALSE(state->can_pause);
  camera->send_message(wire::Discard{});
}

}  // namespace
}  // namespace hermite::server::pause_test
