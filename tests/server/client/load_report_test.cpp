#include "server/client/load_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace hermite::client::load_report_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using Json = nlohmann::json;

CameraLoad camera(float slowest_ms) {
  CameraLoad camera;
  camera.scans_begun = camera.scans_finished = 1;
  camera.due = camera.offered = 100;
  camera.sent = 95;
  camera.client_dropped = 5;
  camera.server_dropped = 15;
  camera.answered = camera.tracked = 80;
  camera.answer_ms.assign(79, 40);
  camera.answer_ms.push_back(slowest_ms);
  camera.sent_bytes = 6'000'000;
  return camera;
}

LoadResult quiet_result() {
  LoadResult result;
  result.camera_count = 2;
  result.viewer_count = 3;
  result.rate_hz = 30;
  result.seconds = 10;
  result.cameras = {camera(300), camera(500)};
  result.viewers.watched = 3;
  result.viewers.messages = 600;
  result.viewers.received_bytes = 3'000'000;
  result.viewers.watched_s = 30;
  result.viewers.snapshot_ms = {20, 30, 80};
  result.machine = {4, 1.5, false};
  result.cleaning.deleted = 2;
  return result;
}

TEST(LoadReport, IsATableOfPlainWords) {
  const std::string text = format_load_report(quiet_result());
  EXPECT_THAT(text,
              HasSubstr("2 cameras and 3 viewers for 10.0 s, live at 30.0 frames per second\n"));
  EXPECT_THAT(text,
              HasSubstr("2            1      100       95       80        5       15       "
                        " 0       20.0 %   100.0 %     40 ms     40 ms    500 ms    500 ms\n"));
  EXPECT_THAT(
      text,
      HasSubstr(
          "all          2      200      190      160       10       30        0       20.0 %"));
  EXPECT_THAT(text, HasSubstr("waiting  no camera had to wait for a place\n"));
  EXPECT_THAT(
      text,
      HasSubstr("100.0 kB/s and 20.0 messages/s for each viewer; 0 refused, 0 disconnected\n"));
  EXPECT_THAT(text,
              HasSubstr("the whole snapshot after 30 ms (median), 80 ms (p95), 80 ms at most\n"));
  EXPECT_THAT(text, HasSubstr("12.0 MB up (1.2 MB/s), 3.0 MB down to viewers (300.0 kB/s)"));
  EXPECT_THAT(text, HasSubstr("used 1.50 of 4 cores\n"));
  EXPECT_THAT(text, HasSubstr("scans    2 deleted\n"));
  EXPECT_THAT(text, HasSubstr("result   every camera got through\n"));
  EXPECT_THAT(text, Not(HasSubstr("note")));
}

TEST(LoadReport, SaysWhoWaitedAndWhatTheServerRefused) {
  LoadResult result = quiet_result();
  CameraLoad waiting;
  waiting.wait_s = {8.5};
  waiting.without_place = true;
  waiting.refused = 2;
  waiting.refusals = {{"the server says: too many cameras wait", 2}};
  result.cameras.push_back(waiting);
  result.viewers.refused = 4;
  result.viewers.problems = {{"the server says: too many viewers", 4}};
  result.cleaning = {0, {"a", "b"}, "deleting needs a token of scope admin"};
  const std::string text = format_load_report(result);
  EXPECT_THAT(text, HasSubstr("1 camera had to wait for a place, 8.5 s (median), 8.5 s at most; 1 "
                              "still waited at the end\n"));
  EXPECT_THAT(text, HasSubstr("refused  2 x the server says: too many cameras wait\n"));
  EXPECT_THAT(text, HasSubstr("viewer   4 x the server says: too many viewers\n"));
  EXPECT_THAT(text, HasSubstr("2 left on the server with the tag \"load test\": deleting needs a "
                              "token of scope admin\n"));
  EXPECT_THAT(text, HasSubstr("3            0        0        0        0        0        0        "
                              "0        0.0 %         -         -"));
  EXPECT_THAT(text, HasSubstr("result   2 of 3 cameras got through\n"));
}

TEST(LoadReport, OfManyCamerasShowsTheSlowest) {
  LoadResult result = quiet_result();
  result.cameras.clear();
  for (int i = 0; i < 20; ++i) {
    result.cameras.push_back(camera(100));
    result.cameras.back().answer_ms.assign(80, static_cast<float>(100 + i));
  }
  const std::string text = format_load_report(result);
  EXPECT_THAT(text, Not(HasSubstr("\n4    "))) << "one of the four fastest";
  EXPECT_THAT(text, HasSubstr("\n5    "));
  EXPECT_THAT(text, HasSubstr("\n20   "));
  EXPECT_THAT(text, HasSubstr("(the 16 cameras of 20 with the longest p95; --json has all)\n"));
  EXPECT_EQ(Json::parse(load_report_json(result))["each_camera"].size(), 20u);
}

TEST(LoadReport, NotesWhatLimitsTheNumbers) {
  EXPECT_THAT(load_notes(quiet_result()), IsEmpty());
  LoadResult result = quiet_result();
  result.interrupted = true;
  for (CameraLoad& one : result.cameras) one.due = 200;
  result.machine = {2, 1.9, true};
  result.viewers.busiest_thread = 0.9;
  result.cameras[0].left_out = 1;
  result.cameras[0].answer_ms.pop_back();
  EXPECT_THAT(load_notes(result),
              ElementsAre(HasSubstr("interrupted"), HasSubstr("only 50 % of the frames in time"),
                          HasSubstr("used 1.9 of 2 cores"), HasSubstr("A thread with viewers"),
                          HasSubstr("on one machine"), HasSubstr("left out frames"),
                          HasSubstr("1 answer could not be timed")));
}

TEST(LoadReport, AsJsonHasEverything) {
  LoadResult result = quiet_result();
  result.cameras[1].refusals = {{"not \xff UTF-8", 1}};
  result.cleaning.left = {"x"};
  const std::string text = load_report_json(result);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1);
  const Json json = Json::parse(text);
  EXPECT_EQ(json["every_camera_got_through"], true);
  EXPECT_EQ(json["all_cameras"]["sent"], 190);
  EXPECT_EQ(json["all_cameras"]["answer_ms"]["count"], 160);
  EXPECT_EQ(json["all_cameras"]["answer_ms"]["median"], 40);
  EXPECT_EQ(json["each_camera"][1]["answer_ms"]["largest"], 500);
  EXPECT_DOUBLE_EQ(json["each_camera"][1]["without_answer_share"], 0.2);
  EXPECT_EQ(json["all_viewers"]["snapshot_ms"]["p95"], 80);
  EXPECT_EQ(json["load_test"]["cores_used"], 1.5);
  EXPECT_EQ(json["scans"]["left"], Json::array({"x"}));
  EXPECT_TRUE(json["notes"].is_array());
  EXPECT_TRUE(json["each_camera"][0]["refusals"].is_object());
}

}  // namespace
}  // namespace hermite::client::load_report_test
