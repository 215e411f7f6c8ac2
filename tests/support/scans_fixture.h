// Scans on a real server with a real pipeline: cameras that send the frames of the tiny room, and
// the rows and files that come of them. Header only.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>

#include "server/store/scan_id.h"
#include "server/store/store.h"
#include "tests/support/scan_server_test.h"

namespace hermite::test {

// Few frames make no stable surfels; the clouds of these tests shall not be empty.
inline const std::map<std::string, std::string> kFewFramesSettings = {{"output.unstable", "true"}};

class ScansFixture : public ScanServerTest {
 protected:
  // A camera whose hello was accepted.
  struct Camera {
    std::unique_ptr<RawClient> client;
    wire::Welcome welcome;
  };
  Camera start(wire::Mode mode = wire::Mode::kBatch,
               const std::map<std::string, std::string>& settings = kFewFramesSettings) {
    Camera camera{hello(wire::StartScan{"a test",
                                        room().camera(),
                                        {wire::DepthCodec::kRvlZstd},
                                        {wire::ColorCodec::kJpeg, wire::ColorCodec::kPng},
                                        mode,
                                        settings,
                                        kFrameCount},
                        0),
                  {}};
    const auto welcome = camera.client->read<wire::Welcome>();
    EXPECT_TRUE(welcome);
    if (welcome) camera.welcome = *welcome;
    return camera;
  }
  // A camera that asks for a scan and says for how long it may send nothing.
  Camera start_with_patience(std::uint32_t frame_patience_s) {
    Camera camera{hello(wire::StartScan{"",
                                        room().camera(),
                                        {wire::DepthCodec::kRvlZstd},
                                        {wire::ColorCodec::kJpeg},
                                        wire::Mode::kBatch,
                                        {},
                                        0,
                                        frame_patience_s}),
                  {}};
    if (const auto welcome = camera.client->read<wire::Welcome>()) camera.welcome = *welcome;
    return camera;
  }
  // A camera that asks for a scan; the answer is the test's business.
  std::unique_ptr<RawClient> ask(const std::string& title = "",
                                 std::uint32_t protocol_minor = wire::kProtocolMinor) {
    return hello(wire::StartScan{title,
                                 room().camera(),
                                 {wire::DepthCodec::kRvlZstd},
                                 {wire::ColorCodec::kJpeg},
                                 wire::Mode::kBatch,
                                 {},
                                 0},
                 protocol_minor);
  }
  // Sends the frames of the room within the credit and asks for the result.
  static std::optional<wire::Finished> stream(Camera& camera) {
    std::uint64_t granted = camera.welcome.frame_credit;
    for (int i = 0; i < kFrameCount; ++i) {
      while (static_cast<std::uint64_t>(i) >= granted) {
        const auto credit = camera.client->read<wire::Credit>();
        if (!credit) return std::nullopt;
        granted = std::max(granted, credit->frames_granted);
      }
      camera.client->send_message(room_frame(i));
    }
    camera.client->send_message(wire::Finish{});
    return camera.client->read<wire::Finished>();
  }

  std::string scan_file(const std::string& id, const std::string& name) const {
    return folder_ / "data/scans/" + id + "/" + name;
  }

  nlohmann::json row(const std::string& id) { return ask_http("GET", id); }
  // A row as of a server that has died, whose frame log is empty, or which has no folder at all;
  // the next server runs then.
  server::ScanRow leave_running(bool has_folder) {
    server_->stop();
    server::ScanRow left;
    left.id = server::new_scan_id();
    left.camera = room().camera();
    left.created_at_ms = 1;
    EXPECT_TRUE(server::Store(folder_ / "data/hermite.db").scans.add(left).ok());
    if (has_folder) std::filesystem::create_directories(scan_file(left.id, "log"));
    serve([](server::ServiceOptions&) {});
    return left;
  }
  // Waits until the scan does not run any more.
  std::string final_state(const std::string& id) {
    for (int i = 0; i < 600; ++i) {
      const std::string state = row(id)["state"];
      if (state != "running") return state;
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    return "running for a minute";
  }
};

}  // namespace hermite::test
