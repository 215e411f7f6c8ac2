#include "core/gpu/buffer.h"

#include <gtest/gtest.h>

#include <numeric>

#include "core/gpu/commands.h"
#include "core/gpu/transfer.h"

namespace hermite::gpu::buffer_test {
namespace {

std::vector<std::uint32_t> counting(std::size_t count, std::uint32_t first = 1) {
  std::vector<std::uint32_t> values(count);
  std::iota(values.begin(), values.end(), first);
  return values;
}

class BufferTest : public testing::Test {
 protected:
  ~BufferTest() override { EXPECT_EQ(device.validation_error_count(), 0); }
  Device device;
};

TEST_F(BufferTest, IsZeroWhenMadeInBothKindsOfMemory) {
  for (Memory memory : {Memory::kDevice, Memory::kReadback}) {
    {
      const Buffer<std::uint32_t> dirty = [&] {
        Buffer<std::uint32_t> b(device, 1000, "dirty", memory);
        b.upload(counting(1000));
        return b;
      }();
    }
    const Buffer<std::uint32_t> buffer(device, 1000, "clean", memory);
    EXPECT_EQ(buffer.download(), std::vector<std::uint32_t>(1000));
  }
}

TEST_F(BufferTest, UploadsAndDownloadsParts) {
  for (Memory memory : {Memory::kDevice, Memory::kReadback}) {
    Buffer<std::uint32_t> buffer(device, 10, "parts", memory);
    buffer.upload(counting(4), 3);
    EXPECT_EQ(buffer.download(), (std::vector<std::uint32_t>{0, 0, 0, 1, 2, 3, 4, 0, 0, 0}));
    EXPECT_EQ(buffer.download(2, 5), (std::vector<std::uint32_t>{3, 4}));
    std::vector<std::uint32_t> into(3);
    buffer.download_into(into, 4);
    EXPECT_EQ(into, (std::vector<std::uint32_t>{2, 3, 4}));
    buffer.upload({}, 10);
    EXPECT_TRUE(buffer.download(0, 10).empty());
  }
}

TEST_F(BufferTest, MovesMoreThanOneStagingPiece) {
  const std::vector<std::uint32_t> values = counting(5'000'000);  // 20 MB
  Buffer<std::uint32_t> buffer(device, values.size(), "large");
  buffer.upload(values);
  EXPECT_EQ(buffer.download(), values);
}

TEST_F(BufferTest, StagingTransfersAreExactAlsoWhereTheHostSeesTheMemory) {
  // On shared memory the staged path would otherwise never run here; on discrete devices it always
  // does.
  const std::vector<std::uint32_t> values = counting(3'000'000);
  Buffer<std::uint32_t> buffer(device, values.size() + 5, "staged");
  const BufferRef ref = buffer;
  device.transfer().upload(values.data(), ref.buffer, 8, values.size() * 4);
  EXPECT_EQ(buffer.download(values.size(), 2), values);
  EXPECT_EQ(buffer.download(2), (std::vector<std::uint32_t>{0, 0}));
  std::vector<std::uint32_t> back(values.size() - 1);
  device.transfer().download(ref.buffer, 12, back.data(), back.size() * 4);
  EXPECT_TRUE(std::equal(back.begin(), back.end(), values.begin() + 1));
  device.transfer().fill_with_zero(ref.buffer);
  EXPECT_EQ(buffer.download(), std::vector<std::uint32_t>(values.size() + 5));
}

TEST_F(BufferTest, ReadbackIsMappedAndSeesWhatTheGpuWrote) {
  Buffer<std::uint32_t> buffer(device, 100, "result", Memory::kReadback);
  ASSERT_TRUE(buffer.is_mapped());
  Commands commands(device);
  commands.fill(buffer, 7);
  commands.submit_and_wait();
  ASSERT_EQ(buffer.mapped().size(), 100u);
  for (std::uint32_t value : buffer.mapped()) EXPECT_EQ(value, 7u);
}

TEST_F(BufferTest, BytesAreRoundedUpForShaders) {
  const Buffer<std::uint8_t> odd(device, 5, "odd");
  EXPECT_EQ(odd.bytes(), 5u);
  EXPECT_EQ(BufferRef(odd).bytes, 8u);
  const Buffer<std::uint8_t> none(device, 0, "none");
  EXPECT_EQ(none.count(), 0u);
  EXPECT_EQ(BufferRef(none).bytes, 4u);  // can be bound
  EXPECT_TRUE(none.download().empty());
}

TEST_F(BufferTest, MovingLeavesTheSourceEmpty) {
  Buffer<std::uint32_t> first(device, 3, "moved");
  first.upload(counting(3));
  Buffer<std::uint32_t> second = std::move(first);
  EXPECT_EQ(first.count(), 0u);  // NOLINT: what a moved-from buffer is, is documented
  EXPECT_EQ(BufferRef(first).buffer, VK_NULL_HANDLE);
  EXPECT_EQ(second.download(), counting(3));
  second = Buffer<std::uint32_t>(device, 2, "moved");
  EXPECT_EQ(second.download(), std::vector<std::uint32_t>(2));
  EXPECT_EQ(device.memory_by_purpose().at("moved"), 8);
}

TEST_F(BufferTest, MemoryIsCountedByPurposeWhileItLives) {
  EXPECT_FALSE(device.memory_by_purpose().contains("model"));
  {
    const Buffer<std::uint32_t> a(device, 100, "model"), b(device, 50, "model");
    const Buffer<std::uint32_t> c(device, 10, "frame");
    EXPECT_EQ(device.memory_by_purpose().at("model"), 600);
    EXPECT_EQ(device.memory_by_purpose().at("frame"), 40);
  }
  EXPECT_FALSE(device.memory_by_purpose().contains("model"));
  EXPECT_FALSE(device.memory_by_purpose().contains("frame"));
}

TEST_F(BufferTest, TooLargeIsAnErrorThatNamesPurposeAndLimit) {
  for (std::size_t count :
       {static_cast<std::size_t>(device.info().max_buffer_bytes / 4 + 1), SIZE_MAX / 2, SIZE_MAX}) {
    try {
      const Buffer<std::uint32_t> buffer(device, count, "surfel positions");
      FAIL() << "no error for " << count;
    } catch (const DeviceError& error) {
      EXPECT_EQ(error.error().code, ErrorCode::kDevice);
      EXPECT_NE(std::string(error.what()).find("surfel positions"), std::string::npos)
          << error.what();
      EXPECT_NE(std::string(error.what()).find(bytes_as_text(device.info().max_buffer_bytes)),
                std::string::npos)
          << error.what();
    }
  }
  EXPECT_FALSE(device.memory_by_purpose().contains("surfel positions"));
  EXPECT_EQ(Buffer<std::uint32_t>(device, 4, "still works").download().size(), 4u);
}

class BufferDeathTest : public BufferTest {
 protected:
  // The driver has threads: the dying copy must be a fresh process, not a fork.
  BufferDeathTest() { GTEST_FLAG_SET(death_test_style, "threadsafe"); }
};

TEST_F(BufferDeathTest, AccessOutsideIsOurOwnMistake) {
  Buffer<std::uint32_t> buffer(device, 4, "small");
  const std::vector<std::uint32_t> five(5);
  EXPECT_DEATH(buffer.upload(five), "outside the buffer 'small'");
  EXPECT_DEATH(buffer.upload(counting(1), SIZE_MAX / 4), "outside the buffer");
  EXPECT_DEATH(buffer.download(2, 3), "outside the buffer");
  EXPECT_DEATH(buffer.download(SIZE_MAX, 2), "outside the buffer");
}

}  // namespace
}  // namespace hermite::gpu::buffer_test
