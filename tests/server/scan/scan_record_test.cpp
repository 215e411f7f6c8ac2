#include "server/scan/scan_record.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/digest/sha256.h"
#include "proto/wire/client_message.h"

namespace hermite::server {
namespace {

using testing::HasSubstr;
using testing::Not;

ScanRecord some_record() {
  ScanRecord record;
  record.resume_token_sha256 = digest::sha256_hex("a token");
  record.gpu_memory_mb = 512;
  record.credit_window = 3;
  record.request.title = "Küche";
  record.request.camera = {640,   480,   525,  526,
                           319.5, 239.5, 5000, {0.1, -0.2, 0.003, -0.004, 0.05}};
  record.request.depth_codecs = {wire::DepthCodec::kPng16};
  record.request.color_codecs = {wire::ColorCodec::kJpeg};
  record.request.mode = wire::Mode::kLive;
  record.request.settings = {{"map.window", "5"}};
  return record;
}

TEST(ScanRecord, ComesBackAsItWas) {
  const ScanRecord record = some_record();
  const auto back = parse_scan_record(format_terms(record), format_start(record));
  ASSERT_TRUE(back.ok()) << back.error().message;
  EXPECT_EQ(back->resume_token_sha256, record.resume_token_sha256);
  EXPECT_EQ(back->gpu_memory_mb, 512);
  EXPECT_EQ(back->credit_window, 3u);
  EXPECT_EQ(back->request.title, "Küche");
  EXPECT_EQ(back->request.camera, record.request.camera) << "with its lens";
  EXPECT_EQ(back->request.depth_codecs, record.request.depth_codecs);
  EXPECT_EQ(back->request.mode, wire::Mode::kLive);
  EXPECT_EQ(back->request.settings, record.request.settings);
}

TEST(ScanRecord, HoldsNoToken) {
  const ScanRecord record = some_record();
  EXPECT_THAT(format_terms(record), Not(HasSubstr("a token")));
}

TEST(ScanRecord, OnlyItsOwnTokenResumesAScan) {
  EXPECT_TRUE(check_resume_token("a token", digest::sha256_hex("a token")).ok());
  for (const char* wrong : {"", "a toke", "a tokens", "A token"}) {
    const Status status = check_resume_token(wrong, digest::sha256_hex("a token"));
    ASSERT_FALSE(status.ok()) << wrong;
    EXPECT_EQ(status.error().code, ErrorCode::kUnauthorized);
  }
  EXPECT_FALSE(check_resume_token("", "").ok()) << "its camera cannot come back";
}

TEST(ScanRecord, WhatIsNoneIsSaidInAMessage) {
  const ScanRecord record = some_record();
  const std::string terms = format_terms(record), start = format_start(record);
  for (const char* bad :
       {"", "{", "[]", "{}", R"({"gpu_memory_mb":-1,"credit_window":3,"resume_token_sha256":""})",
        R"({"gpu_memory_mb":1,"credit_window":0,"resume_token_sha256":""})",
        R"({"gpu_memory_mb":1,"credit_window":3,"resume_token_sha256":7})"}) {
    const auto record_or_error = parse_scan_record(bad, start);
    ASSERT_FALSE(record_or_error.ok()) << bad;
    EXPECT_EQ(record_or_error.error().code, ErrorCode::kCorruptData);
  }
  for (const std::string& bad : {std::string(), start.substr(0, start.size() / 2),
                                 wire::format_client_message(wire::Finish{})})
    EXPECT_FALSE(parse_scan_record(terms, bad).ok());
}

TEST(ScanRecord, TheSmallerShareOfMemoryHolds) {
  ScanRecord record = some_record();
  EXPECT_EQ(options_of(record)->map.gpu_memory_mb, 512);
  record.request.settings["map.gpu_memory_mb"] = "100";
  EXPECT_EQ(options_of(record)->map.gpu_memory_mb, 100);
  record.request.settings = {{"no.such_setting", "1"}};
  EXPECT_FALSE(options_of(record).ok());
}

}  // namespace
}  // namespace hermite::server
