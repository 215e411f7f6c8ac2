#include "core/pipeline/reason_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hermite::pipeline {
namespace reason_table_test {

using testing::HasSubstr;

TEST(ReasonTable, KeepsEachTextOnce) {
  ReasonTable table;
  EXPECT_EQ(table.number_of(""), kNoReason);
  EXPECT_EQ(table.text_of(kNoReason), "");
  const std::uint16_t fast = table.number_of("too fast"), dark = table.number_of("dark");
  EXPECT_EQ(table.number_of("too fast"), fast);
  EXPECT_NE(fast, dark);
  EXPECT_EQ(table.text_of(fast), "too fast");
  EXPECT_EQ(table.text_of(dark), "dark");
  EXPECT_EQ(table.size(), 2u);
}

TEST(ReasonTable, EveryTextIsOneShortLine) {
  ReasonTable table;
  EXPECT_EQ(table.text_of(table.number_of("too\nfast\x7f")), "too fast ");
  EXPECT_EQ(table.text_of(table.number_of("\xff")), "\xEF\xBF\xBD");
  const std::string cut =
      table.text_of(table.number_of(std::string(kMaxReasonBytes - 1, '-') + "\xC3\xA4"));
  EXPECT_EQ(cut, std::string(kMaxReasonBytes - 1, '-')) << "no half of a character";
  for (const std::string& text : {cut, std::string("\xC3\xA4"), std::string(kMaxReasonBytes, 'x')})
    EXPECT_TRUE(is_reason(text)) << text;
  for (const std::string& text : {std::string(), std::string("a\nb"), std::string("\xC3"),
                                  std::string(kMaxReasonBytes + 1, 'x')})
    EXPECT_FALSE(is_reason(text)) << text;
}

TEST(ReasonTable, IsBoundedHoweverManyReasonsThereAre) {
  ReasonTable table;
  for (std::size_t i = 0; i < kMaxReasons; ++i)
    ASSERT_EQ(table.number_of(std::to_string(i)), i + 1);
  EXPECT_EQ(table.number_of("another one"), kNoReason);
  EXPECT_EQ(table.number_of("17"), 18) << "those that it has are found";
  EXPECT_EQ(table.size(), kMaxReasons);
}

std::string saved(const ReasonTable& table) {
  ByteWriter bytes;
  table.save(bytes);
  return bytes.take();
}

TEST(ReasonTable, GoesOnAsItWasSaved) {
  ReasonTable table, restored;
  table.number_of("too fast");
  table.number_of("dark");
  const std::string bytes = saved(table);
  ByteReader reader(bytes);
  restored.restore(reader);
  EXPECT_TRUE(reader.ok() && reader.at_end());
  EXPECT_EQ(saved(restored), bytes);
  EXPECT_EQ(restored.number_of("dark"), table.number_of("dark"));
  EXPECT_EQ(restored.number_of("occluded"), table.number_of("occluded"));
}

TEST(ReasonTable, WhatWasNotSavedIsRefused) {
  const auto refusal = [](const std::vector<std::string>& texts) {
    ByteWriter bytes;
    bytes.list(texts, [](ByteWriter& to, const std::string& text) { to.text(text); });
    const std::string written = bytes.take();
    ByteReader reader(written);
    ReasonTable().restore(reader);
    return reader.ok() ? std::string() : reader.status().error().message;
  };
  EXPECT_THAT(refusal({"a", "a"}), HasSubstr("twice"));
  EXPECT_THAT(refusal({"a", ""}), HasSubstr("invalid"));
  EXPECT_THAT(refusal({"a\n"}), HasSubstr("invalid"));
  EXPECT_THAT(refusal(std::vector<std::string>(kMaxReasons + 1, "a")), HasSubstr("too many"));
}

}  // namespace reason_table_test
}  // namespace hermite::pipeline
