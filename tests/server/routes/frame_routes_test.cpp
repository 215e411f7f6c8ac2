// The frames of a scan over HTTP, of a real server on a frame log of real frames.
#include "server/routes/frame_routes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/image/depth_rendering.h"
#include "core/image/image_codec.h"
#include "core/log/frame_log.h"
#include "proto/wire/client_message.h"
#include "server/scan/scan_record.h"
#include "server/store/scan_id.h"
#include "server/store/unix_time.h"
#include "tests/support/file_bytes.h"
#include "tests/support/room_frames.h"
#include "tests/support/route_test.h"
#include "tests/support/scan_server_test.h"

namespace hermite::server {
namespace frame_routes_test {

using Json = nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

// Of these four there are images; frame 2 was refused.
constexpr int kLogged = 5, kRefused = 2;

class FrameRoutesTest : public test::RouteTest {
 protected:
  FrameRoutesTest() {
    std::vector<ScanRow> rows;
    for (const std::string& id : {id_, bare_id_, imported_id_}) {
      rows.push_back(test::finished_row(id));
      rows.back().camera = id == imported_id_ ? Camera() : test::room().camera();
      // The frames of older scans are removed meanwhile.
      rows.back().created_at_ms = rows.back().finished_at_ms = unix_now_ms();
    }
    add_scans(rows);
    write_log();
    // Frame 3 was left out.
    put("tracking.txt",
        line(0, "tracked") + line(1, "lost too few points: it is dark") + line(4, "weak too fast"));
    start();
  }
  void write_log() const {
    ScanRecord record;
    record.request.camera = test::room().camera();
    record.request.depth_codecs = {wire::DepthCodec::kRvlZstd};
    record.request.color_codecs = {wire::ColorCodec::kJpeg, wire::ColorCodec::kPng};
    record.request.mode = wire::Mode::kBatch;
    frame_log::FrameLogOptions options;
    options.segment_bytes = 1;  // one frame each
    const frame_log::FrameLogEvents nobody{[](std::uint64_t) {}, [](const Error&) {}};
    const auto log = frame_log::FrameLog::create(log_, format_terms(record), format_start(record),
                                                 nobody, options);
    ASSERT_TRUE(log.ok()) << log.error().message;
    for (int i = 0; i < kLogged; ++i)
      ASSERT_TRUE(
          (*log)
              ->append(i == kRefused ? frame_log::RecordType::kRefusedFrame
                                     : frame_log::RecordType::kFrame,
                       i == kRefused ? "" : wire::format_client_message(test::room_frame(i)))
              .ok());
    ASSERT_TRUE((*log)->append(frame_log::RecordType::kFinish, "").ok());
  }
  static std::string line(int frame, const char* status) {
    return std::to_string(test::room_frame(frame).timestamp_s) + " " + status + "\n";
  }
  using RouteTest::put;
  void put(const std::string& name, const std::string& bytes) const { put(id_, name, bytes); }
  using Answer = test::RouteAnswer;
  Answer ask(const std::string& path, const std::string& token = "",
             const std::string& method = "GET") {
    return RouteTest::ask(method, "/api/v1/scans/" + path,
                          token.empty() ? server_->token() : token);
  }
  Answer image(const char* kind, const std::string& frame) {
    return ask(id_ + "/frames/" + kind + "/" + frame);
  }

  const std::string id_ = new_scan_id(), bare_id_ = new_scan_id(), imported_id_ = new_scan_id();
  const std::string log_ = folder_ / "data/scans/" + id_ + "/log";
  const Camera camera_ = test::room().camera();
  const image::ImageSize size_{camera_.width, camera_.height};
};

TEST_F(FrameRoutesTest, TheListHasTheTimeAndTheFateOfEachFrame) {
  const Answer answer = ask(id_ + "/frames");
  ASSERT_EQ(answer.status, 200) << answer.body;
  const Json list = answer.json();
  EXPECT_EQ(list["width"], camera_.width);
  EXPECT_EQ(list["depth_units_per_metre"], camera_.depth_units_per_metre);
  ASSERT_EQ(list["timestamps_s"].size(), static_cast<std::size_t>(kLogged));
  for (const int i : {0, 1, 3, 4})
    EXPECT_EQ(list["timestamps_s"][static_cast<std::size_t>(i)], test::room_frame(i).timestamp_s)
        << i;
  EXPECT_TRUE(list["timestamps_s"][kRefused].is_null());
  std::vector<std::string> runs;
  for (const Json& run : list["statuses"])
    runs.push_back(run["status"].get<std::string>() + " " +
                   std::to_string(run["frames"].get<int>()));
  EXPECT_THAT(runs, ElementsAre("tracked 1", "lost 1", "refused 1", "left_out 1", "weak 1"));
  EXPECT_EQ(list["reasons"],
            Json::parse(R"([{"reason": "too few points: it is dark", "first": [1], "frames": [1]},
                            {"reason": "too fast", "first": [4], "frames": [1]}])"));
  EXPECT_THAT(answer.field("Cache-Control"), "no-store");
}

TEST_F(FrameRoutesTest, AReasonIsThereOnceHoweverManyFramesHaveIt) {
  put("tracking.txt", line(0, "weak too fast") + line(1, "lost too fast") + line(3, "weak") +
                          line(4, "weak too fast"));
  const Json reasons = ask(id_ + "/frames").json()["reasons"];
  EXPECT_EQ(reasons, Json::parse(R"([{"reason": "too fast", "first": [0, 4], "frames": [2, 1]}])"));
  // As older servers have left it.
  put("tracking.txt", line(0, "weak") + line(1, "lost"));
  EXPECT_EQ(ask(id_ + "/frames").json()["reasons"], Json::array());
}

TEST_F(FrameRoutesTest, WithoutWhatBecameOfThemTheListHasTheirTimes) {
  std::filesystem::remove(folder_ / "data/scans/" + id_ + "/tracking.txt");
  const Json none = ask(id_ + "/frames").json();
  EXPECT_EQ(none["timestamps_s"].size(), static_cast<std::size_t>(kLogged));
  EXPECT_EQ(none["statuses"][0], (Json{{"status", "unknown"}, {"frames", 2}}));
  // As older servers have left it.
  put("trajectory.txt", std::to_string(test::room_frame(0).timestamp_s) + " 0 0 0 0 0 0 1\n");
  const Json older = ask(id_ + "/frames").json();
  EXPECT_EQ(older["statuses"][0], (Json{{"status", "unknown"}, {"frames", 1}}));
  EXPECT_EQ(older["statuses"][1], (Json{{"status", "left_out"}, {"frames", 1}}));
}

TEST_F(FrameRoutesTest, TheColourImageIsAsItCame) {
  for (const int i : {4, 0, 3}) {
    const Answer answer = image("color", std::to_string(i));
    ASSERT_EQ(answer.status, 200) << answer.body;
    EXPECT_TRUE(answer.body == test::room_frame(i).color) << i;
    EXPECT_EQ(answer.field("Content-Type"),
              *image::detect_image_format(answer.bytes()) == image::ImageFormat::kJpeg
                  ? "image/jpeg"
                  : "image/png");
  }
  const Answer head = ask(id_ + "/frames/color/0", "", "HEAD");
  EXPECT_EQ(head.status, 200);
  EXPECT_TRUE(head.body.empty());
}

TEST_F(FrameRoutesTest, DepthComesAsNumbersAndAsAnImage) {
  const DepthImage depth = test::room().read(4)->depth;
  const Answer raw = image("depth16", "4");
  ASSERT_EQ(raw.status, 200) << raw.body;
  EXPECT_TRUE(*image::decode_depth_png(raw.bytes(), size_) == depth);

  const Answer shown = image("depth", "4");
  ASSERT_EQ(shown.status, 200) << shown.body;
  EXPECT_EQ(shown.field("Content-Type"), "image/jpeg");
  EXPECT_EQ(shown.field("Depth-Shown-Mm"), shown.field("Depth-Measured-Mm"));
  const image::DepthExtent extent = image::extent_of(depth);
  const double units_per_mm = camera_.depth_units_per_metre / 1000;
  EXPECT_NEAR(std::stod(shown.field("Depth-Measured-Mm")), extent.range.nearest / units_per_mm, 1);
  EXPECT_EQ(shown.field("Depth-Valid-Percent"),
            std::to_string(static_cast<int>(100 * extent.valid_share)));
  const ColorImage expected = image::depth_rendering(depth, extent.range);
  const ColorImage rendering = *image::decode_color(shown.bytes(), size_);
  double error = 0;
  for (std::size_t i = 0; i < rendering.pixels.size(); ++i)
    error += std::abs(rendering.pixels[i].g - expected.pixels[i].g);
  EXPECT_LT(error / static_cast<double>(rendering.pixels.size()), 8)
      << "it is that image, but for what a JPEG loses";

  const Answer narrow = image("depth", "4?from_mm=100&to_mm=200");
  EXPECT_EQ(narrow.field("Depth-Shown-Mm"), "100-200");
  EXPECT_EQ(narrow.field("Depth-Measured-Mm"), shown.field("Depth-Measured-Mm"));
  EXPECT_NE(narrow.body, shown.body);
  for (const char* query : {"?from_mm=1", "?to_mm=1&from_mm=0", "?from_mm=2&to_mm=1",
                            "?from_mm=-1&to_mm=1", "?from_mm=1&to_mm=2x", "?a"})
    EXPECT_EQ(image("depth", std::string("4") + query).status, 400) << query;
}

TEST_F(FrameRoutesTest, WhatCannotBeHadSaysWhy) {
  for (const char* kind : {"color", "depth", "depth16"}) {
    SCOPED_TRACE(kind);
    EXPECT_THAT(image(kind, "5").message(),
                HasSubstr("there is no frame 5: the recording ends before"));
    EXPECT_EQ(image(kind, "18446744073709551615").status, 404);
    EXPECT_EQ(image(kind, "18446744073709551616").status, 400);
    for (const char* none : {"-1", "1x", "0x1", "%31"})
      EXPECT_EQ(image(kind, none).status, 400) << none;
    const Answer refused = image(kind, "2");
    EXPECT_EQ(refused.status, 404);
    EXPECT_THAT(refused.message(), HasSubstr("frame 2 was refused"));
    EXPECT_EQ(ask(new_scan_id() + "/frames/" + kind + "/0").status, 404);
  }
  const Answer gone = ask(bare_id_ + "/frames");
  EXPECT_EQ(gone.status, 410);
  EXPECT_THAT(gone.message(), HasSubstr("not kept any more"));
  EXPECT_EQ(ask(bare_id_ + "/frames/color/0").status, 410);
  const Answer imported = ask(imported_id_ + "/frames");
  EXPECT_EQ(imported.status, 404);
  EXPECT_THAT(imported.message(), HasSubstr("was imported"));
}

TEST_F(FrameRoutesTest, AFrameThatIsDamagedOnTheDiskIsAnErrorOfItsOwn) {
  // Terms and start are in segments of their own, too.
  const std::string segment = log_ + "/" + frame_log::segment_name(3);
  std::vector<std::uint8_t> bytes = test::file_bytes(segment);
  bytes.at(bytes.size() / 2) ^= 1;
  std::ofstream(segment, std::ios::binary | std::ios::trunc)
      .write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
  const Answer damaged = image("color", "1");
  EXPECT_EQ(damaged.status, 500);
  EXPECT_EQ(damaged.json()["error"]["code"], "corrupt_data");
  EXPECT_THAT(damaged.message(),
              HasSubstr("frame 1: segment-000003.rlog at byte 16: the checksum is another one"));
  EXPECT_EQ(image("color", "0").status, 200);
  EXPECT_EQ(image("depth", "4").status, 200);
  bytes.at(frame_log::kSegmentHeaderBytes) ^= 1;  // now its head, too
  std::ofstream(segment, std::ios::binary | std::ios::trunc)
      .write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
  EXPECT_EQ(ask(id_ + "/frames").json()["statuses"][1],
            (Json{{"status", "damaged"}, {"frames", 1}}));
}

TEST_F(FrameRoutesTest, AShareLinkShowsTheModelAndNotItsFrames) {
  test::RawClient client(server_->port());
  client.send("POST /api/v1/scans/" + id_ +
              "/shares HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\nAuthorization: Bearer " +
              server_->token() + "\r\n\r\n");
  const std::string answer = client.read_to_end();
  const std::string share = Json::parse(answer.substr(answer.find("\r\n\r\n") + 4))["secret"];
  EXPECT_EQ(ask(id_, share).status, 200);
  for (const char* path : {"/frames", "/frames/color/0", "/frames/depth/0", "/frames/depth16/0"}) {
    EXPECT_EQ(ask(id_ + path, share).status, 403) << path;
    EXPECT_EQ(ask(bare_id_ + path, share).status, 404) << path;
  }
}

// The frames of a scan while its camera sends them.
class RunningFramesTest : public test::ScanServerTest {
 protected:
  std::string ask(const std::string& id_and_rest, const std::string& token,
                  const std::string& method = "GET") {
    test::RawClient client(server_->port());
    client.send(method + " /api/v1/scans/" + id_and_rest +
                " HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\nAuthorization: Bearer " +
                token + "\r\n\r\n");
    return client.read_to_end();
  }
};

TEST_F(RunningFramesTest, ImagesCanBeSeenAsSoonAsTheyAreOnTheDisk) {
  const auto camera = hello(wire::StartScan{"",
                                            test::room().camera(),
                                            {wire::DepthCodec::kRvlZstd},
                                            {wire::ColorCodec::kJpeg, wire::ColorCodec::kPng},
                                            wire::Mode::kBatch,
                                            {},
                                            0});
  const auto welcome = camera->read<wire::Welcome>();
  ASSERT_TRUE(welcome);
  const std::string frames = welcome->scan_id + "/frames";
  for (int i = 0; i < 2; ++i) camera->send_message(test::room_frame(i));
  for (std::uint64_t done = 0; done < 2;) {  // both have their results, and are on the disk
    const auto credit = camera->read<wire::Credit>();
    ASSERT_TRUE(credit);
    done = std::min(credit->durable_frames, credit->frames_granted - welcome->frame_credit);
  }
  const std::string color = ask(frames + "/color/1", server_->token());
  EXPECT_THAT(color, StartsWith("HTTP/1.1 200"));
  EXPECT_TRUE(color.ends_with(test::room_frame(1).color));
  EXPECT_THAT(color, HasSubstr("\r\nFrame-Age-Ms: "));
  EXPECT_THAT(color, Not(HasSubstr("Surface-Delay-Ms"))) << "nobody watches a surface";
  EXPECT_THAT(ask(frames + "/depth/0", server_->token()), StartsWith("HTTP/1.1 200"));
  EXPECT_THAT(ask(frames + "/depth16/0", server_->token()), StartsWith("HTTP/1.1 200"));
  const std::string early = ask(frames + "/color/2", server_->token());
  EXPECT_THAT(early, StartsWith("HTTP/1.1 404"));
  EXPECT_THAT(early, HasSubstr("there is no frame 2 yet: the camera has sent 2 so far"));
  EXPECT_THAT(ask(frames, server_->token()), StartsWith("HTTP/1.1 409"))
      << "the list is not complete";

  const std::string made = ask(welcome->scan_id + "/shares", server_->token(), "POST");
  const std::string share = Json::parse(made.substr(made.find("\r\n\r\n") + 4))["secret"];
  for (const char* path : {"", "/color/0", "/depth/0", "/depth16/0"})
    EXPECT_THAT(ask(frames + path, share), StartsWith("HTTP/1.1 403")) << path;
}

}  // namespace frame_routes_test
}  // namespace hermite::server
