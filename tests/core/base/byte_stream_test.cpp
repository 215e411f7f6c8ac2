#include "core/base/byte_stream.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hermite {
namespace {

using testing::HasSubstr;

struct Part {
  std::uint16_t number = 0;
  std::string name;
};
struct Whole {
  double first = 0;
  std::vector<float> values;
  std::vector<bool> marks;
  bool mark = false;
  std::vector<Part> parts;
};

template <class Bytes, class Place>
void part_fields(Bytes& bytes, Place& part) {
  bytes.number(part.number);
  bytes.text(part.name);
  bytes.require(part.number != 13, "a part with an unlucky number");
}

template <class Bytes, class Place>
void fields(Bytes& bytes, Place& whole) {
  bytes.number(whole.first);
  bytes.numbers(whole.values);
  bytes.flags(whole.marks);
  bytes.flag(whole.mark);
  bytes.list(whole.parts, [](auto& to, auto& part) { part_fields(to, part); });
}

const Whole kWhole{1.25,
                   {1, 2, 3},
                   {true, false, false, false, true, true, false, true, true},
                   true,
                   {{7, "seven"}, {0, ""}}};

std::string written(const Whole& whole) {
  ByteWriter writer;
  fields(writer, whole);
  return writer.take();
}

TEST(ByteStream, ReadsBackWhatItWrote) {
  const std::string bytes = written(kWhole);
  ByteReader reader(bytes);
  Whole read;
  fields(reader, read);
  ASSERT_TRUE(reader.ok()) << reader.status().error().message;
  EXPECT_TRUE(reader.at_end());
  EXPECT_EQ(read.first, kWhole.first);
  EXPECT_EQ(read.values, kWhole.values);
  EXPECT_EQ(read.marks, kWhole.marks);
  EXPECT_TRUE(read.mark);
  ASSERT_EQ(read.parts.size(), 2u);
  EXPECT_EQ(read.parts[0].number, 7);
  EXPECT_EQ(read.parts[0].name, "seven");
  EXPECT_EQ(read.parts[1].name, "");
}

TEST(ByteStream, EveryCutIsAnError) {
  const std::string bytes = written(kWhole);
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    ByteReader reader(std::string_view(bytes).substr(0, length));
    Whole read;
    fields(reader, read);
    ASSERT_FALSE(reader.ok()) << length;
    EXPECT_EQ(reader.status().error().code, ErrorCode::kCorruptData);
    EXPECT_THAT(reader.status().error().message, HasSubstr("at byte"));
  }
}

TEST(ByteStream, NothingIsAllocatedForACountWithoutBytes) {
  for (const std::uint64_t count : {std::uint64_t{4}, std::uint64_t{1} << 40, ~std::uint64_t{0}}) {
    ByteWriter writer;
    writer.number(count);
    writer.number(std::uint32_t{1});
    const std::string bytes = writer.take();
    const auto refuses = [&bytes](auto read) {
      ByteReader reader(bytes);
      read(reader);
      return !reader.ok();
    };
    EXPECT_TRUE(refuses([](ByteReader& reader) {
      std::vector<double> values;
      reader.numbers(values);
      EXPECT_TRUE(values.empty());
    }));
    EXPECT_TRUE(refuses([](ByteReader& reader) {
      std::vector<Part> parts;
      reader.list(parts, [](auto& from, auto& part) { part_fields(from, part); });
      EXPECT_LE(parts.size(), 1u);
    }));
    if (count <= 4) continue;
    EXPECT_TRUE(refuses([](ByteReader& reader) {
      std::vector<bool> flags;
      reader.flags(flags);
      EXPECT_TRUE(flags.empty());
    }));
    EXPECT_TRUE(refuses([](ByteReader& reader) {
      std::string text;
      reader.text(text);
      EXPECT_TRUE(text.empty());
    }));
  }
}

TEST(ByteStream, TheFirstFailureStaysAndHasAMessage) {
  Whole wrong = kWhole;
  wrong.parts[0].number = 13;
  const std::string bytes = written(wrong);
  ByteReader reader(bytes);
  Whole read;
  fields(reader, read);
  reader.require(false, "something later");
  EXPECT_THAT(reader.status().error().message, HasSubstr("unlucky"));
  std::uint64_t after = 5;
  reader.number(after);
  EXPECT_EQ(after, 0u) << "what is read after a failure is nothing";
  std::string neither = "\x02";
  ByteReader flag_reader(neither);
  bool flag = true;
  flag_reader.flag(flag);
  EXPECT_FALSE(flag_reader.ok());
  EXPECT_FALSE(flag);
}

}  // namespace
}  // namespace hermite
