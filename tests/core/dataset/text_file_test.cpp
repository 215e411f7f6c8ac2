#include "core/dataset/text_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/core/dataset/temp_folder.h"

namespace hermite::dataset {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(TextFile, LinesKeepTheirNumbersWithoutCommentsAndLineEnds) {
  const auto lines = data_lines("# head\r\n\r\n 1 a \r\n#2 b\n3 c");
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(lines[0].number, 3);
  EXPECT_EQ(lines[0].text, "1 a");
  EXPECT_EQ(lines[1].number, 5);
  EXPECT_EQ(lines[1].text, "3 c");
  EXPECT_THAT(data_lines(""), IsEmpty());
}

TEST(TextFile, FieldsStandBetweenBlanksTabsAndCommas) {
  EXPECT_THAT(split_fields(" 1.5,rgb/a.png\t x "), ElementsAre("1.5", "rgb/a.png", "x"));
  EXPECT_THAT(split_fields("  "), IsEmpty());
}

TEST(TextFile, NumbersAreWholeFieldsAndFinite) {
  EXPECT_EQ(parse_finite("-1.25e2"), -125.0);
  for (const char* text : {"", "1,5", "1.5x", " 1", "nan", "inf", "0x10", "1e999"})
    EXPECT_FALSE(parse_finite(text)) << text;
  EXPECT_EQ(parse_index("000012"), 12);
  for (const char* text : {"", "-1", "+1", "1.0", "99999999999999999999"})
    EXPECT_FALSE(parse_index(text)) << text;
}

TEST(TextFile, FilesAreReadWithALimit) {
  const TempFolder folder;
  folder.write("a.txt", "12345");
  EXPECT_EQ(*read_text_file(folder.path("a.txt"), 5), "12345");
  EXPECT_THAT(*read_binary_file(folder.path("a.txt"), 5), ElementsAre('1', '2', '3', '4', '5'));
  const auto too_large = read_text_file(folder.path("a.txt"), 4);
  ASSERT_FALSE(too_large.ok());
  EXPECT_EQ(too_large.error().code, ErrorCode::kTooLarge);
  EXPECT_THAT(too_large.error().message, HasSubstr("5 bytes, allowed are 4"));
  EXPECT_EQ(read_text_file(folder.path("b.txt")).error().code, ErrorCode::kNotFound);
  EXPECT_EQ(read_text_file(folder.path()).error().code, ErrorCode::kIo);
}

TEST(TextFile, PathsTheSystemRefusesAreNeitherFileNorFolder) {
  const std::string long_name(10'000, 'x');
  EXPECT_FALSE(is_file(long_name));
  EXPECT_FALSE(is_folder(long_name));
  EXPECT_FALSE(read_text_file(long_name).ok());
}

TEST(TextFile, LineErrorsNameTheLineAndCutLongOnes) {
  const Error error = line_error("rgb.txt", {7, std::string_view("bad line")}, "no time");
  EXPECT_EQ(error.message, "rgb.txt, line 7: no time: \"bad line\"");
  const std::string endless(1'000'000, 'x');
  EXPECT_LT(line_error("rgb.txt", {7, endless}, "no time").message.size(), 200u);
}

}  // namespace
}  // namespace hermite::dataset
