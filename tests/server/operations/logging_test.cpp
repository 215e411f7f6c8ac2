#include "server/operations/logging.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/spdlog.h>

#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

namespace hermite::server {
namespace {

using testing::HasSubstr;
using testing::Not;

std::vector<std::string> lines_of(const std::ostringstream& out) {
  std::istringstream in(out.str());
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

class LoggingTest : public testing::Test {
 protected:
  ~LoggingTest() override { spdlog::set_default_logger(before_); }
  void use(LogFormat format, const std::string& level = "info") {
    spdlog::set_default_logger(make_logger(out_, format, level));
  }

  std::ostringstream out_;
  const std::shared_ptr<spdlog::logger> before_ = spdlog::default_logger();
};

TEST_F(LoggingTest, JsonLinesHaveTheirFields) {
  use(LogFormat::kJson);
  log_with({"scan1", "192.0.2.7", 1.5}, spdlog::level::warn, "said \"no\"\nand more \xff");
  spdlog::info("plain");
  const std::vector<std::string> lines = lines_of(out_);
  ASSERT_EQ(lines.size(), 2u);
  const nlohmann::json first = nlohmann::json::parse(lines[0]),
                       second = nlohmann::json::parse(lines[1]);
  EXPECT_EQ(first["level"], "warning");
  EXPECT_THAT(first["msg"].get<std::string>(), HasSubstr("said \"no\"\nand more "));
  EXPECT_EQ(first["session"], "scan1");
  EXPECT_EQ(first["remote"], "192.0.2.7");
  EXPECT_EQ(first["duration"], 1.5);
  EXPECT_THAT(first["ts"].get<std::string>(), testing::MatchesRegex("20..-..-..T..:..:..\\....Z"));
  EXPECT_EQ(second.size(), 3u) << lines[1];
}

TEST_F(LoggingTest, TextStaysOnOneLine) {
  use(LogFormat::kText);
  log_with({"scan1", "", {}}, spdlog::level::info, "words\n2026 error forged \x1b[31m");
  ASSERT_EQ(lines_of(out_).size(), 1u);
  EXPECT_THAT(out_.str(), HasSubstr(" info words?2026 error forged ?[31m session=scan1\n"));
}

TEST_F(LoggingTest, TokensNeverGetOut) {
  use(LogFormat::kJson);
  const std::string token = "0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef";
  spdlog::error(
      "http://127.0.0.1/#token={} and Bearer {}, short 0123456789abcdef, scan "
      "abcdefghij0123456789klmnop",
      token, token);
  spdlog::error("/#token=abc_DEF-9&x=1");
  EXPECT_THAT(out_.str(), Not(HasSubstr(token.substr(0, 17))));
  EXPECT_THAT(out_.str(), HasSubstr("token=[secret] and Bearer [secret], short 0123456789abcdef, "
                                    "scan abcdefghij0123456789klmnop"));
  EXPECT_THAT(out_.str(), HasSubstr("token=[secret]&x=1"));
}

TEST_F(LoggingTest, LinesBelowTheLevelAreLeftOut) {
  use(LogFormat::kText, "warn");
  spdlog::info("no");
  spdlog::warn("yes");
  EXPECT_EQ(lines_of(out_).size(), 1u);
}

TEST_F(LoggingTest, RepeatedLinesAreLimitedAndCounted) {
  use(LogFormat::kText);
  for (int i = 0; i < 100; ++i) spdlog::warn("client {} is slow", i);
  spdlog::warn("something else");
  ASSERT_EQ(lines_of(out_).size(), static_cast<std::size_t>(kLinesPerWindow) + 1);
  std::this_thread::sleep_for(kLogWindow + std::chrono::milliseconds(50));
  spdlog::warn("client 7 is slow");
  EXPECT_THAT(lines_of(out_).back(), HasSubstr("client 7 is slow (and 95 more like this)"));
}

TEST_F(LoggingTest, ManyKindsOfLinesTakeBoundedMemoryAndAreAllWritten) {
  use(LogFormat::kText);
  for (int i = 0; i < 2000; ++i) spdlog::info(std::string(1 + static_cast<std::size_t>(i), 'x'));
  EXPECT_EQ(lines_of(out_).size(), 2000u);
}

}  // namespace
}  // namespace hermite::server
