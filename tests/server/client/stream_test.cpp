// The client against the real server, in one process.
#include "server/client/stream.h"

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/dataset/camera_file.h"
#include "core/output/ply.h"
#include "core/pipeline/pipeline.h"
#include "core/report/run_report.h"
#include "core/run/back_end.h"
#include "core/source/open_sequence.h"
#include "proto/wire/frame_payload.h"
#include "server/client/scans.h"
#include "tests/support/raw_client.h"
#include "tests/support/running_server.h"
#include "tests/support/temporary_folder.h"

namespace hermite::client {
namespace {

using testing::HasSubstr;
using Json = nlohmann::json;

constexpr int kFrameCount = 6;

// A server with a data folder of its own, which goes when the test is over.
struct TestServer {
  explicit TestServer(int credit_window = 16) : server(options(folder.path(), credit_window)) {}
  ServerUrl url() const {
    return {"127.0.0.1", static_cast<std::uint16_t>(server.port()), server.token()};
  }

  static server::ServiceOptions options(const std::string& data_folder, int credit_window) {
    server::ServiceOptions options = test::test_options(data_folder);
    options.credit_window = credit_window;
    return options;
  }

  test::TemporaryFolder folder;
  test::RunningServer server;
};

// Another sequence, one of whose frames cannot be read, as when a file is missing.
class WithAHole final : public dataset::Sequence {
 public:
  WithAHole(const dataset::Sequence& whole, std::int64_t hole) : whole_(whole), hole_(hole) {}
  std::string format() const override { return whole_.format(); }
  std::string name() const override { return whole_.name(); }
  const Camera& camera() const override { return whole_.camera(); }
  double frame_rate_hz() const override { return whole_.frame_rate_hz(); }
  std::int64_t frame_count() const override { return whole_.frame_count(); }
  double timestamp_s(std::int64_t index) const override { return whole_.timestamp_s(index); }
  Result<dataset::RecordedFrame> read(std::int64_t index) const override {
    if (index == hole_) return Error{ErrorCode::kIo, "the file is gone"};
    return whole_.read(index);
  }
  const dataset::Trajectory& groundtruth() const override { return whole_.groundtruth(); }

 private:
  const dataset::Sequence& whole_;
  const std::int64_t hole_;
};

std::unique_ptr<dataset::Sequence> synthetic_room() {
  return *source::open_sequence("synthetic:frames=" + std::to_string(kFrameCount) +
                                ",width=160,height=120");
}

dataset::FrameRange all_of(const dataset::Sequence& sequence) {
  return {0, sequence.frame_count()};
}

StreamRequest request_for(const TestServer& server) {
  StreamRequest request;
  request.server = server.url();
  request.title = "a test";
  request.settings = {{"output.unstable", "true"}};  // a few frames make no stable surfels
  return request;
}

struct Expected {
  std::string trajectory_tum;
  std::string cloud_sha256;
};

// What a run without a server gives.
Expected local_run(const dataset::Sequence& sequence) {
  pipeline::Options options;
  options.output_unstable = true;
  const auto frame_of = [&sequence](std::int64_t index) {
    auto recorded = sequence.read(index);
    return recorded.ok() ? *dataset::decode_frame(*std::move(recorded))
                         : wire::empty_frame(sequence.timestamp_s(index), sequence.camera());
  };
  pipeline::BackEnd back_end = run::make_back_end(options, adjust::CorrectionTime::kByFrames);
  back_end.past_frames = [&frame_of]() -> pipeline::PastFrames {
    return [&frame_of](std::int64_t index, double) { return frame_of(index); };
  };
  pipeline::Pipeline pipeline("", sequence.camera(), options, std::move(back_end));
  for (std::int64_t index = 0; index < sequence.frame_count(); ++index)
    EXPECT_TRUE(pipeline.process(frame_of(index)).ok());
  pipeline.finish();
  const output::Cloud cloud = *pipeline.cloud();
  EXPECT_FALSE(cloud.empty());
  const report::RunReport report{pipeline.statistics(), options,
                                 dataset::format_tum_trajectory(pipeline.trajectory()),
                                 output::format_ply(cloud)};
  return {
      report.trajectory_text,
      Json::parse(report::format_report_json(report, {}, {}))["cloud_sha256"].get<std::string>()};
}

std::string cloud_sha256(const StreamOutcome& outcome) {
  return Json::parse(outcome.report_json)["cloud_sha256"].get<std::string>();
}

std::int64_t pose_count(const std::string& trajectory_tum) {
  return static_cast<std::int64_t>(dataset::parse_tum_trajectory(trajectory_tum)->size());
}

TEST(Stream, GivesWhatALocalRunGivesForAnyCreditWindow) {
  const auto sequence = synthetic_room();
  const Expected expected = local_run(*sequence);
  for (const int credit_window : {1, 3, 16}) {
    const TestServer server(credit_window);
    const auto outcome = stream_sequence(*sequence, all_of(*sequence), request_for(server), {});
    ASSERT_TRUE(outcome.ok()) << outcome.error().message;
    EXPECT_EQ(cloud_sha256(*outcome), expected.cloud_sha256);
    EXPECT_EQ(outcome->trajectory_tum, expected.trajectory_tum)
        << "credit window " << credit_window;
    EXPECT_EQ(outcome->progress.sent_frames, kFrameCount);
    EXPECT_EQ(outcome->progress.processed_frames, kFrameCount);
    EXPECT_EQ(outcome->progress.dropped_frames, 0u);
    EXPECT_EQ(outcome->progress.unknown_messages, 0u);
    const Json report = Json::parse(outcome->report_json);
    EXPECT_EQ(report["frames"], kFrameCount);
    EXPECT_EQ(report["tracked_frames"].get<std::uint64_t>(), outcome->progress.tracked_frames);
  }
}

TEST(Stream, ACameraThatIsOffIsCorrectedFromTheFrameLogAsInALocalRun) {
  const auto sequence = *source::open_sequence(
      "synthetic:scene=bare,frames=60,width=160,height=120,rate=10+focal=percent=2");
  const TestServer server;
  std::vector<wire::MapEvent> events;
  StreamObserver observer;
  observer.on_event = [&events](const wire::FrameResult& result) {
    events.push_back(result.event);
  };
  const auto outcome = stream_sequence(*sequence, all_of(*sequence), request_for(server), observer);
  ASSERT_TRUE(outcome.ok()) << outcome.error().message;
  EXPECT_THAT(events, testing::ElementsAre(wire::MapEvent::kRecalibrated));
  const Expected expected = local_run(*sequence);
  EXPECT_EQ(cloud_sha256(*outcome), expected.cloud_sha256);
  EXPECT_EQ(outcome->trajectory_tum, expected.trajectory_tum);
  const Json report = Json::parse(outcome->report_json);
  EXPECT_THAT(report["camera_correction"].get<std::string>(), HasSubstr("focal length by -"));
  const Result<dataset::CameraFile> corrected =
      dataset::parse_camera_json(report["corrected_camera"].dump());
  ASSERT_TRUE(corrected.ok()) << corrected.error().message;
  EXPECT_NEAR(corrected->camera.fx / sequence->camera().fx, 1 / 1.02, 0.003);
}

TEST(Stream, TwoScansAtOnceAreTheSameAsOne) {
  const auto sequence = synthetic_room();
  const Expected expected = local_run(*sequence);
  const TestServer server(2);
  const auto stream = [&] {
    const auto outcome = stream_sequence(*sequence, all_of(*sequence), request_for(server), {});
    ASSERT_TRUE(outcome.ok()) << outcome.error().message;
    EXPECT_EQ(outcome->trajectory_tum, expected.trajectory_tum);
    EXPECT_EQ(cloud_sha256(*outcome), expected.cloud_sha256);
  };
  std::thread other(stream);
  stream();
  other.join();
}

TEST(Stream, AFrameThatCannotBeReadStillHasItsLineAndIsReportedAsLost) {
  const auto whole = synthetic_room();
  const WithAHole sequence(*whole, 2);
  const Expected expected = local_run(sequence);
  const TestServer server;
  std::vector<std::string> problems;
  StreamObserver observer;
  observer.on_problem = [&](const std::string& message) { problems.push_back(message); };
  std::vector<wire::FrameResult> events;
  observer.on_event = [&](const wire::FrameResult& result) { events.push_back(result); };
  const auto outcome = stream_sequence(sequence, all_of(sequence), request_for(server), observer);
  ASSERT_TRUE(outcome.ok()) << outcome.error().message;
  EXPECT_EQ(outcome->trajectory_tum, expected.trajectory_tum);
  EXPECT_EQ(cloud_sha256(*outcome), expected.cloud_sha256);
  EXPECT_EQ(pose_count(outcome->trajectory_tum), kFrameCount);
  EXPECT_THAT(problems, testing::ElementsAre(HasSubstr("frame 2: the file is gone")));
  EXPECT_EQ(outcome->progress.problem_frames, 1u);
  ASSERT_EQ(events.size(), 2u);
  EXPECT_EQ(events[0].event, wire::MapEvent::kLost);
  EXPECT_EQ(events[0].sequence, 2u);
  ASSERT_TRUE(events[0].last_tracked);
  EXPECT_EQ(events[0].last_tracked->sequence, 1u);
  EXPECT_EQ(events[1].event, wire::MapEvent::kFoundAgain);
  EXPECT_EQ(events[1].sequence, 3u);
}

TEST(Stream, ALiveCameraAccountsForEveryFrame) {
  const auto sequence = synthetic_room();
  const TestServer server(1);
  StreamRequest request = request_for(server);
  request.pacing = {.rate_hz = 1000, .newest_wins = true};
  const auto outcome = stream_sequence(*sequence, all_of(*sequence), request, {});
  ASSERT_TRUE(outcome.ok()) << outcome.error().message;
  const StreamProgress& progress = outcome->progress;
  EXPECT_EQ(progress.sent_frames + progress.dropped_frames + progress.left_out_frames, kFrameCount);
  EXPECT_EQ(progress.processed_frames + progress.server_dropped_frames, progress.sent_frames);
  EXPECT_EQ(pose_count(outcome->trajectory_tum),
            static_cast<std::int64_t>(progress.processed_frames));
}

TEST(Stream, PausesWhenAViewerAsksAndTheResultIsTheSame) {
  const TestServer server;
  const auto sequence = synthetic_room();
  StreamRequest request;
  request.server = server.url();
  const Result<StreamOutcome> undisturbed =
      stream_sequence(*sequence, {0, kFrameCount}, request, {});
  ASSERT_TRUE(undisturbed.ok()) << undisturbed.error().message;

  request.pacing.rate_hz = 5;
  const ApiTarget api{server.url(), {}};
  std::vector<std::string> told;
  std::optional<std::uint64_t> sent_at_pause;
  StreamObserver observer;
  observer.on_link = [&](const std::string& message) { told.push_back(message); };
  std::optional<std::chrono::steady_clock::time_point> paused_at;
  observer.on_progress = [&](const StreamProgress& progress) {
    const auto now = std::chrono::steady_clock::now();
    if (!paused_at) {
      paused_at = now;
      EXPECT_TRUE(pause_scan(api, progress.scan_id, true).ok());
    } else if (!sent_at_pause && now - *paused_at > std::chrono::seconds(1)) {
      sent_at_pause = progress.sent_frames;
      EXPECT_TRUE(pause_scan(api, progress.scan_id, false).ok());
    }
  };
  const Result<StreamOutcome> paused =
      stream_sequence(*sequence, {0, kFrameCount}, request, observer);
  ASSERT_TRUE(paused.ok()) << paused.error().message;
  ASSERT_TRUE(sent_at_pause);
  EXPECT_LT(*sent_at_pause, 4u) << "the frames wait";
  EXPECT_THAT(told, testing::ElementsAre(kPausedByViewer, kUnpausedByViewer));
  EXPECT_EQ(paused->trajectory_tum, undisturbed->trajectory_tum);
}

TEST(Stream, AWrongTokenIsSaidInAMessage) {
  const auto sequence = synthetic_room();
  const TestServer server;
  StreamRequest request = request_for(server);
  request.server.token = "not the token";
  const auto outcome = stream_sequence(*sequence, all_of(*sequence), request, {});
  ASSERT_FALSE(outcome.ok());
  EXPECT_EQ(outcome.error().code, ErrorCode::kUnauthorized);
  EXPECT_THAT(outcome.error().message, HasSubstr("token"));
}

TEST(Stream, AServerThatIsNotThereIsSaidInAMessage) {
  const auto sequence = synthetic_room();
  StreamRequest request;
  {
    const TestServer gone;
    request = request_for(gone);
  }
  const auto outcome = stream_sequence(*sequence, all_of(*sequence), request, {});
  ASSERT_FALSE(outcome.ok());
  EXPECT_THAT(outcome.error().message,
              HasSubstr("cannot connect to " + request.server.host_and_port()));
}

TEST(Stream, ASettingThatTheServerRefusesIsNamed) {
  const auto sequence = synthetic_room();
  const TestServer server;
  StreamRequest request = request_for(server);
  request.settings = {{"no.such_setting", "1"}};
  const auto outcome = stream_sequence(*sequence, all_of(*sequence), request, {});
  ASSERT_FALSE(outcome.ok());
  EXPECT_THAT(outcome.error().message, HasSubstr("no.such_setting"));
}

TEST(Stream, AnInterruptFinishesWithTheFramesSentSoFar) {
  const auto sequence = synthetic_room();
  const TestServer server(1);
  std::atomic<int> interrupts{0};
  StreamObserver observer;
  observer.interrupt_count = [&] { return interrupts.load(); };
  observer.on_progress = [&](const StreamProgress& progress) {
    if (progress.processed_frames >= 2) interrupts = 1;
  };
  const auto outcome = stream_sequence(*sequence, all_of(*sequence), request_for(server), observer);
  ASSERT_TRUE(outcome.ok()) << outcome.error().message;
  EXPECT_GE(outcome->progress.sent_frames, 2u);
  EXPECT_LT(outcome->progress.sent_frames, kFrameCount);
  EXPECT_EQ(pose_count(outcome->trajectory_tum),
            static_cast<std::int64_t>(outcome->progress.sent_frames));
}

TEST(Stream, ASecondInterruptGivesUp) {
  const auto sequence = synthetic_room();
  const TestServer server(1);
  std::atomic<int> interrupts{0};
  StreamObserver observer;
  observer.interrupt_count = [&] { return interrupts.load(); };
  observer.on_progress = [&](const StreamProgress&) { interrupts = 2; };
  const auto outcome = stream_sequence(*sequence, all_of(*sequence), request_for(server), observer);
  ASSERT_FALSE(outcome.ok());
  EXPECT_THAT(outcome.error().message, HasSubstr("interrupted"));
}

TEST(Stream, AServerThatStopsSaysWhy) {
  const auto sequence = synthetic_room();
  TestServer server(1);
  StreamObserver observer;
  std::vector<std::string> links;
  observer.on_link = [&](const std::string& message) { links.push_back(message); };
  observer.on_progress = [&](const StreamProgress& progress) {
    if (progress.processed_frames >= 1) server.server.stop();
  };
  StreamRequest request = request_for(server);
  request.reconnect_patience = std::chrono::milliseconds(100);
  const auto outcome = stream_sequence(*sequence, all_of(*sequence), request, observer);
  ASSERT_FALSE(outcome.ok());
  EXPECT_THAT(outcome.error().message, HasSubstr("stopping"));
  ASSERT_FALSE(links.empty());
  EXPECT_THAT(links.front(), HasSubstr("connection lost"));
}

// A server whose only place another camera has. It can be stopped, and started again at the same
// address.
struct TakenServer {
  TakenServer() {
    options.max_scans = 1;
    server = std::make_unique<test::RunningServer>(options);
    request.server = {"127.0.0.1", static_cast<std::uint16_t>(server->port()), server->token()};
    options.listen = "127.0.0.1:" + std::to_string(server->port());
    first = std::make_unique<test::RawClient>(server->port());
    EXPECT_TRUE(first->upgrade());
    // Of minor 0: it cannot come back, so its place is free when there is a server again.
    first->send_message(wire::Hello{0, "test", server->token(),
                                    wire::StartScan{"",
                                                    sequence->camera(),
                                                    {wire::DepthCodec::kRvlZstd},
                                                    {wire::ColorCodec::kJpeg},
                                                    wire::Mode::kBatch,
                                                    {},
                                                    0}});
    EXPECT_TRUE(first->read<wire::Welcome>());
  }
  // Streams until the end; meanwhile, when `ready`, does `then`.
  Result<StreamOutcome> stream(const StreamObserver& observer, const std::function<bool()>& ready,
                               const std::function<void()>& then) {
    std::optional<Result<StreamOutcome>> outcome;
    std::thread streaming(
        [&] { outcome = stream_sequence(*sequence, all_of(*sequence), request, observer); });
    for (int i = 0; i < 60'000 && !ready(); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    then();
    streaming.join();
    return *std::move(outcome);
  }

  const std::unique_ptr<dataset::Sequence> sequence = synthetic_room();
  const test::TemporaryFolder folder;
  server::ServiceOptions options = TestServer::options(folder.path(), 2);
  std::unique_ptr<test::RunningServer> server;
  StreamRequest request;
  std::unique_ptr<test::RawClient> first;
};

TEST(Stream, WaitsForAPlaceAgainWhenTheLinkIsLost) {
  TakenServer taken;
  StreamObserver observer;
  std::atomic<bool> waiting{false};
  std::vector<std::string> links;
  observer.on_link = [&](const std::string& message) {
    links.push_back(message);
    waiting = true;
  };
  const Result<StreamOutcome> outcome = taken.stream(
      observer, [&] { return waiting.load(); },
      [&] {
        taken.server.reset();
        taken.server = std::make_unique<test::RunningServer>(taken.options);
      });
  ASSERT_TRUE(outcome.ok()) << outcome.error().message;
  EXPECT_EQ(outcome->progress.processed_frames, kFrameCount);
  EXPECT_EQ(outcome->progress.resumed_count, 0u);
  ASSERT_GE(links.size(), 2u);
  EXPECT_THAT(links[0], HasSubstr("no place on the server yet"));
  EXPECT_THAT(links[1], HasSubstr("connection lost while waiting for a place"));
}

TEST(Stream, AnInterruptEndsTheWaitForAServerThatIsGone) {
  TakenServer taken;
  StreamObserver observer;
  std::atomic<int> links{0};
  observer.on_link = [&](const std::string&) { ++links; };
  observer.interrupt_count = [&] { return links >= 2 ? 1 : 0; };
  const Result<StreamOutcome> outcome = taken.stream(
      observer, [&] { return links >= 1; }, [&] { taken.server.reset(); });
  ASSERT_FALSE(outcome.ok());
  EXPECT_THAT(outcome.error().message, HasSubstr("interrupted before the scan began"));
}

TEST(Stream, GoesOnWithTheNextServerAndTheResultIsTheSame) {
  const auto sequence = synthetic_room();
  const Expected expected = local_run(*sequence);
  const test::TemporaryFolder folder;
  server::ServiceOptions options = TestServer::options(folder.path(), 2);
  auto server = std::make_unique<test::RunningServer>(options);
  StreamRequest request;
  request.server = {"127.0.0.1", static_cast<std::uint16_t>(server->port()), server->token()};
  request.settings = {{"output.unstable", "true"}};
  options.listen = "127.0.0.1:" + std::to_string(server->port());
  StreamObserver observer;
  std::atomic<bool> under_way{false};
  std::vector<std::string> links;
  observer.on_progress = [&](const StreamProgress& progress) {
    under_way = progress.processed_frames >= 2;
  };
  observer.on_link = [&](const std::string& message) { links.push_back(message); };
  std::optional<Result<StreamOutcome>> outcome;
  std::thread streaming(
      [&] { outcome = stream_sequence(*sequence, all_of(*sequence), request, observer); });
  for (int i = 0; i < 60'000 && !under_way; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  server.reset();
  server = std::make_unique<test::RunningServer>(options);
  streaming.join();
  ASSERT_TRUE(outcome->ok()) << outcome->error().message;
  EXPECT_EQ((*outcome)->trajectory_tum, expected.trajectory_tum);
  EXPECT_EQ(cloud_sha256(**outcome), expected.cloud_sha256);
  EXPECT_EQ((*outcome)->progress.resumed_count, 1u);
  EXPECT_EQ((*outcome)->progress.processed_frames, kFrameCount);
  EXPECT_EQ((*outcome)->progress.sent_frames, kFrameCount);
  ASSERT_EQ(links.size(), 2u);
  EXPECT_THAT(links[1], HasSubstr("connected again"));
}

}  // namespace
}  // namespace hermite::client
