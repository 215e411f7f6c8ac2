#include "core/gpu/commands.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <stdexcept>

#include "core/gpu/transfer.h"

namespace hermite::gpu::commands_test {
namespace {

struct AffineParams {
  std::uint32_t width, height, depth, factor, offset;
};

class CommandsTest : public testing::Test {
 protected:
  ~CommandsTest() override { EXPECT_EQ(device.validation_error_count(), 0); }

  std::int64_t count_of(const std::string& kernel) const {
    for (const Device::PassTime& pass : device.pass_times())
      if (pass.kernel == kernel) return pass.dispatch_count;
    return 0;
  }

  Device device;
};

TEST_F(CommandsTest, EveryInvocationOfAnOddGridRunsOnce) {
  constexpr std::uint32_t kWidth = 13, kHeight = 5, kDepth = 3;
  std::vector<std::uint32_t> values(kWidth * kHeight * kDepth);
  for (std::uint32_t i = 0; i < values.size(); ++i) values[i] = 10 * i;
  Buffer<std::uint32_t> source(device, values.size(), "source"),
      target(device, values.size() + 4, "target");
  source.upload(values);
  const Kernel kernel(device, "test/affine");
  Commands commands(device);
  commands.dispatch(kernel, {kWidth, kHeight, kDepth}, AffineParams{kWidth, kHeight, kDepth, 3, 7},
                    {{"source", source}, {"target", target}});
  commands.submit_and_wait();
  const std::vector<std::uint32_t> result = target.download();
  for (std::uint32_t i = 0; i < values.size(); ++i) EXPECT_EQ(result[i], 3 * values[i] + 7) << i;
  for (std::size_t i = values.size(); i < result.size(); ++i)
    EXPECT_EQ(result[i], 0u) << "written outside the grid";
}

TEST_F(CommandsTest, TexelsAreTheWordsOfAnElement) {
  constexpr std::uint32_t kCount = 5, kWords = 16;
  std::uint32_t next = 0x7f800001u;  // as floats signalling NaNs: no word may be touched on its way
  const auto words = [&next] { return next++; };
  std::vector<std::uint16_t> halves(2 * kCount);
  for (std::size_t i = 0; i < halves.size(); ++i)
    halves[i] = static_cast<std::uint16_t>(0x8000 + i);
  std::vector<std::uint32_t> single(kCount);
  std::vector<std::array<std::uint32_t, 2>> pairs(kCount);
  std::vector<std::array<std::uint32_t, 12>> transforms(kCount);
  std::generate(single.begin(), single.end(), words);
  for (auto& pair : pairs) std::generate(pair.begin(), pair.end(), words);
  for (auto& transform : transforms) std::generate(transform.begin(), transform.end(), words);
  Buffer<std::uint16_t> a(device, halves.size(), "halves");
  Buffer<std::uint32_t> b(device, kCount, "words"), target(device, kCount * kWords, "target");
  Buffer<std::array<std::uint32_t, 2>> c(device, kCount, "pairs");
  Buffer<std::array<std::uint32_t, 12>> d(device, kCount, "transforms");
  a.upload(halves);
  b.upload(single);
  c.upload(pairs);
  d.upload(transforms);
  const Kernel kernel(device, "test/texels");
  Commands commands(device);
  commands.dispatch(
      kernel, {kCount},
      {{"halves", a}, {"words", b}, {"pairs", c}, {"transforms", d}, {"target", target}});
  commands.submit_and_wait();
  const std::vector<std::uint32_t> result = target.download();
  for (std::uint32_t i = 0; i < kCount; ++i) {
    std::vector<std::uint32_t> expected = {halves[2 * i] | std::uint32_t{halves[2 * i + 1]} << 16,
                                           single[i], pairs[i][0], pairs[i][1]};
    expected.insert(expected.end(), transforms[i].begin(), transforms[i].end());
    EXPECT_EQ(
        std::vector<std::uint32_t>(result.begin() + i * kWords, result.begin() + (i + 1) * kWords),
        expected)
        << i;
  }
}

TEST_F(CommandsTest, EachCommandSeesTheOnesBefore) {
  constexpr std::uint32_t kCount = 100'000;
  Buffer<std::uint32_t> counts(device, kCount, "counts"), copy(device, kCount, "copy");
  const Kernel kernel(device, "test/count");
  Commands commands(device);
  commands.fill(counts, 40);
  for (int i = 0; i < 50; ++i) commands.dispatch(kernel, {kCount}, {{"counts", counts}});
  commands.copy(counts, copy, kCount * 4);
  for (int i = 0; i < 3; ++i) commands.dispatch(kernel, {kCount}, {{"counts", counts}});
  commands.submit_and_wait();
  EXPECT_EQ(copy.download(), std::vector<std::uint32_t>(kCount, 90));
  EXPECT_EQ(counts.download(), std::vector<std::uint32_t>(kCount, 93));
}

TEST_F(CommandsTest, CopyTakesOnlyTheFirstBytes) {
  Buffer<std::uint32_t> from(device, 4, "from"), to(device, 4, "to");
  from.upload(std::vector<std::uint32_t>{1, 2, 3, 4});
  Commands commands(device);
  commands.copy(from, to, 8);
  commands.copy(from, to, 0);
  commands.submit_and_wait();
  EXPECT_EQ(to.download(), (std::vector<std::uint32_t>{1, 2, 0, 0}));
}

TEST_F(CommandsTest, AreReadyForReuseAndSeeLaterUploads) {
  Buffer<std::uint32_t> counts(device, 64, "counts");
  const Kernel kernel(device, "test/count");
  Commands commands(device);
  for (std::uint32_t round = 0; round < 20; ++round) {
    counts.upload(std::vector<std::uint32_t>(64, 100 * round));
    commands.dispatch(kernel, {64}, {{"counts", counts}});
    commands.submit_and_wait();
    EXPECT_EQ(counts.download(), std::vector<std::uint32_t>(64, 100 * round + 1));
  }
}

TEST_F(CommandsTest, NothingRecordedIsNothingToWaitFor) {
  Commands commands(device);
  commands.submit_and_wait();
  const Kernel kernel(device, "test/count");
  Buffer<std::uint32_t> counts(device, 64, "counts");
  commands.dispatch(kernel, {0}, {{"counts", counts}});  // no threads: no command
  commands.submit_and_wait();
  EXPECT_EQ(counts.download(), std::vector<std::uint32_t>(64));
  EXPECT_TRUE(device.pass_times().empty());
}

TEST_F(CommandsTest, TimesAreSummedByKernel) {
  Buffer<std::uint32_t> counts(device, 1 << 20, "counts");
  const Kernel kernel(device, "test/count"), same(device, "test/count");
  Commands commands(device);
  const auto start = std::chrono::steady_clock::now();
  // More than one query pool.
  for (int i = 0; i < 600; ++i)
    commands.dispatch(i % 2 ? kernel : same, {1 << 14}, {{"counts", counts}});
  commands.fill(counts, 1);
  commands.submit_and_wait();
  commands.dispatch(kernel, {1 << 20}, {{"counts", counts}});
  commands.submit_and_wait();
  const double wall_ms =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  EXPECT_EQ(count_of("test/count"), 601);
  EXPECT_EQ(count_of("(fill)"), 1);
  double sum_ms = 0;
  for (const Device::PassTime& pass : device.pass_times()) {
    EXPECT_EQ(pass.total_ms > 0, device.timestamp_period_ns() > 0) << pass.kernel;
    sum_ms += pass.total_ms;
  }
  EXPECT_LE(sum_ms, wall_ms);
  device.reset_pass_times();
  EXPECT_TRUE(device.pass_times().empty());
  commands.dispatch(kernel, {64}, {{"counts", counts}});
  commands.submit_and_wait();
  EXPECT_EQ(count_of("test/count"), 1);
}

TEST(CommandsTimeline, HasEveryCommandInOrderWithItsWork) {
  Timeline timeline;
  Device device("", &timeline);
  Buffer<std::uint32_t> counts(device, 1 << 18, "counts"), copied(device, 1 << 18, "copied");
  const Kernel kernel(device, "test/count");
  Commands commands(device);
  const Timeline::Clock::time_point start = Timeline::Clock::now();
  commands.fill(counts, 1);
  commands.dispatch(kernel, {1 << 18}, {{"counts", counts}});
  commands.submit_and_wait();
  const Timeline::Clock::time_point between = Timeline::Clock::now();
  commands.copy(counts, copied, 1 << 18);
  commands.submit_and_wait();
  const Timeline::Clock::time_point end = Timeline::Clock::now();

  ASSERT_EQ(timeline.passes.size(), 3u);
  EXPECT_TRUE(timeline.stages.empty()) << "of those the pipeline tells";
  const struct {
    std::string name;
    std::uint64_t invocations, bytes;
  } expected[] = {
      {"(fill)", 0, 4u << 18}, {"test/count", 1u << 18, 4u << 18}, {"(copy)", 0, 2u << 18}};
  for (std::size_t i = 0; i < 3; ++i) {
    const Timeline::Pass& pass = timeline.passes[i];
    EXPECT_EQ(pass.name, expected[i].name);
    EXPECT_EQ(pass.invocations, expected[i].invocations);
    EXPECT_EQ(pass.bytes_within_reach, expected[i].bytes);
    EXPECT_EQ(pass.duration_ms > 0, device.timestamp_period_ns() > 0);
    EXPECT_GE(pass.start, i < 2 ? start : between);
    const std::chrono::duration<double, std::milli> room = (i < 2 ? between : end) - pass.start;
    EXPECT_LE(pass.duration_ms, room.count());
  }
  EXPECT_GE(timeline.passes[1].start, timeline.passes[0].start);
}

TEST_F(CommandsTest, AGridBeyondTheDeviceIsAnError) {
  const std::uint32_t limit = device.limits().maxComputeWorkGroupCount[1];
  if (limit > 0x7fffffff) GTEST_SKIP() << "this device has no such limit";
  Buffer<std::uint32_t> source(device, 4, "source"), target(device, 4, "target");
  const Kernel kernel(device, "test/affine");
  Commands commands(device);
  try {
    commands.dispatch(kernel, {1, 2 * limit + 1, 1}, AffineParams{1, 1, 1, 1, 0},
                      {{"source", source}, {"target", target}});
    FAIL();
  } catch (const DeviceError& error) {
    EXPECT_NE(std::string(error.what()).find("test/affine"), std::string::npos) << error.what();
  }
  // Still usable.
  commands.dispatch(kernel, {4, 1, 1}, AffineParams{4, 1, 1, 0, 5},
                    {{"source", source}, {"target", target}});
  commands.submit_and_wait();
  EXPECT_EQ(target.download(), std::vector<std::uint32_t>(4, 5));
}

TEST_F(CommandsTest, PushConstantsArriveInEveryLayout) {
  struct Inner {
    float direction[3], lengths[3];
  };
  struct Params {
    float rotation[3][3];  // columns
    float flip[2][2];      // rows
    Inner inner[2];
    std::int32_t size[2];
    std::uint32_t last;
  };
  const Params params{{{1, 2, 3}, {4, 5, 6}, {7, 8, 9}},
                      {{1, 2}, {3, 4}},
                      {{{0, 0, 0}, {0, 0, 10}}, {{1, 10, 100}, {0, 0, 0}}},
                      {-1, 20},
                      300};
  Buffer<std::uint32_t> words(device, 2, "words");
  words.upload(std::vector<std::uint32_t>{0x40000000 /* 2.0f */, 4000});
  const Buffer<float> target(device, 3, "target");
  const Kernel kernel(device, "test/layouts");
  Commands commands(device);
  commands.dispatch(kernel, {1, 1, 1}, params, {{"floats", words}, {"target", target}});
  commands.submit_and_wait();
  EXPECT_EQ(target.download(), (std::vector<float>{1 + 40 + 700, 3 * 10 + 4 * 2, 20 + 300 + 4000}));
}

// The GPU is given more work than the limit allows: the call returns with an error, and nothing
// made from the device can hurt any more.
TEST(CommandsHangTest, AWaitHasAnEndAndTheDeviceIsGoneAfterwards) {
  Device device;
  Buffer<std::uint32_t> result(device, 2, "result");
  result.upload(std::vector<std::uint32_t>{12345, 1});
  const Kernel kernel(device, "test/spin");
  Commands commands(device);
  struct Params {
    std::uint32_t rounds;
  };
  // A second or so. Mesa's software driver ends all loops of an invocation after 65535 rounds
  // together: there, many short ones.
  const bool many = device.info().kind == DeviceKind::kCpu;
  commands.dispatch(kernel, {many ? 3'000u : 1u}, Params{many ? 6u : 40'000u},
                    {{"result", result}});
  try {
    commands.submit_and_wait(std::chrono::milliseconds(20));
    FAIL() << "a billion steps were done in 20 ms";
  } catch (const DeviceError& error) {
    EXPECT_NE(std::string(error.what()).find("hung"), std::string::npos) << error.what();
  }
  EXPECT_THROW(commands.dispatch(kernel, {1}, Params{1}, {{"result", result}}), DeviceError);
  EXPECT_THROW(device.transfer().fill_with_zero(BufferRef(result).buffer), DeviceError);
  EXPECT_EQ(device.validation_error_count(), 0);
  EXPECT_NO_THROW(Device());
}

// One command buffer and one fence, used again at once. What a submission costs is for the
// benchmark to say.
TEST(CommandsRepeatTest, ManySubmissionsOneAfterTheOtherAreAllDone) {
  Device device;
  Buffer<std::uint32_t> counts(device, 64, "counts", Memory::kReadback);
  const Kernel kernel(device, "test/count");
  Commands commands(device);
  constexpr std::uint32_t kRounds = 200;
  for (std::uint32_t i = 0; i < kRounds; ++i) {
    commands.dispatch(kernel, {64}, {{"counts", counts}});
    commands.submit_and_wait();
  }
  EXPECT_EQ(counts.mapped()[0], kRounds);
}

TEST(CommandsBesideTest, WorkOfTheHostIsDoneBesideThatOfTheDevice) {
  Device device;
  Buffer<std::uint32_t> counts(device, 64, "counts", Memory::kReadback);
  const Kernel kernel(device, "test/count");
  Commands commands(device);
  int done = 0;
  commands.submit_and_wait_beside([&] { ++done; });
  EXPECT_EQ(done, 1) << "also when nothing is recorded";
  commands.dispatch(kernel, {64}, {{"counts", counts}});
  commands.submit_and_wait_beside([&] { ++done; });
  EXPECT_EQ(done, 2);
  EXPECT_EQ(counts.mapped()[0], 1u);
}

TEST(CommandsBesideTest, WhatItThrowsIsThrownOnceTheDeviceIsDone) {
  Device device;
  Buffer<std::uint32_t> counts(device, 64, "counts", Memory::kReadback);
  const Kernel kernel(device, "test/count");
  Commands commands(device);
  for (std::uint32_t i = 1; i <= 3; ++i) {
    commands.dispatch(kernel, {64}, {{"counts", counts}});
    EXPECT_THROW(commands.submit_and_wait_beside([] { throw std::runtime_error("of the host"); }),
                 std::runtime_error);
    EXPECT_EQ(counts.mapped()[0], i) << "the device has finished, and takes more";
  }
}

class CommandsDeathTest : public CommandsTest {
 protected:
  // The driver has threads: the dying copy must be a fresh process, not a fork.
  CommandsDeathTest() { GTEST_FLAG_SET(death_test_style, "threadsafe"); }
};

TEST_F(CommandsDeathTest, WrongBuffersOrParametersAreOurOwnMistake) {
  Buffer<std::uint32_t> source(device, 4, "source"), target(device, 4, "target");
  const Kernel kernel(device, "test/affine");
  Commands commands(device);
  const AffineParams params{1, 1, 1, 1, 1};
  EXPECT_DEATH(commands.dispatch(kernel, {1}, params, {{"source", source}}),
               "binds 2 buffers, not 1");
  EXPECT_DEATH(commands.dispatch(kernel, {1}, {{"source", source}, {"target", target}}),
               "takes 20 bytes of parameters, not 0");
  EXPECT_DEATH(
      commands.dispatch(kernel, {1}, params.width, {{"source", source}, {"target", target}}),
      "takes 20 bytes of parameters, not 4");
  EXPECT_DEATH(
      commands.dispatch(kernel, {1}, params, {{"source", source}, {"target", Buffer<float>()}}),
      "target is empty");
  EXPECT_DEATH(commands.dispatch(kernel, {1}, params, {{"target", target}, {"source", source}}),
               "buffer 0 is 'source', not 'target'");
  EXPECT_DEATH(commands.copy(source, target, 20), "copy outside");
}

}  // namespace
}  // namespace hermite::gpu::commands_test
