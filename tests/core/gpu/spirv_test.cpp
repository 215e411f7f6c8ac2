#include "core/gpu/spirv.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "core/gpu/embedded.h"

namespace hermite::gpu::spirv_test {
namespace {

using Words = std::vector<std::uint32_t>;

Words embedded(std::string_view name) {
  for (const auto& [kernel, words] : embedded_kernels())
    if (kernel == name) return {words.begin(), words.end()};
  return {};
}

// A module out of instructions {op, operands...}, with a compute entry point and a local size
// unless told otherwise.
Words module(std::vector<Words> instructions, bool with_entry_point = true) {
  if (with_entry_point) {
    instructions.insert(instructions.begin(), {15, 5, 1, 0});         // OpEntryPoint GLCompute
    instructions.insert(instructions.begin(), {16, 1, 17, 4, 2, 1});  // OpExecutionMode LocalSize
  }
  Words words = {0x07230203, 0x00010500, 0, 100, 0};
  for (const Words& instruction : instructions) {
    words.push_back(static_cast<std::uint32_t>(instruction.size()) << 16 | instruction[0]);
    words.insert(words.end(), instruction.begin() + 1, instruction.end());
  }
  return words;
}

std::vector<Words> with_buffers(
    const std::vector<std::pair<std::uint32_t, std::uint32_t>>& set_and_binding,
    std::uint32_t storage_class = 12) {
  std::vector<Words> instructions;
  std::uint32_t id = 50;
  for (const auto& [set, binding] : set_and_binding) {
    instructions.push_back({71, id, 34, set});
    instructions.push_back({71, id, 33, binding});
    instructions.push_back({59, 40, id, storage_class});
    ++id;
  }
  return instructions;
}

void expect_refused(const Words& words, ErrorCode code, const std::string& part_of_words) {
  const Result<ShaderInterface> shader = read_interface(words);
  ASSERT_FALSE(shader.ok()) << "instead of: " << part_of_words;
  EXPECT_EQ(shader.error().code, code) << shader.error().message;
  EXPECT_THAT(shader.error().message, testing::HasSubstr(part_of_words));
}

TEST(ReadInterface, SpecialisedLocalSizeBuffersAndConstants) {
  const Result<ShaderInterface> shader = read_interface(embedded("test/affine"));
  ASSERT_TRUE(shader.ok()) << shader.error().message;
  EXPECT_EQ(shader->bindings.size(), 2u);
  EXPECT_THAT(shader->binding_names, testing::ElementsAre("source", "target"));
  EXPECT_EQ(shader->push_constant_bytes, 20u);
  EXPECT_THAT(shader->local_size, testing::ElementsAre(8, 2, 1));
  EXPECT_EQ(shader->local_size_constant[0], 0u);
  EXPECT_FALSE(shader->local_size_constant[1].has_value());
}

TEST(ReadInterface, SizesMatricesArraysAndStructs) {
  const Result<ShaderInterface> shader = read_interface(embedded("test/layouts"));
  ASSERT_TRUE(shader.ok()) << shader.error().message;
  EXPECT_EQ(shader->push_constant_bytes, 112u);
  EXPECT_THAT(shader->binding_names, testing::ElementsAre("floats", "target"))
      << "two views of binding 0 are one";
  EXPECT_THAT(shader->local_size, testing::ElementsAre(4, 3, 2));
}

TEST(ReadInterface, TellsTexelsFromStorage) {
  const Result<ShaderInterface> shader = read_interface(embedded("test/texels"));
  ASSERT_TRUE(shader.ok()) << shader.error().message;
  EXPECT_THAT(shader->bindings,
              testing::ElementsAre(Binding::kTexels, Binding::kTexels, Binding::kTexels,
                                   Binding::kTexels, Binding::kStorage));
  EXPECT_THAT(shader->binding_names,
              testing::ElementsAre("halves", "words", "pairs", "transforms", "target"));
}

TEST(ReadInterface, TellsWhatNeeds64BitAtomics) {
  EXPECT_TRUE(read_interface(embedded("map/index_nearest"))->needs_64_bit_atomics);
  EXPECT_FALSE(read_interface(embedded("map/index_depth"))->needs_64_bit_atomics);
}

TEST(ReadInterface, NothingIsTexelsWhereTheyAreInStorage) {
  ASSERT_EQ(embedded_kernels(ReadAs::kStorage).size(), embedded_kernels().size());
  for (std::size_t i = 0; i < embedded_kernels().size(); ++i) {
    const auto& [name, words] = embedded_kernels(ReadAs::kStorage)[i];
    EXPECT_EQ(name, embedded_kernels()[i].first);
    const Result<ShaderInterface> shader = read_interface(words),
                                  of_texels = read_interface(embedded_kernels()[i].second);
    ASSERT_TRUE(shader.ok()) << name << ": " << shader.error().message;
    EXPECT_THAT(shader->bindings, testing::Each(Binding::kStorage)) << name;
    EXPECT_EQ(shader->bindings.size(), of_texels->bindings.size()) << name;
    EXPECT_EQ(shader->push_constant_bytes, of_texels->push_constant_bytes) << name;
  }
}

TEST(ReadInterface, NoPushConstants) {
  const Result<ShaderInterface> shader = read_interface(embedded("test/count"));
  ASSERT_TRUE(shader.ok());
  EXPECT_EQ(shader->push_constant_bytes, 0u);
  EXPECT_EQ(shader->bindings.size(), 1u);
}

TEST(ReadInterface, EveryEmbeddedShaderIsUnderstood) {
  for (const auto& [name, words] : embedded_kernels()) {
    const Result<ShaderInterface> shader = read_interface(words);
    EXPECT_TRUE(shader.ok()) << name << ": " << shader.error().message;
  }
}

TEST(ReadInterface, LocalSizeFromConstantIds) {
  // OpConstant 30 = 16, OpSpecConstant 31 = 4 with SpecId 7; LocalSizeId (30, 31, 30).
  const Result<ShaderInterface> shader = read_interface(module(
      {{15, 5, 1, 0}, {331, 1, 38, 30, 31, 30}, {71, 31, 1, 7}, {43, 20, 30, 16}, {50, 20, 31, 4}},
      false));
  ASSERT_TRUE(shader.ok()) << shader.error().message;
  EXPECT_THAT(shader->local_size, testing::ElementsAre(16, 4, 16));
  EXPECT_EQ(shader->local_size_constant[1], 7u);
  EXPECT_FALSE(shader->local_size_constant[0].has_value());
}

TEST(ReadInterface, RefusesWhatIsNoModule) {
  expect_refused({}, ErrorCode::kCorruptData, "shorter than its header");
  expect_refused(Words(20, 0), ErrorCode::kCorruptData, "magic");
  expect_refused({0x03022307, 0, 0, 0, 0}, ErrorCode::kCorruptData, "magic");  // other byte order
  expect_refused({0x07230203, 0, 0, 0, 0, 0}, ErrorCode::kCorruptData, "outside the module");
  expect_refused({0x07230203, 0, 0, 0, 0, 5u << 16 | 59, 1}, ErrorCode::kCorruptData,
                 "outside the module");
  expect_refused(module({{59, 1, 2}}), ErrorCode::kCorruptData, "cut short");
}

TEST(ReadInterface, RefusesWhatTheDispatchCannotBind) {
  EXPECT_EQ(read_interface(module(with_buffers({{0, 1}, {0, 0}})))->bindings.size(), 2u);
  expect_refused(module(with_buffers({{0, 0}, {0, 2}})), ErrorCode::kUnsupported,
                 "up to 2 but only 2");
  expect_refused(module(with_buffers({{0, 0xffffffff}})), ErrorCode::kUnsupported,
                 "only 1 are declared");
  expect_refused(module(with_buffers({{1, 0}})), ErrorCode::kUnsupported, "not in set 0");
  expect_refused(module(with_buffers({{0, 0}}, 2)), ErrorCode::kUnsupported,
                 "only storage and texel buffers");
  expect_refused(module(with_buffers({{0, 0}}, 0)), ErrorCode::kUnsupported,
                 "only storage and texel buffers");
  expect_refused(module({{59, 40, 50, 12}}), ErrorCode::kUnsupported, "without a binding");
  // OpTypeInt 10, OpTypeImage 11 of dimension and use, OpTypeSampledImage 12, OpTypePointer 40
  // UniformConstant.
  const auto sampled = [](std::uint32_t dimension, std::uint32_t use) {
    return std::vector<Words>{
        {21, 10, 32, 0}, {25, 11, 10, dimension, 0, 0, 0, use, 0}, {27, 12, 11}, {32, 40, 0, 12}};
  };
  const auto with = [](std::vector<Words> types, const std::vector<Words>& variables) {
    types.insert(types.end(), variables.begin(), variables.end());
    return module(types);
  };
  EXPECT_THAT(read_interface(with(sampled(5, 1), with_buffers({{0, 0}}, 0)))->bindings,
              testing::ElementsAre(Binding::kTexels));
  expect_refused(with(sampled(1, 1), with_buffers({{0, 0}}, 0)), ErrorCode::kUnsupported,
                 "no uniforms or images");
  expect_refused(with(sampled(5, 2), with_buffers({{0, 0}}, 0)), ErrorCode::kUnsupported,
                 "no uniforms or images");
  std::vector<Words> both = with_buffers({{0, 0}}, 0);
  for (Words word : with_buffers({{0, 0}}, 12)) {
    if (word[0] == 71) word[1] = 60;  // another variable on the same binding
    if (word[0] == 59) word[2] = 60;
    both.push_back(word);
  }
  expect_refused(with(sampled(5, 1), both), ErrorCode::kUnsupported,
                 "a storage and a texel buffer");
}

TEST(ReadInterface, RefusesOtherEntryPoints) {
  expect_refused(module({}, false), ErrorCode::kUnsupported, "one compute entry point");
  expect_refused(module({{15, 4, 1, 0}}, false), ErrorCode::kUnsupported,
                 "one compute entry point");
  expect_refused(module({{15, 5, 2, 0}}), ErrorCode::kUnsupported, "one compute entry point");
  expect_refused(module({{15, 5, 1, 0}}, false), ErrorCode::kUnsupported, "no local size");
  expect_refused(module({{15, 5, 1, 0}, {16, 1, 17, 0, 1, 1}}, false), ErrorCode::kUnsupported,
                 "local size of 0");
}

TEST(ReadInterface, PushConstantTypesThatLoopOrExplodeEnd) {
  const auto push_constants_of = [](std::uint32_t type, std::vector<Words> types) {
    types.push_back({32, 90, 9, type});  // OpTypePointer PushConstant
    types.push_back({59, 90, 91, 9});    // OpVariable
    return module(types);
  };
  expect_refused(push_constants_of(60, {{30, 60, 60}, {72, 60, 0, 35, 0}}), ErrorCode::kUnsupported,
                 "16 deep");
  std::vector<Words> wide;  // each struct holds the one before 8 times: 8^12 leaves
  wide.push_back({21, 60, 32, 0});
  for (std::uint32_t i = 61; i < 73; ++i) {
    Words type = {30, i};
    for (std::uint32_t member = 0; member < 8; ++member) {
      type.push_back(i - 1);
      wide.push_back({72, i, member, 35, 0});
    }
    wide.push_back(type);
  }
  expect_refused(push_constants_of(72, wide), ErrorCode::kUnsupported, "10000 parts");
  expect_refused(push_constants_of(60, {{21, 61, 32, 0}, {30, 60, 61}}), ErrorCode::kCorruptData,
                 "without an offset");
  expect_refused(push_constants_of(99, {}), ErrorCode::kUnsupported, "a type other than");
}

TEST(ReadInterface, SurvivesDamagedModules) {
  std::mt19937 random(1);
  for (const char* name : {"test/affine", "test/layouts"}) {
    const Words good = embedded(name);
    for (std::size_t length = 0; length < good.size(); ++length)
      static_cast<void>(read_interface({good.data(), length}).ok());
    for (int round = 0; round < 4000; ++round) {
      Words bad = good;
      for (int hit = 0; hit < 3; ++hit)
        bad[random() % bad.size()] = round % 2 ? static_cast<std::uint32_t>(random())
                                               : static_cast<std::uint32_t>(random() % 64);
      const Result<ShaderInterface> shader = read_interface(bad);
      EXPECT_TRUE(!shader.ok() || shader->push_constant_bytes <= 1u << 20);
    }
  }
}

}  // namespace
}  // namespace hermite::gpu::spirv_test
