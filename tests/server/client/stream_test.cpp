// The client against the real server, in one process.
#include "server/client/stream.h"

#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <memory>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/pipeline/pipeline.h"
#include "proto/wire/frame_payload.h"
#include "server/service/service.h"

namespace hermite {
namespace {

using testing::HasSubstr;
using Json = nlohmann::json;

constexpr int kFrameCount = 6;

// A server on a free port with an empty data folder, which goes when the test is over.
class RunningServer {
 public:
  explicit RunningServer(int credit_window = 16) : folder_(make_folder()), service_(options(folder_, credit_window)) {
    thread_ = std::thread([this] { service_.run(); });
  }
  ~RunningServer() {
    service_.stop();
    thread_.join();
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  void stop() { service_.stop(); }
  ServerUrl url() const {
    ServerUrl url = *parse_server_url(service_.url());
    url.token = service_.token();
    return url;
  }

 private:
  static std::string make_folder() {
    std::string name = (std::filesystem::temp_directory_path() / "hermite_stream_test_XXXXXX").string();
    if (!mkdtemp(name.data())) ADD_FAILURE() << "no temporary folder " << name;
    return name;
  }
  static ServiceOptions options(const std::string& folder, int credit_window) {
    ServiceOptions options;
    options.listen = "127.0.0.1:0";
    options.data_folder = folder;
    options.credit_window = credit_window;
    options.stop_on_signals = false;
    return options;
  }

  std::string folder_;
  Service service_;
  std::thread thread_;
};

// Another sequence, one of whose frames cannot be read, as when a file is missing.
class WithAHole final : public Sequence {
 public:
  WithAHole(const Sequence& whole, std::int64_t hole) : whole_(whole), hole_(hole) {}
  std::string format() const override { return whole_.format(); }
  std::string name() const override { return whole_.name(); }
  const Camera& camera() const override { return whole_.camera(); }
  double frame_rate_hz() const override { return whole_.frame_rate_hz(); }
  std::int64_t frame_count() const override { return whole_.frame_count(); }
  double timestamp_s(std::int64_t index) const override { return whole_.timestamp_s(index); }
  Result<RecordedFrame> read(std::int64_t index) const override {
    if (index == hole_) return Error{ErrorCode::kIo, "the file is gone"};
    return whole_.read(index);
  }
  const Trajectory& groundtruth() const override { return whole_.groundtruth(); }

 private:
  const Sequence& whole_;
  const std::int64_t hole_;
};

std::unique_ptr<Sequence> synthetic_room() {
  return *open_sequence("synthetic:frames=" + std::to_string(kFrameCount) + ",width=160,height=120");
}

StreamRequest request_for(const RunningServer& server, const Sequence& sequence) {
  StreamRequest request;
  request.server = server.url();
  request.title = "a test";
  request.frames = {0, sequence.frame_count()};
  return request;
}

// The trajectory of a run without a server.
std::string local_trajectory(const Sequence& sequence) {
  Pipeline pipeline("", sequence.camera(), {});
  for (std::int64_t index = 0; index < sequence.frame_count(); ++index) {
    auto recorded = sequence.read(index);
    const RgbdFrame frame =
        recorded.ok() ? *decode_frame(*std::move(recorded)) : wire::empty_frame(sequence.timestamp_s(index), sequence.camera());
    EXPECT_TRUE(pipeline.process(frame).ok());
  }
  return format_tum_trajectory(pipeline.trajectory());
}

std::int64_t pose_count(const std::string& trajectory_tum) {
  return static_cast<std::int64_t>(parse_tum_trajectory(trajectory_tum)->size());
}

TEST(Stream, GivesWhatALocalRunGivesForAnyCreditWindow) {
  const auto sequence = synthetic_room();
  const std::string expected = local_trajectory(*sequence);
  for (const int credit_window : {1, 3, 16}) {
    const RunningServer server(credit_window);
    const auto outcome = stream_sequence(*sequence, request_for(server, *sequence), {});
    ASSERT_TRUE(outcome.ok()) << outcome.error().message;
    EXPECT_EQ(outcome->trajectory_tum, expected) << "credit window " << credit_window;
    EXPECT_EQ(outcome->progress.sent_frames, kFrameCount);
    EXPECT_EQ(outcome->progress.processed_frames, kFrameCount);
    EXPECT_EQ(outcome->progress.dropped_frames, 0u);
    EXPECT_EQ(outcome->progress.unknown_messages, 0u);
    const Json report = Json::parse(outcome->report_json);
    EXPECT_EQ(report["frames"], kFrameCount);
    EXPECT_EQ(report["tracked_frames"].get<std::uint64_t>(), outcome->progress.tracked_frames);
  }
}

TEST(Stream, TwoScansAtOnceAreTheSameAsOne) {
  const auto sequence = synthetic_room();
  const std::string expected = local_trajectory(*sequence);
  const RunningServer server(2);
  std::string hashes[2];
  const auto stream = [&](std::string& hash) {
    const auto outcome = stream_sequence(*sequence, request_for(server, *sequence), {});
    ASSERT_TRUE(outcome.ok()) << outcome.error().message;
    EXPECT_EQ(outcome->trajectory_tum, expected);
    hash = Json::parse(outcome->report_json)["cloud_sha256"].get<std::string>();
  };
  std::thread other([&] { stream(hashes[0]); });
  stream(hashes[1]);
  other.join();
  EXPECT_NE(hashes[0], "");
  EXPECT_EQ(hashes[0], hashes[1]);
}

TEST(Stream, AFrameThatCannotBeReadStillHasItsLineAndIsReported) {
  const auto whole = synthetic_room();
  const WithAHole sequence(*whole, 2);
  const std::string expected = local_trajectory(sequence);
  const RunningServer server;
  std::vector<std::string> problems;
  StreamObserver observer;
  observer.on_problem = [&](const std::string& words) { problems.push_back(words); };
  const auto outcome = stream_sequence(sequence, request_for(server, sequence), observer);
  ASSERT_TRUE(outcome.ok()) << outcome.error().message;
  EXPECT_EQ(outcome->trajectory_tum, expected);
  EXPECT_EQ(pose_count(outcome->trajectory_tum), kFrameCount);
  EXPECT_THAT(problems, testing::ElementsAre(HasSubstr("frame 2: the file is gone")));
  EXPECT_EQ(outcome->progress.problem_frames, 1u);
}

TEST(Stream, ALiveCameraAccountsForEveryFrame) {
  const auto sequence = synthetic_room();
  const RunningServer server(1);
  StreamRequest request = request_for(server, *sequence);
  request.pacing = {.rate_hz = 1000, .newest_wins = true};
  const auto outcome = stream_sequence(*sequence, request, {});
  ASSERT_TRUE(outcome.ok()) << outcome.error().message;
  const StreamProgress& progress = outcome->progress;
  EXPECT_EQ(progress.sent_frames + progress.dropped_frames, kFrameCount);
  EXPECT_EQ(progress.processed_frames + progress.server_dropped_frames, progress.sent_frames);
  EXPECT_EQ(pose_count(outcome->trajectory_tum), static_cast<std::int64_t>(progress.processed_frames));
}

TEST(Stream, AWrongTokenIsSaidInWords) {
  const auto sequence = synthetic_room();
  const RunningServer server;
  StreamRequest request = request_for(server, *sequence);
  request.server.token = "not the token";
  const auto outcome = stream_sequence(*sequence, request, {});
  ASSERT_FALSE(outcome.ok());
  EXPECT_EQ(outcome.error().code, ErrorCode::kUnauthorized);
  EXPECT_THAT(outcome.error().message, HasSubstr("token"));
}

TEST(Stream, AServerThatIsNotThereIsSaidInWords) {
  const auto sequence = synthetic_room();
  StreamRequest request;
  {
    const RunningServer gone;
    request = request_for(gone, *sequence);
  }
  const auto outcome = stream_sequence(*sequence, request, {});
  ASSERT_FALSE(outcome.ok());
  EXPECT_THAT(outcome.error().message, HasSubstr("cannot connect to " + request.server.host_and_port()));
}

TEST(Stream, ASettingThatTheServerRefusesIsNamed) {
  const auto sequence = synthetic_room();
  const RunningServer server;
  StreamRequest request = request_for(server, *sequence);
  request.settings = {{"no.such_setting", "1"}};
  const auto outcome = stream_sequence(*sequence, request, {});
  ASSERT_FALSE(outcome.ok());
  EXPECT_THAT(outcome.error().message, HasSubstr("no.such_setting"));
}

TEST(Stream, AnInterruptFinishesWithTheFramesSentSoFar) {
  const auto sequence = synthetic_room();
  const RunningServer server(1);
  std::atomic<int> interrupts{0};
  StreamObserver observer;
  observer.interrupt_count = [&] { return interrupts.load(); };
  observer.on_progress = [&](const StreamProgress& progress) {
    if (progress.processed_frames >= 2) interrupts = 1;
  };
  const auto outcome = stream_sequence(*sequence, request_for(server, *sequence), observer);
  ASSERT_TRUE(outcome.ok()) << outcome.error().message;
  EXPECT_GE(outcome->progress.sent_frames, 2u);
  EXPECT_LT(outcome->progress.sent_frames, kFrameCount);
  EXPECT_EQ(pose_count(outcome->trajectory_tum), static_cast<std::int64_t>(outcome->progress.sent_frames));
}

TEST(Stream, ASecondInterruptGivesUp) {
  const auto sequence = synthetic_room();
  const RunningServer server(1);
  std::atomic<int> interrupts{0};
  StreamObserver observer;
  observer.interrupt_count = [&] { return interrupts.load(); };
  observer.on_progress = [&](const StreamProgress&) { interrupts = 2; };
  const auto outcome = stream_sequence(*sequence, request_for(server, *sequence), observer);
  ASSERT_FALSE(outcome.ok());
  EXPECT_THAT(outcome.error().message, HasSubstr("interrupted"));
}

TEST(Stream, AServerThatStopsSaysWhy) {
  const auto sequence = synthetic_room();
  RunningServer server(1);
  StreamObserver observer;
  observer.on_progress = [&](const StreamProgress& progress) {
    if (progress.processed_frames >= 1) server.stop();
  };
  const auto outcome = stream_sequence(*sequence, request_for(server, *sequence), observer);
  ASSERT_FALSE(outcome.ok());
  EXPECT_THAT(outcome.error().message, HasSubstr("stopped"));
}

}  // namespace
}  // namespace hermite
