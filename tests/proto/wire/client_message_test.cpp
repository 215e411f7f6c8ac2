#include "proto/wire/client_message.h"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hermite::wire {
namespace {

using testing::HasSubstr;

constexpr std::size_t kLimit = kMaxBytesBeforeWelcome;

Camera vga() { return {640, 480, 525, 525, 319.5, 239.5, 5000, {0.1, -0.2, 0.003, -0.004, 0.05}}; }

StartScan good_start() {
  StartScan start;
  start.title = "Küche, zweiter Versuch";
  start.camera = vga();
  start.depth_codecs = {DepthCodec::kRanks, DepthCodec::kPng16, DepthCodec::kRvlZstd};
  start.color_codecs = {ColorCodec::kJpeg};
  start.mode = Mode::kLive;
  start.settings = {{"frame.depth_max_m", "3"}, {"map.window", "5"}};
  start.expected_frames = 42;
  return start;
}

Result<ClientMessage> round_trip(ClientMessage message) {
  return parse_client_message(format_client_message(std::move(message)), kLimit);
}

Hello hello_with(StartScan start) { return {7, "a test 1.0", "secret", std::move(start)}; }

// The error of a hello whose start_scan was changed by `spoil`.
template <class Spoil>
Error error_of(const Spoil& spoil) {
  StartScan start = good_start();
  spoil(start);
  const Result<ClientMessage> message = round_trip(hello_with(std::move(start)));
  if (!message.ok()) return message.error();
  ADD_FAILURE() << "was accepted";
  return {};
}

TEST(ClientMessage, HelloOfACameraComesBackAsItWas) {
  const Result<ClientMessage> message = round_trip(hello_with(good_start()));
  ASSERT_TRUE(message.ok()) << message.error().message;
  const Hello& hello = std::get<Hello>(*message);
  EXPECT_EQ(hello.protocol_minor, 7u);
  EXPECT_EQ(hello.client, "a test 1.0");
  EXPECT_EQ(hello.token, "secret");
  const StartScan& start = std::get<StartScan>(hello.role);
  const StartScan expected = good_start();
  EXPECT_EQ(start.title, expected.title);
  EXPECT_EQ(start.camera, expected.camera);
  EXPECT_EQ(start.depth_codecs, expected.depth_codecs);
  EXPECT_EQ(start.color_codecs, expected.color_codecs);
  EXPECT_EQ(start.mode, expected.mode);
  EXPECT_EQ(start.settings, expected.settings);
  EXPECT_EQ(start.expected_frames, 42u);
}

TEST(ClientMessage, HelloOfACameraThatComesBackIsAsItWas) {
  const Result<ClientMessage> message =
      round_trip(Hello{2, "a test 1.0", "secret", ResumeScan{"a scan", "a token", 41}});
  ASSERT_TRUE(message.ok()) << message.error().message;
  const ResumeScan& resume = std::get<ResumeScan>(std::get<Hello>(*message).role);
  EXPECT_EQ(resume.scan_id, "a scan");
  EXPECT_EQ(resume.resume_token, "a token");
  EXPECT_EQ(resume.next_sequence, 41u);
  for (const ResumeScan& bad :
       {ResumeScan{std::string(65, 'a'), "", 0}, ResumeScan{"a", std::string(257, 'a'), 0},
        ResumeScan{"a\n", "", 0}}) {
    const Result<ClientMessage> refused = round_trip(Hello{2, "", "", bad});
    ASSERT_FALSE(refused.ok());
    EXPECT_THAT(refused.error().message, HasSubstr("resume_scan."));
  }
}

TEST(ClientMessage, PauseUnpauseAndDiscardComeBack) {
  EXPECT_TRUE(std::holds_alternative<Pause>(*round_trip(Pause{})));
  EXPECT_TRUE(std::holds_alternative<Unpause>(*round_trip(Unpause{})));
  EXPECT_TRUE(std::holds_alternative<Discard>(*round_trip(Discard{})));
}

ColorCamera color_camera() {
  return {520,
          521,
          322,
          243,
          {0.1, -0.2, 0.003, -0.004, 0.05},
          {Eigen::Quaterniond(1, 0.01, -0.02, 0.03).normalized(), {-0.025, 0.001, 0.002}}};
}

TEST(ClientMessage, TheColourCameraComesBackAsItWas) {
  StartScan start = good_start();
  start.camera.color = color_camera();
  start.camera.depth_correction = {-0.015, 0.02};
  start.camera.timing = {0.033, 0.03, -0.01};
  start.camera.deviations = {0.001, 0.0015, 0.003};
  const Result<ClientMessage> message = round_trip(hello_with(start));
  ASSERT_TRUE(message.ok()) << message.error().message;
  EXPECT_EQ(std::get<StartScan>(std::get<Hello>(*message).role).camera, start.camera);
}

TEST(ClientMessage, TheOtherBodiesComeBackAsTheyWere) {
  const auto view = round_trip(Hello{0, "viewer", "t", ViewScan{"abc"}});
  EXPECT_EQ(std::get<ViewScan>(std::get<Hello>(*view).role).scan_id, "abc");
  const auto frame = round_trip(Frame{3, 1.5, std::string("\0\1\2", 3), "color"});
  EXPECT_EQ(std::get<Frame>(*frame).sequence, 3u);
  EXPECT_EQ(std::get<Frame>(*frame).timestamp_s, 1.5);
  EXPECT_EQ(std::get<Frame>(*frame).depth, std::string("\0\1\2", 3));
  EXPECT_EQ(std::get<Frame>(*frame).color, "color");
  EXPECT_TRUE(std::holds_alternative<Finish>(*round_trip(Finish{})));
  EXPECT_EQ(std::get<ViewerAck>(*round_trip(ViewerAck{1ull << 40})).bytes, 1ull << 40);
  EXPECT_EQ(std::get<Ping>(*round_trip(Ping{9})).id, 9u);
}

TEST(ClientMessage, WhatAViewerWantsToSeeComesBackAndIsPointsToBeginWith) {
  const Result<ClientMessage> message = round_trip(Watch{false, true});
  EXPECT_FALSE(std::get<Watch>(*message).points);
  EXPECT_TRUE(std::get<Watch>(*message).mesh);
  const auto watch_of = [](const Result<ClientMessage>& hello) {
    return std::get<ViewScan>(std::get<Hello>(*hello).role).watch;
  };
  const Watch wanted = watch_of(round_trip(Hello{6, "", "", ViewScan{"a", {false, true}}}));
  EXPECT_FALSE(wanted.points);
  EXPECT_TRUE(wanted.mesh);
  // A viewer of an earlier minor: hello{view_scan{scan_id "a"}}, without what there is to see.
  const Watch before = watch_of(parse_client_message(std::string("\x0a\x05\x2a\x03\x0a\x01"
                                                                 "a",
                                                                 7),
                                                     kLimit));
  EXPECT_TRUE(before.points);
  EXPECT_FALSE(before.mesh);
}

TEST(ClientMessage, AFramesTimeIsNotJudgedHere) {
  const auto frame = round_trip(Frame{0, std::nan(""), "d", "c"});
  ASSERT_TRUE(frame.ok());
  EXPECT_TRUE(std::isnan(std::get<Frame>(*frame).timestamp_s));
}

TEST(ClientMessage, WhatAFrameFeltComesBackAndIsNotJudgedHere) {
  Frame frame{4, 1.5, "d", "c"};
  EXPECT_FALSE(std::get<Frame>(*round_trip(frame)).acceleration_m_s2.has_value());
  frame.acceleration_m_s2 = Eigen::Vector3d(0.25, -9.75, 1e300);
  EXPECT_EQ(std::get<Frame>(*round_trip(frame)).acceleration_m_s2, frame.acceleration_m_s2);
  frame.acceleration_m_s2 = Eigen::Vector3d(0, std::nan(""), 0);
  EXPECT_TRUE(std::isnan(std::get<Frame>(*round_trip(frame)).acceleration_m_s2->y()));
}

TEST(ClientMessage, ABodyOfTheFutureIsUnknownAndNoError) {
  // Field 90, length-delimited, 3 bytes: what a newer client could send.
  const auto message = parse_client_message(std::string("\xd2\x05\x03xyz", 6), kLimit);
  ASSERT_TRUE(message.ok()) << message.error().message;
  EXPECT_TRUE(std::holds_alternative<Unknown>(*message));
  EXPECT_TRUE(std::holds_alternative<Unknown>(*parse_client_message("", kLimit)));
}

TEST(ClientMessage, LongerThanTheLimitIsTooLarge) {
  const std::string bytes = format_client_message(Frame{0, 0, std::string(1000, 'x'), ""});
  EXPECT_TRUE(parse_client_message(bytes, bytes.size()).ok());
  const auto message = parse_client_message(bytes, bytes.size() - 1);
  ASSERT_FALSE(message.ok());
  EXPECT_EQ(message.error().code, ErrorCode::kTooLarge);
  EXPECT_THAT(message.error().message, HasSubstr(std::to_string(bytes.size() - 1)));
}

TEST(ClientMessage, EveryCutHelloIsAnErrorOrLacksSomething) {
  const std::string bytes = format_client_message(hello_with(good_start()));
  for (std::size_t length = 1; length < bytes.size(); ++length) {
    const auto message = parse_client_message(std::string_view(bytes).substr(0, length), kLimit);
    ASSERT_FALSE(message.ok()) << "cut to " << length << " of " << bytes.size();
    EXPECT_FALSE(message.error().message.empty());
  }
}

TEST(ClientMessage, GarbageIsCorruptData) {
  for (const std::string& bytes : {std::string(100, '\xff'), std::string("GET / HTTP/1.1\r\n\r\n"),
                                   std::string("\x0a\xff\xff\xff\xff\x0f", 6)}) {
    const auto message = parse_client_message(bytes, kLimit);
    ASSERT_FALSE(message.ok());
    EXPECT_EQ(message.error().code, ErrorCode::kCorruptData);
  }
}

TEST(ClientMessage, TextThatIsNotUtf8IsCorruptData) {
  // hello { client: "\xff\xfe" } by hand: our own writer would not do it.
  const auto message = parse_client_message(std::string("\x0a\x04\x12\x02\xff\xfe", 6), kLimit);
  ASSERT_FALSE(message.ok());
  EXPECT_EQ(message.error().code, ErrorCode::kCorruptData);
  EXPECT_THAT(message.error().message, HasSubstr("UTF-8"));
}

TEST(ClientMessage, LongOrUnprintableTextsAreNamed) {
  EXPECT_THAT(error_of([](StartScan& start) { start.title.assign(201, 'x'); }).message,
              HasSubstr("start_scan.title has 201 bytes"));
  EXPECT_THAT(error_of([](StartScan& start) { start.title = "two\nlines"; }).message,
              HasSubstr("start_scan.title"));
  EXPECT_TRUE(round_trip(Hello{0, "c", std::string(256, 't'), ViewScan{"a"}}).ok());
  EXPECT_THAT(round_trip(Hello{0, "c", std::string(257, 't'), ViewScan{"a"}}).error().message,
              HasSubstr("hello.token"));
  EXPECT_THAT(round_trip(Hello{0, std::string(201, 'c'), "t", ViewScan{"a"}}).error().message,
              HasSubstr("hello.client"));
  EXPECT_THAT(round_trip(Hello{0, "c", "t", ViewScan{std::string(65, 'a')}}).error().message,
              HasSubstr("view_scan.scan_id"));
}

TEST(ClientMessage, ACameraThatCannotBeIsNamed) {
  EXPECT_THAT(error_of([](StartScan& start) { start.camera.width = 63; }).message,
              HasSubstr("camera.width is 63"));
  EXPECT_THAT(error_of([](StartScan& start) { start.camera.height = 100000; }).message,
              HasSubstr("camera.height"));
  EXPECT_THAT(error_of([](StartScan& start) { start.camera.width = -1; }).message,
              HasSubstr("camera.width"));
  EXPECT_THAT(error_of([](StartScan& start) { start.camera.fx = std::nan(""); }).message,
              HasSubstr("camera.fx"));
  EXPECT_THAT(error_of([](StartScan& start) { start.camera.fy = -525; }).message,
              HasSubstr("camera.fy"));
  EXPECT_THAT(error_of([](StartScan& start) { start.camera.cx = 1e9; }).message,
              HasSubstr("camera.cx"));
  EXPECT_THAT(error_of([](StartScan& start) {
                start.camera.depth_units_per_metre = std::numeric_limits<double>::infinity();
              }).message,
              HasSubstr("camera.depth_units_per_metre"));
  EXPECT_THAT(error_of([](StartScan& start) { start.camera.distortion.p1 = std::nan(""); }).message,
              HasSubstr("camera.distortion"));
  EXPECT_THAT(error_of([](StartScan& start) { start.camera.depth_correction.bend = 0.2; }).message,
              HasSubstr("depth_correction.bend"));
  EXPECT_THAT(error_of([](StartScan& start) { start.camera.timing.color_delay_s = 0.2; }).message,
              HasSubstr("timing.color_delay_s"));
  EXPECT_THAT(error_of([](StartScan& start) { start.camera.deviations.focal = 0.2; }).message,
              HasSubstr("standard_deviations.focal"));
  const auto color_error = [](auto spoil) {
    return error_of([&](StartScan& start) {
             start.camera.color = color_camera();
             spoil(*start.camera.color);
           })
        .message;
  };
  EXPECT_THAT(color_error([](ColorCamera& color) { color.fx = 0; }),
              HasSubstr("start_scan: camera.color.fx"));
  EXPECT_THAT(color_error([](ColorCamera& color) { color.distortion.k1 = 1e9; }),
              HasSubstr("camera.color.distortion"));
  EXPECT_THAT(color_error([](ColorCamera& color) { color.color_from_depth.rotation.w() = 2; }),
              HasSubstr("camera.color.color_from_depth"));
  EXPECT_THAT(color_error([](ColorCamera& color) { color.color_from_depth.translation.x() = 7; }),
              HasSubstr("camera.color.color_from_depth"));
}

TEST(ClientMessage, CodecsOfTheFutureAreSkippedButOneMustBeKnown) {
  StartScan start = good_start();
  start.depth_codecs = {static_cast<DepthCodec>(77), DepthCodec::kRvlZstd};
  const auto message = round_trip(hello_with(start));
  ASSERT_TRUE(message.ok());
  EXPECT_EQ(std::get<StartScan>(std::get<Hello>(*message).role).depth_codecs,
            std::vector<DepthCodec>{DepthCodec::kRvlZstd});
  const Error unknown =
      error_of([](StartScan& changed) { changed.depth_codecs = {static_cast<DepthCodec>(77)}; });
  EXPECT_EQ(unknown.code, ErrorCode::kUnsupported);
  EXPECT_THAT(unknown.message, HasSubstr("start_scan.depth_codecs"));
  EXPECT_THAT(error_of([](StartScan& changed) { changed.color_codecs.clear(); }).message,
              HasSubstr("start_scan.color_codecs"));
  EXPECT_THAT(error_of([](StartScan& changed) {
                changed.color_codecs.assign(17, ColorCodec::kPng);
              }).message,
              HasSubstr("17 entries"));
}

TEST(ClientMessage, ModeAndSettingsAreBounded) {
  EXPECT_THAT(error_of([](StartScan& start) { start.mode = static_cast<Mode>(0); }).message,
              HasSubstr("start_scan.mode is 0"));
  EXPECT_THAT(error_of([](StartScan& start) {
                for (int i = 0; i < 65; ++i) start.settings["key" + std::to_string(i)] = "1";
              }).message,
              HasSubstr("allowed are 64"));
  EXPECT_THAT(error_of([](StartScan& start) { start.settings["k"].assign(201, '1'); }).message,
              HasSubstr("start_scan.settings[k]"));
}

TEST(ClientMessage, AHelloWithoutARoleSaysWhatIsMissing) {
  // hello { client: "a" }
  const auto message = parse_client_message(std::string("\x0a\x03\x12\x01"
                                                        "a",
                                                        5),
                                            kLimit);
  ASSERT_FALSE(message.ok());
  EXPECT_EQ(message.error().code, ErrorCode::kUnsupported);
  EXPECT_THAT(message.error().message, HasSubstr("hello.role"));
}

TEST(ClientMessage, WhereAFrameIsExpectedNothingElseWillDo) {
  const std::string frame = format_client_message(Frame{7, 1.5, "depth", "color"});
  EXPECT_EQ(parse_frame_message(frame, frame.size())->sequence, 7u);
  EXPECT_EQ(parse_frame_message(frame, frame.size() - 1).error().code, ErrorCode::kTooLarge);
  EXPECT_EQ(parse_frame_message(format_client_message(Finish{}), 100).error().code,
            ErrorCode::kCorruptData);
  EXPECT_EQ(parse_frame_message("", 100).error().code, ErrorCode::kCorruptData);
}

TEST(ClientMessage, TheTimeOfAFrameIsFoundInItsBeginning) {
  const std::string images(100'000, 'x');
  for (const std::uint64_t sequence : {std::uint64_t{0}, std::uint64_t{17}, ~std::uint64_t{0}}) {
    const std::string frame =
        format_client_message(Frame{sequence, 1305031102.175304, images, images});
    EXPECT_EQ(frame_time_in(std::string_view(frame).substr(0, kFrameTimeBytes)), 1305031102.175304)
        << sequence;
  }
  EXPECT_EQ(frame_time_in(format_client_message(Frame{1, 0, images, images})), std::nullopt)
      << "a zero is not written";
  EXPECT_EQ(frame_time_in(format_client_message(Finish{})), std::nullopt);
  const std::string frame = format_client_message(Frame{17, 2.5, images, images});
  for (std::size_t length = 0; length < 13; ++length)
    EXPECT_EQ(frame_time_in(std::string_view(frame).substr(0, length)), std::nullopt) << length;
}

}  // namespace
}  // namespace hermite::wire
