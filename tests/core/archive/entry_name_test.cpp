#include "core/archive/entry_name.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hermite::archive {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(EntryName, OfRecordingsPass) {
  EXPECT_THAT(*safe_entry_parts("rgbd/rgb/1305031102.175304.png"),
              ElementsAre("rgbd", "rgb", "1305031102.175304.png"));
  EXPECT_THAT(*safe_entry_parts("./a//b/./c"), ElementsAre("a", "b", "c"));
  EXPECT_THAT(*safe_entry_parts("..hidden/a..b"), ElementsAre("..hidden", "a..b"));
  EXPECT_TRUE(safe_entry_parts("./")->empty());
}

TEST(EntryName, TricksAreRefusedWithTheRule) {
  const auto refusal = [](const std::string& name) {
    const auto parts = safe_entry_parts(name);
    return parts.ok() ? "passed" : parts.error().message;
  };
  EXPECT_THAT(refusal(""), HasSubstr("empty"));
  EXPECT_THAT(refusal("/etc/passwd"), HasSubstr("absolute"));
  EXPECT_THAT(refusal("../a"), HasSubstr("leads out"));
  EXPECT_THAT(refusal("a/b/../../../c"), HasSubstr("leads out"));
  EXPECT_THAT(refusal("a\\..\\b"), HasSubstr("backslash"));
  EXPECT_THAT(refusal(std::string("a\0b", 3)), HasSubstr("control character"));
  EXPECT_THAT(refusal("a\nb"), HasSubstr("control character"));
  EXPECT_THAT(refusal("a\x7f"), HasSubstr("control character"));
  EXPECT_THAT(refusal("1/2/3/4/5/6/7/8/9"), HasSubstr("folders deep"));
  EXPECT_THAT(refusal(std::string(201, 'a')), HasSubstr("201 bytes, allowed are 200"));
  EXPECT_THAT(refusal(std::string(600, '/')), HasSubstr("600 bytes, allowed are 512"));
}

TEST(EntryName, IsShownWithoutWhatATerminalObeys) {
  EXPECT_EQ(shown_entry_name("a\x1b[2Jb\xff"), "a?[2Jb?");
  EXPECT_EQ(shown_entry_name(std::string(300, 'x')).size(), 103u);
}

}  // namespace
}  // namespace hermite::archive
