#include "server/scan/checkpoint_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hermite::server {
namespace {

ScanCheckpoint some_checkpoint() {
  return {"a scan", 17, wire::TrackedFrame{12, 3.5}, std::string(3000, 'p') + "end"};
}

TEST(CheckpointFile, ComesBackAsItWas) {
  const Result<ScanCheckpoint> back = parse_checkpoint(format_checkpoint(some_checkpoint()));
  ASSERT_TRUE(back.ok()) << back.error().message;
  EXPECT_EQ(back->scan_id, "a scan");
  EXPECT_EQ(back->record_count, 17u);
  ASSERT_TRUE(back->last_tracked);
  EXPECT_EQ(back->last_tracked->sequence, 12u);
  EXPECT_EQ(back->last_tracked->timestamp_s, 3.5);
  EXPECT_EQ(back->pipeline, some_checkpoint().pipeline);
  ScanCheckpoint untracked = some_checkpoint();
  untracked.last_tracked.reset();
  EXPECT_FALSE(parse_checkpoint(format_checkpoint(untracked))->last_tracked);
}

TEST(CheckpointFile, EveryCutAndEveryLostBitIsCorrupt) {
  const std::string bytes = format_checkpoint(some_checkpoint());
  for (std::size_t length = 0; length < bytes.size(); ++length)
    EXPECT_EQ(parse_checkpoint(std::string_view(bytes).substr(0, length)).error().code,
              ErrorCode::kCorruptData)
        << length;
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    std::string damaged = bytes;
    damaged[at] = static_cast<char>(damaged[at] ^ 1);
    EXPECT_EQ(parse_checkpoint(damaged).error().code, ErrorCode::kCorruptData) << at;
  }
  EXPECT_THAT(parse_checkpoint(bytes + "x").error().message, testing::HasSubstr("checksum"));
}

}  // namespace
}  // namespace hermite::server
