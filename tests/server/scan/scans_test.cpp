// Scans on a real server with a real pipeline: tiny synthetic frames, sent by hand.
#include "server/scan/scans.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <thread>

#include "core/image/image_codec.h"
#include "core/run/results.h"
#include "proto/wire/frame_payload.h"
#include "server/store/store.h"
#include "tests/support/scans_fixture.h"

namespace hermite::server {
namespace {

using Json = nlohmann::json;
using test::kFrameCount;
using test::RawClient;
using test::room;
using test::room_frame;
using testing::HasSubstr;

std::string bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

class ScansTest : public test::ScansFixture {};

// What `hermite reconstruct` makes of the same frames.
const Json& local_report() {
  static const Json report = [] {
    pipeline::Options options;
    for (const auto& [key, value] : test::kFewFramesSettings)
      EXPECT_TRUE(pipeline::apply_setting(options, key, value).ok());
    pipeline::Pipeline pipeline(
        "", room().camera(), options,
        adjust::make_mapping(room().camera(), options.adjust, adjust::CorrectionTime::kByFrames));
    for (int i = 0; i < kFrameCount; ++i)
      EXPECT_TRUE(pipeline.process(*dataset::decode_frame(*room().read(i))).ok());
    pipeline.finish();
    EXPECT_GT(pipeline.cloud()->size(), 100u) << "the comparison needs a cloud";
    return Json::parse(run::results_of(pipeline, options, {})->report_json);
  }();
  return report;
}

void expect_local_result(const wire::Finished& finished) {
  const Json report = Json::parse(finished.report_json);
  EXPECT_EQ(report["frames"], kFrameCount);
  EXPECT_EQ(report["trajectory_sha256"], local_report()["trajectory_sha256"]);
  EXPECT_EQ(report["cloud_sha256"], local_report()["cloud_sha256"]);
}

TEST_F(ScansTest, ACameraThatSendsNothingLosesItsPlace) {
  Camera silent = start_with_patience(1), patient = start_with_patience(100'000);
  EXPECT_EQ(silent.welcome.frame_patience_s, 1u);
  EXPECT_EQ(patient.welcome.frame_patience_s, 120u) << "no more than the server grants";
  const auto error = silent.client->read<wire::ErrorMessage>();
  ASSERT_TRUE(error);
  EXPECT_THAT(error->message, HasSubstr("sent no frame for 1 s"));
  EXPECT_EQ(final_state(silent.welcome.scan_id), "interrupted");
  EXPECT_EQ(row(patient.welcome.scan_id)["state"], "running");
}

TEST_F(ScansTest, AScanIsWarnedAndEndsWithItsResultsWhenTheStorageIsUsedUpMeanwhile) {
  serve([](ServiceOptions& options) { options.storage_gb = 1; });
  Camera camera = start();
  camera.client->send_message(room_frame(0));
  ASSERT_TRUE(camera.client->read<wire::FrameResult>());
  // The end of another scan makes the server look at once.
  const auto fill = [this](std::uint64_t bytes) {
    Camera other = start_with_patience(1);
    const std::string file = scan_file(other.welcome.scan_id, "other");
    { std::ofstream(file) << "x"; }
    std::filesystem::resize_file(file, bytes);  // sparse
    EXPECT_TRUE(other.client->read<wire::ErrorMessage>());
  };
  fill(950'000'000);
  std::string message;
  while (message.find("nearly used up") == std::string::npos) {
    const auto state = camera.client->read<wire::ScanState>();
    ASSERT_TRUE(state);
    message = state->message;
  }
  fill(60'000'000);
  const auto error = camera.client->read<wire::ErrorMessage>();
  ASSERT_TRUE(error);
  EXPECT_THAT(error->message,
              HasSubstr("no room for more frames: the scans and uploads on this server take 101"));
  EXPECT_EQ(final_state(camera.welcome.scan_id), "interrupted");
  EXPECT_TRUE(std::filesystem::exists(scan_file(camera.welcome.scan_id, "cloud.ply")));
}

TEST_F(ScansTest, WhoeverOwnsAScanMayStopIt) {
  Camera camera = start();
  camera.client->send_message(room_frame(0));
  ASSERT_TRUE(camera.client->read<wire::FrameResult>());
  EXPECT_EQ(ask_http("POST", camera.welcome.scan_id + "/stop")["stopping"], camera.welcome.scan_id);
  const auto error = camera.client->read<wire::ErrorMessage>();
  ASSERT_TRUE(error);
  EXPECT_THAT(error->message, HasSubstr("stopped from the viewer"));
  EXPECT_EQ(final_state(camera.welcome.scan_id), "interrupted");
  EXPECT_EQ(row(camera.welcome.scan_id)["words"], "stopped from the viewer");
  EXPECT_TRUE(std::filesystem::exists(scan_file(camera.welcome.scan_id, "cloud.ply")))
      << "with what it has";
}

TEST_F(ScansTest, AnyCreditWindowGivesWhatALocalRunGives) {
  for (const int window : {1, 16}) {
    serve([window](ServiceOptions& options) { options.credit_window = window; });
    Camera camera = start();
    EXPECT_EQ(camera.welcome.frame_credit, static_cast<std::uint32_t>(window));
    const auto finished = stream(camera);
    ASSERT_TRUE(finished);
    expect_local_result(*finished);
  }
}

TEST_F(ScansTest, TwoScansAtOnceGiveWhatALocalRunGives) {
  Camera cameras[2] = {start(), start()};
  std::optional<wire::Finished> finished[2];
  std::thread other([&] { finished[1] = stream(cameras[1]); });
  finished[0] = stream(cameras[0]);
  other.join();
  for (const auto& result : finished) {
    ASSERT_TRUE(result);
    expect_local_result(*result);
  }
}

TEST_F(ScansTest, EveryFrameHasItsResultAndTheFilesAreWritten) {
  Camera camera = start();
  std::uint64_t surfel_count = 0;
  for (int i = 0; i < kFrameCount; ++i) {
    camera.client->send_message(room_frame(i));
    const auto result = camera.client->read<wire::FrameResult>();
    ASSERT_TRUE(result);
    surfel_count = result->surfel_count;
    EXPECT_EQ(result->sequence, static_cast<std::uint64_t>(i));
    EXPECT_EQ(result->timestamp_s, room().timestamp_s(i));
    EXPECT_GT(result->frame_ms, 0);
  }
  camera.client->send_message(wire::Ping{7});
  const auto pong = camera.client->read<wire::Pong>();
  ASSERT_TRUE(pong);
  EXPECT_EQ(pong->id, 7u);
  camera.client->send_message(wire::Finish{});
  const auto state = [&] {
    std::optional<wire::ScanState> last;
    while ((last = camera.client->read<wire::ScanState>()) &&
           last->phase == wire::ScanPhase::kRunning) {
    }
    return last;
  }();
  ASSERT_TRUE(state);
  EXPECT_EQ(state->phase, wire::ScanPhase::kFinished);
  EXPECT_EQ(state->frames_processed, static_cast<std::uint64_t>(kFrameCount));
  const auto finished = camera.client->read<wire::Finished>();
  ASSERT_TRUE(finished);
  EXPECT_EQ(camera.client->close_code(), 1000);
  const std::string& id = camera.welcome.scan_id;
  EXPECT_EQ(bytes_of(scan_file(id, "trajectory.txt")), finished->trajectory_tum);
  EXPECT_EQ(bytes_of(scan_file(id, "report.json")), finished->report_json);
  EXPECT_EQ(row(id)["state"], "finished");
  EXPECT_EQ(row(id)["frames"], kFrameCount);
  std::uint64_t bytes = 0;
  for (const char* name : {"cloud.ply", "surfels.ply", "chunks.bin", "trajectory.txt",
                           "tracking.txt", "thumbnail.jpg"})
    bytes += std::filesystem::file_size(scan_file(id, name));
  EXPECT_LE(bytes, run::room_for_results(surfel_count, kFrameCount) - run::room_for_results(0, 0))
      << "what is kept back on the disk is enough";
}

TEST_F(ScansTest, BadFramesAreToldAndTheScanGoesOn) {
  Camera camera = start();
  wire::Frame frames[kFrameCount];
  for (int i = 0; i < kFrameCount; ++i) frames[i] = room_frame(i);
  frames[1].depth = "garbage";
  frames[2].timestamp_s = std::nan("");
  frames[3].timestamp_s = frames[0].timestamp_s;
  const std::vector<std::uint8_t> larger = *image::encode_png(ColorImage(161, 120));
  frames[4].color = {larger.begin(), larger.end()};
  std::vector<wire::ErrorMessage> errors;
  for (wire::Frame& frame : frames) camera.client->send_message(std::move(frame));
  camera.client->send_message(wire::Finish{});
  std::optional<wire::Finished> finished;
  while (const auto message = camera.client->read_message()) {
    if (const auto* error = std::get_if<wire::ErrorMessage>(&*message)) errors.push_back(*error);
    if (const auto* results = std::get_if<wire::Finished>(&*message)) finished = *results;
  }
  ASSERT_TRUE(finished);
  ASSERT_EQ(errors.size(), 4u);
  std::map<std::uint64_t, std::string> messages;
  for (const wire::ErrorMessage& error : errors) {
    EXPECT_TRUE(error.about_frame);
    messages[error.sequence] = error.message;
  }
  EXPECT_THAT(messages[1], HasSubstr("frame.depth"));
  EXPECT_THAT(messages[2], HasSubstr("frame.timestamp_s"));
  EXPECT_THAT(messages[3], HasSubstr("frame.timestamp_s"));
  EXPECT_THAT(messages[4], HasSubstr("frame.color"));
  // Frames with a bad time have no line, those with bad images have.
  EXPECT_EQ(dataset::parse_tum_trajectory(finished->trajectory_tum)->size(),
            static_cast<std::size_t>(kFrameCount - 2));
  EXPECT_EQ(row(camera.welcome.scan_id)["frames_received"], kFrameCount);
  EXPECT_EQ(row(camera.welcome.scan_id)["frames_dropped"], 2);
}

TEST_F(ScansTest, ABrokenRuleEndsThatScanAndNoOther) {
  Camera well = start();
  struct Case {
    const char* message;
    int close_code;
    std::function<void(Camera&)> break_it;
  };
  const Case cases[] = {
      {"expected is 0", 1002, [](Camera& camera) { camera.client->send_message(room_frame(1)); }},
      {"expected is 1", 1002,
       [](Camera& camera) {
         camera.client->send_message(room_frame(0));
         camera.client->send_message(room_frame(0));
       }},
      {"after finish", 1002,
       [](Camera& camera) {
         camera.client->send_message(wire::Finish{});
         camera.client->send_message(room_frame(0));
       }},
      {"hello came twice", 1002,
       [](Camera& camera) {
         camera.client->send_message(wire::Hello{0, "", "", wire::ViewScan{"a"}});
       }},
      {"viewer_ack", 1002, [](Camera& camera) { camera.client->send_message(wire::ViewerAck{1}); }},
      {"not a message", 1007,
       [](Camera& camera) { camera.client->send_frame(2, std::string(100, '\xff')); }},
      {"longer than", 1009,
       [](Camera& camera) {
         camera.client->send_frame(2, std::string(camera.welcome.max_message_bytes + 1, 'x'));
       }},
      {"does not know", 1008,
       [](Camera& camera) {
         for (int i = 0; i < 1100; ++i) camera.client->send_message(wire::Unknown{});
       }},
  };
  for (const Case& broken : cases) {
    Camera camera = start();
    broken.break_it(camera);
    std::optional<wire::ErrorMessage> error = camera.client->read<wire::ErrorMessage>();
    ASSERT_TRUE(error) << broken.message;
    EXPECT_THAT(error->message, HasSubstr(broken.message));
    EXPECT_FALSE(error->about_frame);
    EXPECT_EQ(camera.client->close_code(), broken.close_code) << broken.message;
    const std::string state = final_state(camera.welcome.scan_id);
    EXPECT_EQ(state, std::string(broken.message) == "after finish" ? "finished" : "interrupted");
    if (state == "interrupted") {
      EXPECT_EQ(row(camera.welcome.scan_id)["words"], error->message);
    }
  }
  const auto finished = stream(well);
  ASSERT_TRUE(finished);
  expect_local_result(*finished);
}

TEST_F(ScansTest, AFrameWithoutCreditIsABrokenRule) {
  serve([](ServiceOptions& options) { options.credit_window = 2; });
  Camera camera = start();
  for (int i = 0; i < kFrameCount; ++i) camera.client->send_message(room_frame(i));
  const auto error = camera.client->read<wire::ErrorMessage>();
  ASSERT_TRUE(error);
  EXPECT_THAT(error->message, HasSubstr("without credit"));
  EXPECT_EQ(camera.client->close_code(), 1002);
}

TEST_F(ScansTest, ALostCameraLeavesAnInterruptedScanWithItsResults) {
  std::string id;
  {
    Camera camera = start();
    id = camera.welcome.scan_id;
    for (int i = 0; i < 3; ++i) camera.client->send_message(room_frame(i));
    ASSERT_TRUE(camera.client->read<wire::FrameResult>());
    camera.client->drop();
  }
  EXPECT_EQ(final_state(id), "interrupted");
  EXPECT_THAT(row(id)["words"].get<std::string>(), HasSubstr("connection"));
  EXPECT_EQ(dataset::parse_tum_trajectory(bytes_of(scan_file(id, "trajectory.txt")))->size(), 3u);
  EXPECT_TRUE(std::filesystem::exists(scan_file(id, "cloud.ply")));
  EXPECT_TRUE(std::filesystem::exists(scan_file(id, "report.json")));
}

TEST_F(ScansTest, StoppingTheServerKeepsWhatThereIs) {
  Camera camera = start();
  camera.client->send_message(room_frame(0));
  ASSERT_TRUE(camera.client->read<wire::FrameResult>());
  std::thread stopping([this] { EXPECT_TRUE(server_->stop()); });
  const auto error = camera.client->read<wire::ErrorMessage>();
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code, "busy");
  EXPECT_THAT(error->message, HasSubstr("server was stopped"));
  stopping.join();
  serve([](ServiceOptions&) {});
  EXPECT_EQ(row(camera.welcome.scan_id)["state"], "interrupted");
  EXPECT_TRUE(std::filesystem::exists(scan_file(camera.welcome.scan_id, "cloud.ply")));
}

// Somebody else is writing, for longer than the server waits for him.
TEST_F(ScansTest, AScanHasEndedAlsoWhereTheDatabaseDoesNotTakeIt) {
  Camera camera = start();
  SQLite::Database other(folder_ / "data/hermite.db", SQLite::OPEN_READWRITE);
  other.exec("BEGIN IMMEDIATE");
  ASSERT_TRUE(stream(camera));
  EXPECT_EQ(row(camera.welcome.scan_id)["state"], "finished");
  EXPECT_EQ(row(camera.welcome.scan_id)["frames_processed"], kFrameCount);
  const auto stored = [&] {
    return other.execAndGet("SELECT phase FROM scans WHERE id = '" + camera.welcome.scan_id + "'")
        .getString();
  };
  EXPECT_EQ(stored(), "running");
  other.exec("ROLLBACK");
  for (int i = 0; i < 300 && stored() == "running"; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  EXPECT_EQ(stored(), "finished") << "it is tried again";
}

TEST_F(ScansTest, MoreScansThanAllowedAreRefusedUntilOneEnds) {
  serve([](ServiceOptions& options) { options.max_scans = 1; });
  Camera first = start();
  const auto second = ask("second", 0);
  const auto error = second->read<wire::ErrorMessage>();
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code, "busy");
  EXPECT_THAT(error->message, HasSubstr("at most 1 scans"));
  EXPECT_EQ(second->close_code(), 4013);
  first.client->send_message(wire::Finish{});
  ASSERT_TRUE(first.client->read<wire::Finished>()) << "a scan without frames has a result too";
  EXPECT_EQ(final_state(first.welcome.scan_id), "finished");
  start();
}

TEST_F(ScansTest, CamerasWaitForAPlaceInTheOrderInWhichTheyCame) {
  serve([](ServiceOptions& options) { options.max_scans = 1; });
  Camera first = start();
  const auto second = ask("second");
  EXPECT_EQ(second->read<wire::Waiting>()->before, 0u);
  auto gone = ask("gone");
  EXPECT_EQ(gone->read<wire::Waiting>()->before, 1u);
  const auto third = ask("third");
  EXPECT_EQ(third->read<wire::Waiting>()->before, 2u);
  second->send_message(wire::Ping{7});
  EXPECT_EQ(second->read<wire::Pong>()->id, 7u) << "who waits is heard";
  gone.reset();
  first.client->send_message(wire::Finish{});
  ASSERT_TRUE(first.client->read<wire::Finished>());
  const auto welcome = second->read<wire::Welcome>();
  ASSERT_TRUE(welcome);
  EXPECT_EQ(row(welcome->scan_id)["title"], "second");
  second->send_message(room_frame(0));  // longer than what is allowed before the welcome
  ASSERT_TRUE(second->read<wire::FrameResult>());
  second->send_message(wire::Finish{});
  ASSERT_TRUE(second->read<wire::Finished>());
  ASSERT_TRUE(third->read<wire::Welcome>()) << "nobody waits for one who has gone";
}

TEST_F(ScansTest, WhoWaitsIsToldToComeBackWhenTheServerStops) {
  serve([](ServiceOptions& options) { options.max_scans = 1; });
  Camera first = start();
  const auto second = ask();
  ASSERT_TRUE(second->read<wire::Waiting>());
  std::thread stopping([this] { server_->stop(); });
  EXPECT_TRUE(second->read<wire::GoAway>());
  EXPECT_EQ(second->close_code(), 1001);
  stopping.join();
}

TEST_F(ScansTest, AFrameBeforeTheWelcomeEndsTheWait) {
  serve([](ServiceOptions& options) { options.max_scans = 1; });
  Camera first = start();
  const auto second = ask();
  ASSERT_TRUE(second->read<wire::Waiting>());
  wire::Frame frame = room_frame(0);
  second->send_message(frame);
  const auto error = second->read<wire::ErrorMessage>();
  ASSERT_TRUE(error);
  EXPECT_EQ(second->close_code(), 1002);
}

TEST_F(ScansTest, ADeviceThatIsNotThereFailsTheScanWithAMessage) {
  serve([](ServiceOptions& options) { options.device = "a device that nobody has"; });
  Camera camera = start();
  const auto error = camera.client->read<wire::ErrorMessage>();
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code, "device");
  EXPECT_THAT(error->message, HasSubstr("a device that nobody has"));
  EXPECT_EQ(row(camera.welcome.scan_id)["state"], "failed");
  start();  // the server lives
}

TEST_F(ScansTest, ALiveScanDropsTheOldestAndCountsThem) {
  Camera camera = start(wire::Mode::kLive);
  // All at once: the pipeline is still being built, four wait, the others make room.
  for (int i = 0; i < kFrameCount; ++i) camera.client->send_message(room_frame(i));
  camera.client->send_message(wire::Finish{});
  std::vector<std::uint64_t> processed;
  std::optional<wire::ScanState> state;
  while (const auto message = camera.client->read_message()) {
    if (const auto* result = std::get_if<wire::FrameResult>(&*message))
      processed.push_back(result->sequence);
    if (const auto* now = std::get_if<wire::ScanState>(&*message)) state = *now;
  }
  ASSERT_TRUE(state);
  EXPECT_EQ(state->phase, wire::ScanPhase::kFinished);
  EXPECT_EQ(state->frames_received, static_cast<std::uint64_t>(kFrameCount));
  EXPECT_EQ(state->frames_processed, processed.size());
  EXPECT_EQ(state->frames_processed + state->frames_dropped,
            static_cast<std::uint64_t>(kFrameCount));
  ASSERT_FALSE(processed.empty());
  EXPECT_EQ(processed.back(), static_cast<std::uint64_t>(kFrameCount - 1))
      << "the newest is never dropped";
}

// Its row could not be synced, and its folder was removed; the disk had the row nevertheless when
// the server died.
TEST_F(ScansTest, AScanThatWasRefusedIsNotListedByTheNextServer) {
  const ScanRow refused = leave_running(false);
  EXPECT_EQ(row(refused.id)["error"]["code"], "not_found");
  server_->stop();
  Store store(folder_ / "data/hermite.db");
  EXPECT_EQ(store.scans.find(refused.id).error().code, ErrorCode::kNotFound);
}

// As with a disk that becomes full: it takes changes of rows, as of the end of the scan, and the
// files can be removed, but no rows.
TEST_F(ScansTest, ADiscardedScanIsNotListedAlsoWhereItsRowCannotBeRemoved) {
  Camera camera = start();
  camera.client->send_message(room_frame(0));
  ASSERT_TRUE(camera.client->read<wire::FrameResult>());
  SQLite::Database database(folder_ / "data/hermite.db", SQLite::OPEN_READWRITE);
  database.exec(
      "CREATE TRIGGER full BEFORE DELETE ON scans BEGIN SELECT RAISE(FAIL, 'no room'); END");
  camera.client->send_message(wire::Discard{});
  EXPECT_EQ(camera.client->close_code(), 1000);
  EXPECT_EQ(row(camera.welcome.scan_id)["error"]["code"], "not_found");
  EXPECT_THAT(ask_http("GET", "")["scans"], testing::IsEmpty());
  database.exec("DROP TRIGGER full");
  serve([](ServiceOptions&) {});
  EXPECT_EQ(row(camera.welcome.scan_id)["error"]["code"], "not_found")
      << "nor by a server that did not remove it";
}

}  // namespace
}  // namespace hermite::server
