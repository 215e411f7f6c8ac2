// The instructions of a SPIR-V module that define a pipeline's interface (spirv.h), sorted into
// tables.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "core/base/result.h"

namespace hermite::gpu {

// Numbers from the SPIR-V specification, only those used here.
enum SpirvOp : std::uint32_t {
  kOpName = 5,
  kOpMemberName = 6,
  kOpEntryPoint = 15,
  kOpExecutionMode = 16,
  kOpCapability = 17,
  kOpTypeInt = 21,
  kOpTypeFloat = 22,
  kOpTypeVector = 23,
  kOpTypeMatrix = 24,
  kOpTypeImage = 25,
  kOpTypeSampledImage = 27,
  kOpTypeArray = 28,
  kOpTypeStruct = 30,
  kOpTypePointer = 32,
  kOpConstant = 43,
  kOpConstantComposite = 44,
  kOpSpecConstant = 50,
  kOpSpecConstantComposite = 51,
  kOpVariable = 59,
  kOpDecorate = 71,
  kOpMemberDecorate = 72,
  kOpExecutionModeId = 331
};
enum SpirvDecoration : std::uint32_t {
  kSpecId = 1,
  kRowMajor = 4,
  kArrayStride = 6,
  kMatrixStride = 7,
  kBuiltIn = 11,
  kBinding = 33,
  kDescriptorSet = 34,
  kOffset = 35
};
enum SpirvStorageClass : std::uint32_t {
  kUniformConstant = 0,
  kUniform = 2,
  kPushConstant = 9,
  kStorageBuffer = 12
};
// The dimension of an image, and how it is used.
inline constexpr std::uint32_t kBufferImage = 5, kSampled = 1;
inline constexpr std::uint32_t kInt64Atomics = 12;  // a capability
inline constexpr std::uint32_t kGlCompute = 5, kLocalSize = 17, kLocalSizeId = 38,
                               kWorkgroupSize = 25;

struct SpirvType {
  std::uint32_t op = 0;
  std::vector<std::uint32_t> operands;  // after the result id
};
struct SpirvVariable {
  std::uint32_t pointer_type = 0, storage_class = 0, id = 0;
};

struct SpirvModule {
  // Each refers only to earlier types, so every traversal is finite.
  std::unordered_map<std::uint32_t, SpirvType> types;
  // 32-bit constants; specialisation constants with their defaults.
  std::unordered_map<std::uint32_t, std::uint32_t> constants;
  std::set<std::uint32_t> specialised;
  std::unordered_map<std::uint32_t, std::vector<std::uint32_t>> composites;
  std::vector<SpirvVariable> variables;
  // By key_of(id, decoration).
  std::unordered_map<std::uint64_t, std::uint32_t> decorations;
  // By key_of(struct, member).
  std::unordered_map<std::uint64_t, std::unordered_map<std::uint32_t, std::uint32_t>>
      member_decorations;
  // Names of variables and others.
  std::unordered_map<std::uint32_t, std::string> names;
  // Names of the members of structs.
  std::unordered_map<std::uint32_t, std::map<std::uint32_t, std::string>> member_names;
  std::vector<std::uint32_t> entry_models;
  bool needs_64_bit_atomics = false;
  std::vector<std::uint32_t> local_size_literals, local_size_ids;

  std::optional<std::uint32_t> decoration(std::uint32_t id, SpirvDecoration kind) const;
  std::optional<std::uint32_t> member_decoration(std::uint64_t member_key,
                                                 SpirvDecoration kind) const;
  std::optional<std::uint32_t> constant(std::uint32_t id) const;
};

std::uint64_t key_of(std::uint32_t high, std::uint32_t low);

// Returns the tables; kCorruptData for words that are no SPIR-V, for an instruction that is
// truncated or exceeds the module, and for a type that is defined twice. Ids that instructions
// refer to are looked up later and may be missing. Pure; safe for any words.
Result<SpirvModule> scan_module(std::span<const std::uint32_t> words);

Error corrupt_module(const std::string& words);

}  // namespace hermite::gpu
