#include "tests/bench/program/arguments.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hermite::bench {
namespace {

using testing::HasSubstr;

std::string refusal(const std::vector<std::string>& words) {
  const Result<Arguments> arguments = parse_arguments(words);
  if (arguments.ok()) return "accepted";
  return std::string(name_of(arguments.error().code)) + ": " + arguments.error().message;
}

TEST(BenchArguments, OptionsComeBeforeAndBehindTheFileJoinedOrNot) {
  const Result<Arguments> arguments = parse_arguments(
      {"--frames", "20", "room.raw", "--warm-up=3", "--elsewhere", "4000000", "--device", "llvm",
       "--set", "map.window=7", "--set=frame.sampling=1", "--trace", "trace.json"});
  ASSERT_TRUE(arguments.ok()) << arguments.error().message;
  EXPECT_FALSE(arguments->help);
  EXPECT_EQ(arguments->file, "room.raw");
  EXPECT_EQ(arguments->frame_count, 20);
  EXPECT_EQ(arguments->warm_up_count, 3);
  EXPECT_EQ(arguments->elsewhere_count, 4000000);
  EXPECT_EQ(arguments->device, "llvm");
  EXPECT_EQ(arguments->trace_file, "trace.json");
  EXPECT_EQ(arguments->options.map.window, 7);
  EXPECT_EQ(arguments->options.frame.sampling, 1);
}

TEST(BenchArguments, HelpNeedsNoFileAndNamesEveryOption) {
  const Result<Arguments> arguments = parse_arguments({"--help"});
  ASSERT_TRUE(arguments.ok());
  EXPECT_TRUE(arguments->help);
  for (const char* option : {"--frames", "--warm-up", "--device", "--set", "--trace", "--dump-raw"})
    EXPECT_THAT(help_text(), HasSubstr(option));
}

TEST(BenchArguments, WhatIsWrongIsSaid) {
  EXPECT_THAT(refusal({}), HasSubstr("which FILE"));
  EXPECT_THAT(refusal({"a.raw", "b.raw"}), HasSubstr("a.raw and b.raw"));
  EXPECT_THAT(refusal({"a.raw", "--frame", "3"}), HasSubstr("no option --frame;"));
  EXPECT_THAT(refusal({"a.raw", "--frames"}), HasSubstr("--frames wants a value"));
  for (const char* value : {"0", "-3", "3.5", "many", "", "10000000", "99999999999999999999"})
    EXPECT_THAT(refusal({"a.raw", "--frames", value}), HasSubstr("allowed is 1 to 1000000"))
        << value;
  EXPECT_THAT(refusal({"a.raw", "--warm-up", "-1"}), HasSubstr("--warm-up is '-1', allowed is 0"));
  EXPECT_THAT(refusal({"a.raw", "--set", "window"}), HasSubstr("expected key=value"));
  EXPECT_THAT(refusal({"a.raw", "--set", "map.window=6"}), HasSubstr("map.window"));
  EXPECT_THAT(refusal({"a.raw", "--set", "no.key=6"}), HasSubstr("no.key"));
}

}  // namespace
}  // namespace hermite::bench
