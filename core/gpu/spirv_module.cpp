#include "core/gpu/spirv_module.h"

namespace hermite::gpu {

namespace {

constexpr std::uint32_t kMagic = 0x07230203;
constexpr std::uint32_t kHeaderWords = 5;
constexpr std::uint32_t kMaxModuleWords = 16u << 20;

// Returns the least number of operands of a type instruction, including its result.
std::size_t words_of_type(std::uint32_t op) {
  switch (op) {
    case kOpTypeStruct: return 1;
    case kOpTypeInt:
    case kOpTypeFloat:
    case kOpTypeSampledImage: return 2;
    case kOpTypeImage: return 8;
    default: return 3;
  }
}

// Decodes four bytes per word, the lowest first, up to a zero.
std::string text_of(std::span<const std::uint32_t> words) {
  std::string text;
  for (const std::uint32_t word : words)
    for (int shift = 0; shift < 32; shift += 8) {
      const char letter = static_cast<char>(word >> shift & 0xff);
      if (letter == 0) return text;
      text += letter;
    }
  return text;
}

void take_name(std::uint32_t op, std::span<const std::uint32_t> operands, SpirvModule& module) {
  if (op == kOpName)
    module.names[operands[0]] = text_of(operands.subspan(1));
  else
    module.member_names[operands[0]][operands[1]] = text_of(operands.subspan(2));
}

Error cut_short(std::uint32_t op) {
  return corrupt_module("instruction " + std::to_string(op) + " is cut short");
}

// Reads types, constants and variables. Checks the number of operands.
Status take_definition(std::uint32_t op, std::span<const std::uint32_t> operands,
                       SpirvModule& module) {
  const auto needs = [&](std::size_t count) { return operands.size() >= count; };
  const Error cut = cut_short(op);
  switch (op) {
    case kOpTypeInt:
    case kOpTypeFloat:
    case kOpTypeVector:
    case kOpTypeMatrix:
    case kOpTypeImage:
    case kOpTypeSampledImage:
    case kOpTypeArray:
    case kOpTypeStruct:
    case kOpTypePointer: {
      if (!needs(words_of_type(op))) return cut;
      // Types refer only to earlier types, so every traversal is finite.
      if (module.types.contains(operands[0])) return corrupt_module("a type is defined twice");
      module.types[operands[0]] = {op, {operands.begin() + 1, operands.end()}};
      break;
    }
    case kOpConstant:
    case kOpSpecConstant:
      if (!needs(3)) return cut;
      module.constants[operands[1]] = operands[2];
      if (op == kOpSpecConstant) module.specialised.insert(operands[1]);
      break;
    case kOpConstantComposite:
    case kOpSpecConstantComposite:
      if (!needs(2)) return cut;
      module.composites[operands[1]].assign(operands.begin() + 2, operands.end());
      break;
    case kOpVariable:
      if (!needs(3)) return cut;
      module.variables.push_back({operands[0], operands[2], operands[1]});
      break;
    default: break;
  }
  return Done{};
}

// Checks the number of operands.
Status take(std::uint32_t op, std::span<const std::uint32_t> operands, SpirvModule& module) {
  const auto needs = [&](std::size_t count) { return operands.size() >= count; };
  const Error cut = cut_short(op);
  switch (op) {
    case kOpName:
    case kOpMemberName:
      if (!needs(op == kOpName ? 2 : 3)) return cut;
      take_name(op, operands, module);
      break;
    case kOpEntryPoint:
      if (!needs(2)) return cut;
      module.entry_models.push_back(operands[0]);
      break;
    case kOpExecutionMode:
    case kOpExecutionModeId:
      if (!needs(2)) return cut;
      if (operands[1] != kLocalSize && operands[1] != kLocalSizeId) break;
      if (!needs(5)) return cut;
      (operands[1] == kLocalSize ? module.local_size_literals : module.local_size_ids)
          .assign(operands.begin() + 2, operands.begin() + 5);
      break;
    case kOpCapability:
      if (!needs(1)) return cut;
      module.needs_64_bit_atomics |= operands[0] == kInt64Atomics;
      break;
    case kOpDecorate:
      if (!needs(2)) return cut;
      module.decorations[key_of(operands[0], operands[1])] = operands.size() > 2 ? operands[2] : 0;
      break;
    case kOpMemberDecorate:
      if (!needs(3)) return cut;
      module.member_decorations[key_of(operands[0], operands[1])][operands[2]] =
          operands.size() > 3 ? operands[3] : 0;
      break;
    default: return take_definition(op, operands, module);
  }
  return Done{};
}

}  // namespace

std::uint64_t key_of(std::uint32_t high, std::uint32_t low) {
  return std::uint64_t{high} << 32 | low;
}

Error corrupt_module(const std::string& words) {
  return {ErrorCode::kCorruptData, "SPIR-V: " + words};
}

Result<SpirvModule> scan_module(std::span<const std::uint32_t> words) {
  if (words.size() < kHeaderWords) return corrupt_module("shorter than its header");
  if (words.size() > kMaxModuleWords) return corrupt_module("larger than 64 MiB");
  if (words[0] != kMagic) return corrupt_module("the magic number is missing");
  SpirvModule module;
  for (std::size_t at = kHeaderWords; at < words.size();) {
    const std::uint32_t op = words[at] & 0xffff, length = words[at] >> 16;
    if (length == 0 || length > words.size() - at)
      return corrupt_module("instruction at word " + std::to_string(at) +
                            " reaches outside the module");
    if (Status status = take(op, words.subspan(at + 1, length - 1), module); !status.ok())
      return status.error();
    at += length;
  }
  return module;
}

std::optional<std::uint32_t> SpirvModule::decoration(std::uint32_t id, SpirvDecoration kind) const {
  const auto found = decorations.find(key_of(id, kind));
  return found == decorations.end() ? std::nullopt : std::optional(found->second);
}

std::optional<std::uint32_t> SpirvModule::member_decoration(std::uint64_t member_key,
                                                            SpirvDecoration kind) const {
  const auto member = member_decorations.find(member_key);
  if (member == member_decorations.end()) return std::nullopt;
  const auto found = member->second.find(kind);
  return found == member->second.end() ? std::nullopt : std::optional(found->second);
}

std::optional<std::uint32_t> SpirvModule::constant(std::uint32_t id) const {
  const auto found = constants.find(id);
  return found == constants.end() ? std::nullopt : std::optional(found->second);
}

}  // namespace hermite::gpu
