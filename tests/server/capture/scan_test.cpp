// A whole scan against the real server, in one process.
#include "server/capture/scan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <nlohmann/json.hpp>
#include <thread>

#include "core/dataset/recording.h"
#include "core/source/open_sequence.h"
#include "server/capture/recording_camera.h"
#include "tests/server/capture/scripted_camera.h"
#include "tests/support/raw_client.h"
#include "tests/support/running_server.h"
#include "tests/support/temporary_folder.h"

namespace hermite::client::scan_test {
namespace {

using testing::Contains;
using testing::HasSubstr;
using Json = nlohmann::json;

constexpr int kPreflight = 3;

std::unique_ptr<CaptureCamera> room_camera(int frames) {
  return play_recording(*source::open_sequence(
      "synthetic:frames=" + std::to_string(kPreflight + frames) + ",width=160,height=120"));
}

StreamRequest stream_to(int port, const std::string& token) {
  StreamRequest request;
  request.server = {"127.0.0.1", static_cast<std::uint16_t>(port), token};
  request.title = "a test";
  request.settings = {{"output.unstable", "true"}};
  return request;
}

struct Hashes {
  std::string cloud, trajectory;
  bool operator==(const Hashes&) const = default;
};

Hashes hashes_of(const StreamOutcome& outcome) {
  const Json report = Json::parse(outcome.report_json);
  return {report["cloud_sha256"], report["trajectory_sha256"]};
}

// What an undisturbed batch run of the recorded frames gives.
Hashes hashes_of_recording(const std::string& folder, const StreamRequest& request) {
  const auto sequence = source::open_sequence(folder);
  CHECK(sequence.ok(), sequence.ok() ? "" : sequence.error().message);
  const auto outcome = stream_sequence(**sequence, {0, (*sequence)->frame_count()}, request, {});
  CHECK(outcome.ok(), outcome.ok() ? "" : outcome.error().message);
  return hashes_of(*outcome);
}

TEST(Scan, LiveItAccountsForEveryFrame) {
  const test::TemporaryFolder folder;
  test::RunningServer server(test::test_options(folder / "data"));
  const auto camera = room_camera(12);
  const auto outcome = run_scan(*camera,
                                {.stream = stream_to(server.port(), server.token()),
                                 .title = "a test",
                                 .preflight_frames = kPreflight},
                                {});
  ASSERT_TRUE(outcome.ok()) << outcome.error().message;
  const ScanProgress& end = outcome->progress;
  EXPECT_GT(end.capture.frame_count, 0u);
  EXPECT_EQ(end.stream.processed_frames + end.dropped_frames + end.stream.left_out_frames,
            end.capture.frame_count);
  EXPECT_FALSE(end.log);
}

TEST(Scan, WithARecordingEveryFrameArrivesAndTheResultIsThatOfTheRecording) {
  const test::TemporaryFolder folder;
  test::RunningServer server(test::test_options(folder / "data"));
  const StreamRequest request = stream_to(server.port(), server.token());
  const auto camera = room_camera(8);
  std::vector<std::string> messages;
  const auto outcome =
      run_scan(*camera,
               {.stream = request,
                .title = "a test",
                .record_folder = folder / "log",
                .preflight_frames = kPreflight},
               {.on_message = [&](const std::string& said) { messages.push_back(said); }});
  ASSERT_TRUE(outcome.ok()) << outcome.error().message;
  EXPECT_EQ(outcome->progress.capture.frame_count, 8u);
  EXPECT_EQ(outcome->progress.dropped_frames, 0u);
  EXPECT_EQ(outcome->progress.stream.processed_frames, 8u);
  ASSERT_TRUE(outcome->progress.log);
  EXPECT_EQ(outcome->progress.log->durable_count, 8u);
  EXPECT_EQ(hashes_of(*outcome->stream), hashes_of_recording(folder / "log", request));
  EXPECT_THAT(messages.front(), HasSubstr("looked at 3 frames"));
}

TEST(Scan, APauseIsShownToViewersAndItsFramesAreNotTaken) {
  const test::TemporaryFolder folder;
  test::RunningServer server(test::test_options(folder / "data"));
  // More than come until it is interrupted, however slow the machine is.
  const auto camera = room_camera(100'000);
  std::atomic<bool> paused{false};
  std::atomic<int> interrupts{0};
  std::atomic<std::uint64_t> processed{0};
  std::string scan_id;  // written before `processed`
  std::optional<Result<ScanOutcome>> outcome;
  std::thread scanning([&] {
    outcome = run_scan(
        *camera,
        {.stream = stream_to(server.port(), server.token()),
         .title = "a test",
         .record_folder = folder / "log",
         .preflight_frames = kPreflight},
        {.wishes = [&] { return CaptureWishes{.paused = paused, .interrupt_count = interrupts}; },
         .on_progress =
             [&](const ScanProgress& progress) {
               if (scan_id.empty()) scan_id = progress.stream.scan_id;
               processed = progress.stream.processed_frames;
             }});
  });
  for (int i = 0; i < 60'000 && processed < 2; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  paused = true;
  test::RawClient viewer(server.port());
  ASSERT_TRUE(viewer.upgrade());
  viewer.send_message(
      wire::Hello{wire::kProtocolMinor, "test", server.token(), wire::ViewScan{scan_id}});
  const auto sees = [&](bool wanted) {
    while (const auto state = viewer.read<wire::ScanState>())
      if (state->paused == wanted) return true;
    return false;
  };
  EXPECT_TRUE(sees(true));
  paused = false;
  EXPECT_TRUE(sees(false));
  interrupts = 1;
  scanning.join();
  ASSERT_TRUE(outcome->ok()) << outcome->error().message;
  EXPECT_EQ((*outcome)->progress.stream.processed_frames, (*outcome)->progress.capture.frame_count);
}

TEST(Scan, WithoutAServerItOnlyRecords) {
  const test::TemporaryFolder folder;
  const auto camera = room_camera(5);
  const auto outcome =
      run_scan(*camera, {.record_folder = folder / "log", .preflight_frames = kPreflight}, {});
  ASSERT_TRUE(outcome.ok()) << outcome.error().message;
  EXPECT_FALSE(outcome->stream);
  EXPECT_EQ((*source::open_sequence(folder / "log"))->frame_count(), 5);
}

// The server is not there when the scan begins, comes, is killed without a word while frames flow,
// and comes back with what it had on disk.
TEST(Scan, GoesOnWithoutTheServerAndCatchesUp) {
  const test::TemporaryFolder folder;
  server::ServiceOptions options = test::test_options(folder / "data");
  auto server = std::make_unique<test::RunningServer>(options);
  const StreamRequest request = stream_to(server->port(), server->token());
  options.listen = "127.0.0.1:" + std::to_string(server->port());
  server.reset();
  const auto camera = room_camera(45);
  std::atomic<std::uint64_t> captured{0}, processed{0};
  ScanObserver observer;
  observer.on_progress = [&](const ScanProgress& progress) {
    captured = progress.capture.frame_count;
    processed = progress.stream.processed_frames;
  };
  std::optional<Result<ScanOutcome>> outcome;
  std::thread scanning([&] {
    outcome = run_scan(*camera,
                       {.stream = request,
                        .title = "a test",
                        .record_folder = folder / "log",
                        .preflight_frames = kPreflight},
                       observer);
  });
  const auto wait_for = [](const std::atomic<std::uint64_t>& count, std::uint64_t enough) {
    for (int i = 0; i < 60'000 && count < enough; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
  };
  wait_for(captured, 10);
  server = std::make_unique<test::RunningServer>(options);
  wait_for(processed, 3);
  server.reset();
  const std::uint64_t seen_without = captured;
  wait_for(captured, std::min<std::uint64_t>(seen_without + 10, 45));
  server = std::make_unique<test::RunningServer>(options);
  scanning.join();
  ASSERT_TRUE(outcome->ok()) << outcome->error().message;
  EXPECT_EQ((*outcome)->progress.capture.frame_count, 45u);
  EXPECT_EQ((*outcome)->progress.dropped_frames, 0u);
  EXPECT_EQ((*outcome)->progress.stream.resumed_count, 1u);
  EXPECT_EQ(hashes_of(*(*outcome)->stream), hashes_of_recording(folder / "log", request));
}

TEST(Scan, WhenTheServerHasGivenUpTheScanAllIsSentAgain) {
  const test::TemporaryFolder folder;
  server::ServiceOptions options = test::test_options(folder / "data");
  options.resume_window_s = 0;
  auto server = std::make_unique<test::RunningServer>(options);
  const StreamRequest request = stream_to(server->port(), server->token());
  options.listen = "127.0.0.1:" + std::to_string(server->port());
  const auto camera = room_camera(20);
  std::atomic<std::uint64_t> processed{0};
  std::vector<std::string> messages;
  std::optional<Result<ScanOutcome>> outcome;
  std::thread scanning([&] {
    outcome = run_scan(
        *camera,
        {.stream = request,
         .title = "a test",
         .record_folder = folder / "log",
         .preflight_frames = kPreflight},
        {.on_progress =
             [&](const ScanProgress& progress) { processed = progress.stream.processed_frames; },
         .on_message = [&](const std::string& said) { messages.push_back(said); }});
  });
  for (int i = 0; i < 60'000 && processed < 2; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  server.reset();
  server = std::make_unique<test::RunningServer>(options);
  scanning.join();
  ASSERT_TRUE(outcome->ok()) << outcome->error().message;
  EXPECT_THAT(messages, Contains(HasSubstr("all is sent again as a new scan")));
  EXPECT_EQ((*outcome)->progress.stream.processed_frames, 20u);
  EXPECT_EQ(hashes_of(*(*outcome)->stream), hashes_of_recording(folder / "log", request));
}

TEST(Scan, AServerThatStaysAwayIsWaitedForNoLongerThanPatienceAndTheRecordingIsWhole) {
  const test::TemporaryFolder folder;
  int port = 0;
  {
    test::RunningServer gone(test::test_options(folder / "data"));
    port = gone.port();
  }
  const auto camera = room_camera(4);
  const auto outcome = run_scan(*camera,
                                {.stream = stream_to(port, "a token"),
                                 .title = "a test",
                                 .record_folder = folder / "log",
                                 .preflight_frames = kPreflight,
                                 .server_patience = std::chrono::milliseconds(200)},
                                {});
  ASSERT_FALSE(outcome.ok());
  EXPECT_THAT(outcome.error().message,
              AllOf(HasSubstr("away for too long"), HasSubstr("hermite-client stream sends it")));
  EXPECT_EQ((*source::open_sequence(folder / "log"))->frame_count(), 4);
}

TEST(Scan, AWrongTokenIsSaidAtOnce) {
  const test::TemporaryFolder folder;
  test::RunningServer server(test::test_options(folder / "data"));
  const auto camera = room_camera(1000);
  const auto outcome = run_scan(*camera,
                                {.stream = stream_to(server.port(), "not the token"),
                                 .title = "a test",
                                 .record_folder = folder / "log",
                                 .preflight_frames = kPreflight},
                                {});
  ASSERT_FALSE(outcome.ok());
  EXPECT_EQ(outcome.error().code, ErrorCode::kUnauthorized);
}

TEST(Scan, TheFirstInterruptFinishesTheSecondGivesUp) {
  const test::TemporaryFolder folder;
  test::RunningServer server(test::test_options(folder / "data"));
  const StreamRequest request = stream_to(server.port(), server.token());
  for (const int wish : {1, 2}) {
    const auto camera = room_camera(1000);
    std::atomic<int> interrupts{0};
    const auto outcome =
        run_scan(*camera,
                 {.stream = request,
                  .title = "a test",
                  .record_folder = folder / ("log" + std::to_string(wish)),
                  .preflight_frames = kPreflight},
                 {.wishes = [&] { return CaptureWishes{.interrupt_count = interrupts}; },
                  .on_progress =
                      [&](const ScanProgress& progress) {
                        interrupts = progress.stream.processed_frames >= 2 ? wish : 0;
                      }});
    EXPECT_EQ(outcome.ok(), wish == 1);
    if (outcome.ok()) {
      EXPECT_LT(outcome->progress.capture.frame_count, 1000u);
      EXPECT_EQ(outcome->progress.stream.processed_frames, outcome->progress.capture.frame_count);
    }
  }
}

TEST(Scan, ACameraThatGivesNothingIsSaidInAMessage) {
  test::ScriptedCamera camera({160, 120, 130, 130, 79.5, 59.5, 1000});
  const test::TemporaryFolder folder;
  const auto outcome = run_scan(camera,
                                {.record_folder = folder / "log",
                                 .preflight_frames = kPreflight,
                                 .camera_patience = std::chrono::milliseconds(50)},
                                {});
  ASSERT_FALSE(outcome.ok());
  EXPECT_THAT(outcome.error().message, HasSubstr("is it plugged in"));
  EXPECT_FALSE(std::filesystem::exists(folder / "log"));
}

TEST(Scan, ACameraThatBreaksEndsTheScanWithWhatThereIs) {
  test::ScriptedCamera camera({160, 120, 130, 130, 79.5, 59.5, 1000});
  camera.add_frames(kPreflight + 4);
  camera.script.emplace_back(Error{ErrorCode::kDevice, "the cable is out"});
  const test::TemporaryFolder folder;
  std::vector<std::string> messages;
  const auto outcome =
      run_scan(camera, {.record_folder = folder / "log", .preflight_frames = kPreflight},
               {.on_message = [&](const std::string& said) { messages.push_back(said); }});
  ASSERT_TRUE(outcome.ok()) << outcome.error().message;
  ASSERT_TRUE(outcome->progress.capture.failure);
  EXPECT_EQ(outcome->progress.log->durable_count + outcome->progress.dropped_frames, 4u);
}

}  // namespace
}  // namespace hermite::client::scan_test
