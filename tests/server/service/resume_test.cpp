// Cameras that lose their connection, and servers that die: what is told, what is kept, and that
// the result is the same.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>
#include <utility>

#include "core/digest/sha256.h"
#include "core/log/frame_log.h"
#include "core/log/frame_log_format.h"
#include "server/disk/log_readers.h"
#include "server/scan/checkpoint_file.h"
#include "server/scan/scan_record.h"
#include "server/store/chunk_file.h"
#include "server/store/scan_id.h"
#include "server/store/secret.h"
#include "server/store/store.h"
#include "tests/support/file_bytes.h"
#include "tests/support/scan_server_test.h"

namespace hermite::server {
namespace {

using Json = nlohmann::json;
using test::kFrameCount;
using test::RawClient;
using test::room;
using test::room_frame;
using testing::HasSubstr;

wire::StartScan request() {
  return {"a test",
          room().camera(),
          {wire::DepthCodec::kRvlZstd},
          {wire::ColorCodec::kPng},
          wire::Mode::kBatch,
          {{"output.unstable", "true"}},
          kFrameCount};
}

std::string read_file(const std::string& path) {
  const std::vector<std::uint8_t> bytes = test::file_bytes(path);
  return {bytes.begin(), bytes.end()};
}

void write_file(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

class ResumeTest : public test::ScanServerTest {
 protected:
  void SetUp() override {
    ScanServerTest::SetUp();
    if (!IsSkipped()) serve(120);
  }

  void serve(int resume_window_s, int max_scans = 4, int checkpoint_period_ms = 0) {
    ScanServerTest::serve([&](ServiceOptions& options) {
      options.resume_window_s = resume_window_s;
      options.checkpoint_period_ms = checkpoint_period_ms;
      options.max_scans = max_scans;
      options.admin_listen = "127.0.0.1:0";
    });
  }

  std::unique_ptr<RawClient> start() {
    auto client = hello(request());
    const auto welcome = client->read<wire::Welcome>();
    EXPECT_TRUE(welcome);
    if (welcome) welcome_ = *welcome;
    return client;
  }
  std::unique_ptr<RawClient> resume(std::uint64_t next_sequence) {
    return hello(wire::ResumeScan{welcome_.scan_id, welcome_.resume_token, next_sequence});
  }
  static void send(RawClient& client, int begin, int end) {
    for (int i = begin; i < end; ++i) client.send_message(room_frame(i));
  }
  static bool wait_for_durable(RawClient& client, std::uint64_t count) {
    while (const auto credit = client.read<wire::Credit>())
      if (credit->durable_frames >= count) return true;
    return false;
  }
  // The result of an undisturbed scan.
  const Json& undisturbed() {
    if (undisturbed_.is_null()) {
      const auto client = start();
      send(*client, 0, kFrameCount);
      client->send_message(wire::Finish{});
      const auto finished = client->read<wire::Finished>();
      EXPECT_TRUE(finished);
      if (finished) undisturbed_ = Json::parse(finished->report_json);
    }
    return undisturbed_;
  }
  void expect_undisturbed(const wire::Finished& finished, const Json& expected) {
    const Json report = Json::parse(finished.report_json);
    EXPECT_EQ(report["frames"], kFrameCount);
    EXPECT_EQ(report["trajectory_sha256"], expected["trajectory_sha256"]);
    EXPECT_EQ(report["cloud_sha256"], expected["cloud_sha256"]);
  }
  ScanRow row(const std::string& id) {
    server_->stop();
    Store store(folder_ / "data/hermite.db");
    const auto found = store.scans.find(id);
    EXPECT_TRUE(found.ok());
    return found.ok() ? *found : ScanRow{};
  }
  std::string checkpoint() const {
    return folder_ / "data/scans/" + welcome_.scan_id + "/" + kCheckpointName;
  }
  // A scan of four frames that a server has left with a checkpoint, when it was stopped.
  void leave_four_frames() {
    serve(120, 4, 3'600'000);
    const auto client = start();
    send(*client, 0, 4);
    for (int i = 0; i < 4; ++i) EXPECT_TRUE(client->read<wire::FrameResult>());
    EXPECT_FALSE(std::filesystem::exists(checkpoint())) << "it is not due yet";
    server_->stop();
    EXPECT_TRUE(std::filesystem::exists(checkpoint()));
  }
  // The sequence of the first result that the next server tells of.
  std::uint64_t finish_and_compare(const Json& expected) {
    serve(120, 4, 3'600'000);
    const auto client = resume(4);
    EXPECT_TRUE(client->read<wire::Resumed>());
    send(*client, 4, kFrameCount);
    client->send_message(wire::Finish{});
    const auto first = client->read<wire::FrameResult>();
    const auto finished = client->read<wire::Finished>();
    EXPECT_TRUE(first && finished);
    if (finished) expect_undisturbed(*finished, expected);
    EXPECT_FALSE(std::filesystem::exists(checkpoint()))
        << "nobody goes on with a scan that has ended";
    return first ? first->sequence : kFrameCount;
  }
  std::string metrics() {
    RawClient admin(server_->service().admin_port());
    admin.send("GET /metrics HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
    return admin.read_to_end();
  }
  std::string chunks_of(const std::string& scan_id) const {
    return read_file(folder_ / "data/scans/" + scan_id + "/" + kChunksName);
  }
  std::string log_folder() const { return folder_ / "data/scans/" + welcome_.scan_id + "/log"; }

  wire::Welcome welcome_;
  Json undisturbed_;
};

TEST_F(ResumeTest, ALostCameraGoesOnWhereItWas) {
  const Json expected = undisturbed();
  auto client = start();
  EXPECT_EQ(welcome_.resume_token.size(), 32u);
  EXPECT_EQ(welcome_.resume_window_s, 120u);
  send(*client, 0, 3);
  ASSERT_TRUE(wait_for_durable(*client, 3));
  client->drop();
  client = resume(1);
  const auto resumed = client->read<wire::Resumed>();
  ASSERT_TRUE(resumed);
  EXPECT_EQ(resumed->next_sequence, 3u);
  EXPECT_EQ(resumed->durable_frames, 3u);
  EXPECT_GE(resumed->frames_granted, 16u);
  send(*client, 3, kFrameCount);
  client->send_message(wire::Finish{});
  const auto finished = client->read<wire::Finished>();
  ASSERT_TRUE(finished);
  expect_undisturbed(*finished, expected);
  EXPECT_EQ(client->close_code(), 1000);
}

TEST_F(ResumeTest, TheNewerConnectionWinsAndTheOlderIsTold) {
  const auto older = start();
  send(*older, 0, 2);
  ASSERT_TRUE(wait_for_durable(*older, 2));
  const auto newer = resume(2);
  ASSERT_TRUE(newer->read<wire::Resumed>());
  const auto error = older->read<wire::ErrorMessage>();
  ASSERT_TRUE(error);
  EXPECT_THAT(error->message, HasSubstr("another connection"));
  EXPECT_EQ(older->close_code(), 4009);
  send(*newer, 2, kFrameCount);
  newer->send_message(wire::Finish{});
  EXPECT_TRUE(newer->read<wire::Finished>()) << "the end of the older one has ended nothing";
}

TEST_F(ResumeTest, WhoMayNotResumeIsToldWhy) {
  auto client = start();
  const wire::ResumeScan good{welcome_.scan_id, welcome_.resume_token, 0};
  wire::ResumeScan wrong_token = good, no_scan = good, no_id = good;
  wrong_token.resume_token = std::string(32, '0');
  no_scan.scan_id = new_scan_id();
  no_id.scan_id = "../../etc/passwd";
  const std::pair<wire::ResumeScan, int> cases[] = {
      {wrong_token, 4001}, {no_scan, 4004}, {no_id, 4004}};
  for (const auto& [role, code] : cases) {
    const auto refused = hello(role);
    const auto answer = refused->read<wire::NotResumed>();
    ASSERT_TRUE(answer);
    EXPECT_FALSE(answer->reason.empty());
    EXPECT_EQ(refused->close_code(), code);
  }
  send(*client, 0, 1);
  EXPECT_TRUE(client->read<wire::FrameResult>()) << "the camera itself is not disturbed";
}

TEST_F(ResumeTest, AfterTheWindowTheScanIsInterruptedAndSaysSo) {
  serve(1);
  auto client = start();
  send(*client, 0, 2);
  ASSERT_TRUE(wait_for_durable(*client, 2));
  const auto viewer = hello(wire::ViewScan{welcome_.scan_id});
  ASSERT_TRUE(viewer->read<wire::SnapshotEnd>());
  client->drop();
  bool paused = false;
  std::optional<wire::ScanState> state;
  while ((state = viewer->read<wire::ScanState>()) && state->phase == wire::ScanPhase::kRunning) {
    paused = paused || state->paused;
    if (state->paused) {
      EXPECT_THAT(state->message, HasSubstr("waiting for the camera"));
    }
  }
  EXPECT_TRUE(paused);
  ASSERT_TRUE(state);
  EXPECT_EQ(state->phase, wire::ScanPhase::kInterrupted);
  const auto late = resume(2);
  const auto answer = late->read<wire::NotResumed>();
  ASSERT_TRUE(answer);
  EXPECT_THAT(answer->reason, HasSubstr("interrupted"));
}

TEST_F(ResumeTest, ACameraThatWasAwayAtTheEndGetsTheResult) {
  const Json expected = undisturbed();
  auto client = start();
  send(*client, 0, kFrameCount);
  client->send_message(wire::Finish{});
  ASSERT_TRUE(client->read<wire::FrameResult>());
  client->drop();
  // The same whether it still runs or has ended, or ended under another server.
  for (int i = 0; i < 2; ++i) {
    client = resume(kFrameCount);
    ASSERT_TRUE(client->read<wire::Resumed>());
    client->send_message(wire::Finish{});
    const auto finished = client->read<wire::Finished>();
    ASSERT_TRUE(finished);
    expect_undisturbed(*finished, expected);
    EXPECT_EQ(client->close_code(), 1000);
    if (i == 0) serve(120);
  }
}

TEST_F(ResumeTest, AServerThatStopsSaysGoAwayAndTheNextOneGoesOn) {
  const Json expected = undisturbed();
  auto client = start();
  send(*client, 0, 4);
  ASSERT_TRUE(client->read<wire::FrameResult>());
  std::thread stopping([this] { EXPECT_TRUE(server_->stop()); });
  EXPECT_TRUE(client->read<wire::GoAway>());
  EXPECT_EQ(client->close_code(), 1001);
  stopping.join();
  EXPECT_EQ(row(welcome_.scan_id).phase, ScanPhase::kRunning);
  serve(120);
  client = resume(0);
  const auto resumed = client->read<wire::Resumed>();
  ASSERT_TRUE(resumed);
  EXPECT_EQ(resumed->next_sequence, 4u) << "what was received was written before the end";
  send(*client, 4, kFrameCount);
  client->send_message(wire::Finish{});
  const auto finished = client->read<wire::Finished>();
  ASSERT_TRUE(finished);
  expect_undisturbed(*finished, expected);
}

TEST_F(ResumeTest, TheNextServerGoesOnFromTheCheckpoint) {
  const Json expected = undisturbed();
  const std::string undisturbed_id = welcome_.scan_id;
  leave_four_frames();
  EXPECT_EQ(finish_and_compare(expected), 4u) << "frames were worked through again";
  const std::string now = metrics();
  for (const char* line : {"hermite_scans_rebuilt_total{from=\"checkpoint\"} 1\n",
                           "hermite_scans_rebuilt_total{from=\"replay\"} 0\n",
                           "hermite_frames_rebuilt_total{from=\"checkpoint\"} 4\n",
                           "hermite_frames_rebuilt_total{from=\"replay\"} 0\n"})
    EXPECT_THAT(now, HasSubstr(line));
  EXPECT_THAT(now, testing::Not(HasSubstr("hermite_scan_gpu_memory_bytes 0\n")))
      << "the scan has ended, and what it took is known";
  EXPECT_EQ(chunks_of(welcome_.scan_id), chunks_of(undisturbed_id)) << "viewers see the same";
}

TEST_F(ResumeTest, ViewersOfARestoredScanGetAllOfIt) {
  leave_four_frames();
  serve(120, 4, 3'600'000);
  ASSERT_TRUE(resume(4)->read<wire::Resumed>());
  const auto viewer = hello(wire::ViewScan{welcome_.scan_id});
  const auto past = viewer->read<wire::TrajectoryPart>();
  ASSERT_TRUE(past);
  EXPECT_EQ(past->positions_m.size(), 4 * 3u);
  EXPECT_EQ(past->submaps.size(), 4u);
  const auto chunk = viewer->read<wire::Chunk>();
  ASSERT_TRUE(chunk) << "without a new frame";
  EXPECT_GT(chunk->point_count, 0u);
}

TEST_F(ResumeTest, WhileItRunsAScanIsStoredNowAndThen) {
  serve(120, 4, 1);
  const auto client = start();
  send(*client, 0, kFrameCount);
  for (int i = 0; i < kFrameCount; ++i) ASSERT_TRUE(client->read<wire::FrameResult>());
  for (int i = 0; i < 1000 && !std::filesystem::exists(checkpoint()); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  const Result<ScanCheckpoint> stored = parse_checkpoint(read_file(checkpoint()));
  ASSERT_TRUE(stored.ok()) << stored.error().message;
  EXPECT_EQ(stored->scan_id, welcome_.scan_id);
  EXPECT_GT(stored->record_count, kRecordsBeforeFrames);
  client->send_message(wire::Discard{});
  for (int i = 0; i < 1000 && std::filesystem::exists(checkpoint()); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_FALSE(std::filesystem::exists(checkpoint())) << "of a discarded scan nothing is left";
}

TEST_F(ResumeTest, ACheckpointThatCannotBeUsedOnlyCostsTime) {
  const Json expected = undisturbed();
  const auto write = [this](const std::string& bytes) { write_file(checkpoint(), bytes); };
  const auto rewrite = [&](const std::function<void(ScanCheckpoint&)>& change) {
    Result<ScanCheckpoint> stored = parse_checkpoint(read_file(checkpoint()));
    ASSERT_TRUE(stored.ok());
    change(*stored);
    write(format_checkpoint(*stored));
  };
  const std::function<void()> spoilers[] = {
      [&] { write(read_file(checkpoint()).substr(0, 1000)); },
      [&] {
        // Of other settings.
        rewrite([](ScanCheckpoint& stored) {
          ++stored.pipeline[stored.pipeline.find("track.geometric_weight") + 6];
        });
      },
      [&] {
        rewrite([](ScanCheckpoint& stored) { stored.pipeline.resize(stored.pipeline.size() / 2); });
      },
      [&] { rewrite([](ScanCheckpoint& stored) { stored.record_count = 100; }); },
      [&] { rewrite([](ScanCheckpoint& stored) { stored.record_count = 3; }); },
      [&] { rewrite([](ScanCheckpoint& stored) { stored.scan_id = "another"; }); },
  };
  for (const std::function<void()>& spoil : spoilers) {
    leave_four_frames();
    spoil();
    EXPECT_EQ(finish_and_compare(expected), 0u) << "all frames are worked through again";
    EXPECT_THAT(metrics(),
                testing::AllOf(HasSubstr("hermite_scans_rebuilt_total{from=\"replay\"} 1\n"),
                               HasSubstr("hermite_frames_rebuilt_total{from=\"replay\"} 4\n")));
  }
}

// What a dead server leaves: a row that says running, and a log that may be cut anywhere.
TEST_F(ResumeTest, ALogWithACutTailIsGoneOnWithFromItsLastWholeFrame) {
  const Json expected = undisturbed();
  auto client = start();
  send(*client, 0, 4);
  ASSERT_TRUE(wait_for_durable(*client, 4));
  server_->stop();
  const std::string segment = log_folder() + "/" + frame_log::segment_name(0);
  std::filesystem::resize_file(segment, std::filesystem::file_size(segment) - 100);
  serve(120);
  client = resume(1);
  const auto resumed = client->read<wire::Resumed>();
  ASSERT_TRUE(resumed);
  EXPECT_EQ(resumed->next_sequence, 3u);
  send(*client, 3, kFrameCount);
  client->send_message(wire::Finish{});
  const auto finished = client->read<wire::Finished>();
  ASSERT_TRUE(finished);
  expect_undisturbed(*finished, expected);
}

TEST_F(ResumeTest, FramesThatTheDiskHasLostAndTheCameraTooEndTheScanWithAMessage) {
  auto client = start();
  send(*client, 0, 4);
  ASSERT_TRUE(wait_for_durable(*client, 4));
  server_->stop();
  const std::string segment = log_folder() + "/" + frame_log::segment_name(0);
  std::filesystem::resize_file(segment, std::filesystem::file_size(segment) - 100);
  serve(120);
  client = resume(4);
  const auto answer = client->read<wire::NotResumed>();
  ASSERT_TRUE(answer);
  EXPECT_THAT(answer->reason, HasSubstr("the disk has lost"));
}

TEST_F(ResumeTest, AFinishedLogIsWorkedOffWithoutItsCamera) {
  const Json expected = undisturbed();
  auto client = start();
  send(*client, 0, kFrameCount);
  ASSERT_TRUE(wait_for_durable(*client, kFrameCount));
  server_->stop();
  {
    auto opened =
        frame_log::FrameLog::open(log_folder(), {[](std::uint64_t) {}, [](const Error&) {}});
    ASSERT_TRUE(opened.ok()) << opened.error().message;
    ASSERT_TRUE(opened->log->append(frame_log::RecordType::kFinish, "").ok());
  }
  serve(0);
  ScanRow found;
  for (int i = 0; i < 600 && found.phase == ScanPhase::kRunning; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    client = resume(kFrameCount);
    const auto finished = client->read<wire::Finished>();
    if (!finished) continue;
    expect_undisturbed(*finished, expected);
    found.phase = ScanPhase::kFinished;
  }
  EXPECT_EQ(found.phase, ScanPhase::kFinished);
}

TEST_F(ResumeTest, RefusedFramesAndBadImagesAreTheSameAfterARestart) {
  wire::Frame frames[kFrameCount];
  for (int i = 0; i < kFrameCount; ++i) frames[i] = room_frame(i);
  frames[1].depth = "garbage";
  frames[2].timestamp_s = frames[0].timestamp_s;
  std::string hashes[2];
  for (const bool disturbed : {false, true}) {
    auto client = start();
    for (int i = 0; i < 4; ++i) client->send_message(frames[i]);
    ASSERT_TRUE(wait_for_durable(*client, 4));
    if (disturbed) {
      serve(120);
      client = resume(4);
      ASSERT_TRUE(client->read<wire::Resumed>());
    }
    wire::Frame back_in_time = frames[4];
    back_in_time.timestamp_s = frames[3].timestamp_s;
    client->send_message(back_in_time);
    const auto error = [&]() -> std::optional<wire::ErrorMessage> {
      while (const auto said = client->read<wire::ErrorMessage>())
        if (said->sequence == 4) return said;
      return std::nullopt;
    }();
    ASSERT_TRUE(error) << "the time of the last frame is known after a restart";
    client->send_message(frames[5]);
    client->send_message(wire::Finish{});
    const auto finished = client->read<wire::Finished>();
    ASSERT_TRUE(finished);
    const Json report = Json::parse(finished->report_json);
    EXPECT_EQ(report["frames"], 4);
    hashes[disturbed] =
        report["trajectory_sha256"].get<std::string>() + report["cloud_sha256"].get<std::string>();
  }
  EXPECT_EQ(hashes[0], hashes[1]);
}

TEST_F(ResumeTest, ARevokedTokenEndsTheConnectionAndAnotherTokenGoesOnWithTheScan) {
  server_->stop();
  {
    Store store(folder_ / "data/hermite.db");
    const auto add = [&store](const std::string& secret, const Scopes& scopes) {
      TokenRow token;
      token.id = token.name = secret;
      token.secret_sha256 = digest::sha256(secret);
      token.scopes = scopes;
      EXPECT_TRUE(store.tokens.add(token).ok());
    };
    add("camera", {false, true, false});
    add("spare", {false, true, false});
    add("viewer", {true, false, false});
  }
  serve(120);
  auto camera = hello_with("camera", request());
  const auto welcome = camera->read<wire::Welcome>();
  ASSERT_TRUE(welcome);
  welcome_ = *welcome;
  send(*camera, 0, 2);
  ASSERT_TRUE(wait_for_durable(*camera, 2));
  RawClient administrator(server_->port());
  administrator.send(
      "DELETE /api/v1/tokens/camera HTTP/1.1\r\nHost: localhost\r\nConnection: "
      "close\r\nAuthorization: Bearer " +
      server_->token() + "\r\n\r\n");
  EXPECT_THAT(administrator.read_to_end(), HasSubstr(" 200 "));
  EXPECT_EQ(camera->close_code(), 4001);
  const wire::ResumeScan back{welcome_.scan_id, welcome_.resume_token, 2};
  EXPECT_EQ(hello_with("camera", back)->close_code(), 4001);
  EXPECT_EQ(hello_with("viewer", back)->close_code(), 4003);
  EXPECT_EQ(hello_with("spare", wire::ResumeScan{welcome_.scan_id, "wrong", 2})->close_code(),
            4001);
  camera = hello_with("spare", back);
  const auto resumed = camera->read<wire::Resumed>();
  ASSERT_TRUE(resumed);
  EXPECT_EQ(resumed->next_sequence, 2u);
  send(*camera, 2, kFrameCount);
  camera->send_message(wire::Finish{});
  const auto finished = camera->read<wire::Finished>();
  ASSERT_TRUE(finished);
  EXPECT_EQ(Json::parse(finished->report_json)["frames"], kFrameCount);
}

TEST_F(ResumeTest, TheFramesOfAScanThatEndedLongAgoGoAndItsResultsStay) {
  undisturbed();
  ScanRow ended = row(welcome_.scan_id);
  const std::string cloud = folder_ / "data/scans/" + welcome_.scan_id + "/cloud.ply";
  serve(120);
  EXPECT_TRUE(std::filesystem::exists(log_folder())) << "it has just ended";
  server_->stop();
  ended.finished_at_ms -= std::int64_t{8} * 24 * 3600 * 1000;
  {
    Store store(folder_ / "data/hermite.db");
    ASSERT_TRUE(store.scans.update(ended).ok());
  }
  serve(120);
  for (int i = 0; i < 1000 && std::filesystem::exists(log_folder()); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_FALSE(std::filesystem::exists(log_folder()));
  EXPECT_TRUE(std::filesystem::exists(cloud));
  const auto late = resume(kFrameCount);
  const auto answer = late->read<wire::NotResumed>();
  ASSERT_TRUE(answer);
  EXPECT_THAT(answer->reason, HasSubstr("log is gone"));
}

TEST_F(ResumeTest, MoreScansWereLeftThanThereArePlacesForAndGoOnOneAfterTheOther) {
  std::vector<wire::Welcome> left;
  std::vector<std::unique_ptr<RawClient>> cameras;
  for (int i = 0; i < 2; ++i) {
    cameras.push_back(start());
    left.push_back(welcome_);
    send(*cameras.back(), 0, 2);
    ASSERT_TRUE(wait_for_durable(*cameras.back(), 2));
    std::this_thread::sleep_for(std::chrono::milliseconds(5));  // one is the older by the clock
  }
  serve(120, 1);
  welcome_ = left[1];
  EXPECT_TRUE(resume(2)->read<wire::GoAway>());
  welcome_ = left[0];
  auto camera = resume(2);
  ASSERT_TRUE(camera->read<wire::Resumed>());
  send(*camera, 2, kFrameCount);
  camera->send_message(wire::Finish{});
  ASSERT_TRUE(camera->read<wire::Finished>());
  welcome_ = left[1];
  camera = resume(2);
  const auto resumed = camera->read<wire::Resumed>();
  ASSERT_TRUE(resumed);
  EXPECT_EQ(resumed->next_sequence, 2u);
}

// Logs that cannot be read to their end: pipes that nobody writes to, as disks are that do not
// answer.
class SlowLogsTest : public ResumeTest {
 protected:
  void SetUp() override {
    ResumeTest::SetUp();
    if (IsSkipped()) return;
    auto client = start();
    send(*client, 0, 2);
    ASSERT_TRUE(wait_for_durable(*client, 2));
    server_->stop();
    block();
    serve(120);
  }
  void TearDown() override { let_go(); }
  void block() {
    const std::string segment = log_folder() + "/" + frame_log::segment_name(0);
    std::filesystem::rename(segment, segment + ".whole");
    ASSERT_EQ(mkfifo(segment.c_str(), 0600), 0);
    segment_ = segment;
  }
  // Whether within that time somebody opens the log and waits for what it says; who does waits
  // until it is let go.
  bool is_read_within(const std::string& pipe, std::chrono::milliseconds patience) {
    const auto end = std::chrono::steady_clock::now() + patience;
    while (writer_ < 0 && std::chrono::steady_clock::now() < end) {
      writer_ = open(pipe.c_str(), O_WRONLY | O_NONBLOCK);
      if (writer_ < 0) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return writer_ >= 0;
  }
  // The log can be read again by those who open it now; whoever waits finds an empty one.
  void let_go() {
    if (segment_.empty()) return;
    std::filesystem::rename(segment_, segment_ + ".pipe");
    std::filesystem::rename(segment_ + ".whole", segment_);
    if (is_read_within(segment_ + ".pipe", std::chrono::seconds(1)))
      close(std::exchange(writer_, -1));
    segment_.clear();
  }
  std::string get(const std::string& path) {
    RawClient client(server_->port());
    client.send("GET " + path +
                " HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\nAuthorization: Bearer " +
                server_->token() + "\r\n\r\n");
    return client.read_to_end();
  }
  std::string segment_;
  int writer_ = -1;  // of its pipe
};

TEST_F(SlowLogsTest, DoNotKeepTheServerFromStarting) {
  EXPECT_THAT(get("/healthz"), testing::StartsWith("HTTP/1.1 200"));
  EXPECT_THAT(get("/api/v1/scans"), HasSubstr("\"state\":\"running\""));
  const wire::Welcome old = welcome_;
  const auto other = start();
  send(*other, 0, kFrameCount);
  other->send_message(wire::Finish{});
  EXPECT_TRUE(other->read<wire::Finished>()) << "another scan runs meanwhile";
  EXPECT_EQ(hello(wire::ViewScan{old.scan_id})->close_code(), 4013);
}

TEST_F(SlowLogsTest, LetTheCameraComeBackLater) {
  const auto asked_at = std::chrono::steady_clock::now();
  const auto camera = resume(0);
  EXPECT_TRUE(camera->read<wire::GoAway>());
  EXPECT_EQ(camera->close_code(), 1001);
  const auto waited = std::chrono::steady_clock::now() - asked_at;
  EXPECT_GE(waited, kReadPatience - std::chrono::milliseconds(500));
  EXPECT_LT(waited, std::chrono::seconds(10)) << "longer than clients wait";
}

TEST_F(SlowLogsTest, AreSaidToBeBadWhenTheyTurnOutToBe) {
  auto camera = resume(0);
  ASSERT_TRUE(is_read_within(segment_, std::chrono::seconds(10)))
      << "else it would find the whole log";
  let_go();
  const auto answer = camera->read<wire::NotResumed>();
  ASSERT_TRUE(answer);
  EXPECT_THAT(answer->reason, HasSubstr("interrupted"));
}

TEST_F(SlowLogsTest, OfScansThatHaveEndedKeepOnlyTheirCamerasWaiting) {
  auto camera = resume(0);
  ASSERT_TRUE(is_read_within(segment_, std::chrono::seconds(10)))
      << "else it would find the whole log";
  let_go();
  ASSERT_TRUE(camera->read<wire::NotResumed>());
  block();
  camera = resume(0);
  EXPECT_THAT(get("/healthz"), testing::StartsWith("HTTP/1.1 200"));
  resume(0).reset();  // one that does not wait for the answer
  ASSERT_TRUE(is_read_within(segment_, std::chrono::seconds(10)));
  let_go();
  const auto answer = camera->read<wire::NotResumed>();
  ASSERT_TRUE(answer);
  EXPECT_THAT(answer->reason, HasSubstr("its log is gone"));
}

TEST_F(SlowLogsTest, TheServerEndsWhileOneIsReadAndTheNextGoesOn) {
  std::thread stopping([this] { EXPECT_TRUE(server_->stop()); });
  // It has heard of its end, and waits for the log.
  std::this_thread::sleep_for(std::chrono::seconds(1));
  let_go();
  stopping.join();
  serve(120);
  const auto camera = resume(0);
  const auto resumed = camera->read<wire::Resumed>();
  ASSERT_TRUE(resumed) << "what the last server began to read stays as it was";
  EXPECT_EQ(resumed->next_sequence, 2u);
}

TEST_F(ResumeTest, APauseIsShownAndAFrameEndsIt) {
  const auto client = start();
  client->send_message(wire::Pause{});
  auto state = client->read<wire::ScanState>();
  ASSERT_TRUE(state);
  EXPECT_TRUE(state->paused);
  client->send_message(wire::Unpause{});
  state = client->read<wire::ScanState>();
  ASSERT_TRUE(state);
  EXPECT_FALSE(state->paused);
  client->send_message(wire::Pause{});
  client->send_message(room_frame(0));
  state = client->read<wire::ScanState>();
  ASSERT_TRUE(state && state->paused);
  state = client->read<wire::ScanState>();
  ASSERT_TRUE(state);
  EXPECT_FALSE(state->paused);
}

TEST_F(ResumeTest, ADiscardedScanLeavesNothing) {
  const auto client = start();
  send(*client, 0, 2);
  ASSERT_TRUE(client->read<wire::FrameResult>());
  client->send_message(wire::Discard{});
  std::optional<wire::ScanState> state;
  while ((state = client->read<wire::ScanState>()) && state->phase == wire::ScanPhase::kRunning) {
  }
  ASSERT_TRUE(state);
  EXPECT_THAT(state->message, HasSubstr("discarded"));
  EXPECT_EQ(client->close_code(), 1000);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "data/scans/" + welcome_.scan_id));
  server_->stop();
  Store store(folder_ / "data/hermite.db");
  EXPECT_EQ(store.scans.find(welcome_.scan_id).error().code, ErrorCode::kNotFound);
}

}  // namespace
}  // namespace hermite::server
