#include "core/pipeline/options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

namespace hermite::pipeline::options_test {
namespace {

using testing::HasSubstr;

std::string value_of(const Options& options, const std::string& key) {
  for (const Setting& setting : list_settings(options))
    if (setting.key == key) return setting.value;
  return "there is no " + key;
}

bool is_flag(const Setting& setting) { return setting.value == "true" || setting.value == "false"; }

TEST(Options, EveryKeyIsUniqueAndSaysWhatItIs) {
  std::set<std::string> keys;
  for (const Setting& setting : list_settings(Options{})) {
    EXPECT_TRUE(keys.insert(setting.key).second) << setting.key << " twice";
    EXPECT_NE(setting.key.find('.'), std::string::npos) << setting.key;
    EXPECT_FALSE(setting.description.empty()) << setting.key;
    EXPECT_FALSE(setting.value.empty()) << setting.key;
  }
  EXPECT_GT(keys.size(), 30u);
}

TEST(Options, EveryDefaultIsAllowedAndReadsBackAsItself) {
  const std::vector<Setting> defaults = list_settings(Options{});
  Options options;
  for (const Setting& setting : defaults) {
    const Status applied = apply_setting(options, setting.key, setting.value);
    EXPECT_TRUE(applied.ok()) << setting.key << ": " << applied.error().message;
  }
  const std::vector<Setting> again = list_settings(options);
  for (std::size_t i = 0; i < defaults.size(); ++i)
    EXPECT_EQ(again[i].value, defaults[i].value) << defaults[i].key;
}

// Each key changes its own value and no other.
TEST(Options, EveryKeyIsItsOwn) {
  for (const Setting& setting : list_settings(Options{})) {
    Options options;
    std::string other;
    for (const char* candidate :
         is_flag(setting)
             ? std::vector<const char*>{"true", "false"}
             : std::vector<const char*>{"1", "5", "7", "20", "0.07", "0.9", "40", "1000"})
      if (candidate != setting.value && apply_setting(options, setting.key, candidate).ok()) {
        other = candidate;
        break;
      }
    ASSERT_FALSE(other.empty()) << setting.key << " can only be " << setting.value;
    for (const Setting& changed : list_settings(options))
      EXPECT_EQ(changed.value,
                changed.key == setting.key ? other : value_of(Options{}, changed.key))
          << "by " << setting.key;
  }
}

TEST(Options, NumbersKeepAllTheirDigits) {
  Options options;
  ASSERT_TRUE(apply_setting(options, "map.redundancy_depth_m", "0.012345678901234").ok());
  EXPECT_EQ(options.map.redundancy_depth_m, 0.012345678901234);
  EXPECT_EQ(value_of(options, "map.redundancy_depth_m"), "0.012345678901234");
  ASSERT_TRUE(apply_setting(options, "track.max_step_m", "2.5e-1").ok());
  EXPECT_EQ(value_of(options, "track.max_step_m"), "0.25");
}

TEST(Options, FlagsAreWordsOrDigits) {
  Options options;
  for (const char* yes : {"true", "1"}) {
    options.map.fuse_surface = false;
    EXPECT_TRUE(apply_setting(options, "map.fuse_surface", yes).ok());
    EXPECT_TRUE(options.map.fuse_surface);
  }
  for (const char* no : {"false", "0"}) {
    options.map.fuse_surface = true;
    EXPECT_TRUE(apply_setting(options, "map.fuse_surface", no).ok());
    EXPECT_FALSE(options.map.fuse_surface);
  }
}

TEST(Options, WhatIsOutOfRangeIsRefusedWithKeyValueAndRange) {
  Options options;
  for (const auto& [key, value] :
       std::vector<std::pair<std::string, std::string>>{{"frame.depth_max_m", "20.5"},
                                                        {"frame.depth_max_m", "0.4"},
                                                        {"frame.depth_max_m", "-1"},
                                                        {"frame.depth_max_m", "nan"},
                                                        {"frame.depth_max_m", "inf"},
                                                        {"frame.depth_max_m", ""},
                                                        {"frame.depth_max_m", "2m"},
                                                        {"frame.depth_max_m", " 2"},
                                                        {"map.min_support", "7.5"},
                                                        {"map.min_support", "1e99"},
                                                        {"map.min_support", "0"},
                                                        {"map.fuse_surface", "yes"},
                                                        {"map.fuse_surface", ""}}) {
    const Status status = apply_setting(options, key, value);
    ASSERT_FALSE(status.ok()) << key << "=" << value;
    EXPECT_EQ(status.error().code, ErrorCode::kInvalidArgument);
    EXPECT_THAT(status.error().message, HasSubstr(key));
    EXPECT_THAT(status.error().message, HasSubstr("'" + value + "'"));
    EXPECT_THAT(status.error().message, HasSubstr("allowed is"));
  }
  EXPECT_THAT(apply_setting(options, "frame.depth_max_m", "21").error().message,
              HasSubstr("0.5 to 20"));
  EXPECT_EQ(list_settings(options).size(), list_settings(Options{}).size());
  for (const Setting& setting : list_settings(Options{}))
    EXPECT_EQ(value_of(options, setting.key), setting.value) << "nothing was changed";
}

TEST(Options, AWindowHasAMiddle) {
  Options options;
  for (const char* odd : {"5", "7", "9"})
    EXPECT_TRUE(apply_setting(options, "map.window", odd).ok()) << odd;
  for (const char* other : {"4", "6", "8", "10", "11"})
    EXPECT_FALSE(apply_setting(options, "map.window", other).ok()) << other;
  EXPECT_EQ(options.map.window, 9);
  EXPECT_THAT(apply_setting(options, "map.window", "6").error().message, HasSubstr("5, 7 or 9"));
}

TEST(Options, UnknownKeysAreRefusedByName) {
  Options options;
  for (const char* key : {"", "window", "map.", "map.windows", "Map.window", "output"}) {
    const Status status = apply_setting(options, key, "1");
    ASSERT_FALSE(status.ok()) << key;
    EXPECT_EQ(status.error().code, ErrorCode::kNotFound);
    EXPECT_THAT(status.error().message, HasSubstr(std::string("'") + key + "'"));
  }
}

}  // namespace
}  // namespace hermite::pipeline::options_test
