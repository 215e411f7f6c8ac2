#include "core/gpu/spirv.h"

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

namespace hermite::gpu {

namespace {

// Numbers from the SPIR-V specification, only those read here.
constexpr std::uint32_t kMagic = 0x07230203;
constexpr std::uint32_t kHeaderWords = 5;
constexpr std::uint32_t kMaxModuleWords = 16u << 20;
constexpr int kMaxNesting = 16;  // of types; a hostile module must not exhaust the stack
constexpr std::uint64_t kMaxTypeBytes = 1u << 20;
enum Op : std::uint32_t {
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
enum Decoration : std::uint32_t {
  kSpecId = 1,
  kRowMajor = 4,
  kArrayStride = 6,
  kMatrixStride = 7,
  kBuiltIn = 11,
  kBinding = 33,
  kDescriptorSet = 34,
  kOffset = 35
};
enum StorageClass : std::uint32_t { kUniformConstant = 0, kUniform = 2, kPushConstant = 9, kStorageBuffer = 12 };
constexpr std::uint32_t kBufferImage = 5, kSampled = 1;  // an image's dimension; how it is used
constexpr std::uint32_t kInt64Atomics = 12;              // a capability
constexpr std::uint32_t kGlCompute = 5, kLocalSize = 17, kLocalSizeId = 38, kWorkgroupSize = 25;

struct Type {
  std::uint32_t op = 0;
  std::vector<std::uint32_t> operands;  // after the result id
};
struct Variable {
  std::uint32_t pointer_type = 0, storage_class = 0, id = 0;
};

// Operands that a type has at least, its result among them.
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

std::uint64_t pair_of(std::uint32_t high, std::uint32_t low) { return std::uint64_t{high} << 32 | low; }

// Four bytes a word, the lowest first, up to a zero.
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

class Reader {
 public:
  Result<ShaderInterface> read(std::span<const std::uint32_t> words);

 private:
  Status scan(std::span<const std::uint32_t> words);
  Status take(std::uint32_t op, std::span<const std::uint32_t> operands);
  void take_decoration(std::span<const std::uint32_t> operands);
  void take_member_decoration(std::span<const std::uint32_t> operands);
  Status read_local_size(ShaderInterface& shader) const;
  Result<Binding> kind_of(const Variable& variable) const;
  std::string name_of(const Variable& variable) const;
  Status read_bindings(ShaderInterface& shader) const;
  Status read_push_constants(ShaderInterface& shader);
  Result<std::uint64_t> size_of(std::uint32_t type, std::optional<std::uint32_t> member, std::uint32_t parent, int depth);
  Result<std::uint64_t> size_of_struct(std::uint32_t type, const std::vector<std::uint32_t>& members, int depth);
  Result<std::uint64_t> size_of_matrix(const Type& matrix, std::uint64_t member_key, int depth);
  Result<std::uint64_t> size_of_array(std::uint32_t type, const Type& array, std::optional<std::uint32_t> member, std::uint32_t parent,
                                      int depth);

  std::optional<std::uint32_t> decoration(std::uint32_t id, Decoration kind) const;
  std::optional<std::uint32_t> member_decoration(std::uint64_t member_key, Decoration kind) const;
  std::optional<std::uint32_t> constant(std::uint32_t id) const;

  std::unordered_map<std::uint32_t, Type> types_;
  std::unordered_map<std::uint32_t, std::uint32_t> constants_;  // 32-bit ones, specialised ones with their defaults
  std::set<std::uint32_t> specialised_;
  std::unordered_map<std::uint32_t, std::vector<std::uint32_t>> composites_;
  std::vector<Variable> variables_;
  std::unordered_map<std::uint64_t, std::uint32_t> decorations_;  // (id, decoration)
  std::unordered_map<std::uint64_t, std::unordered_map<std::uint32_t, std::uint32_t>>
      member_decorations_;                                                                // (struct, member) -> decoration
  std::unordered_map<std::uint32_t, std::string> names_;                                  // of variables and others
  std::unordered_map<std::uint32_t, std::map<std::uint32_t, std::string>> member_names_;  // of structs
  std::vector<std::uint32_t> entry_models_;
  bool needs_64_bit_atomics_ = false;
  std::vector<std::uint32_t> local_size_literals_, local_size_ids_;
  int steps_left_ = 10000;  // structs of structs of structs: what is small in words can be endless to walk
};

Error corrupt(const std::string& words) { return {ErrorCode::kCorruptData, "SPIR-V: " + words}; }
Error unsupported(const std::string& words) { return {ErrorCode::kUnsupported, "shader: " + words}; }

Result<ShaderInterface> Reader::read(std::span<const std::uint32_t> words) {
  if (Status status = scan(words); !status.ok()) return status.error();
  if (entry_models_.size() != 1 || entry_models_[0] != kGlCompute) return unsupported("exactly one compute entry point is expected");
  ShaderInterface shader;
  shader.needs_64_bit_atomics = needs_64_bit_atomics_;
  if (Status status = read_local_size(shader); !status.ok()) return status.error();
  if (Status status = read_bindings(shader); !status.ok()) return status.error();
  if (Status status = read_push_constants(shader); !status.ok()) return status.error();
  return shader;
}

Status Reader::scan(std::span<const std::uint32_t> words) {
  if (words.size() < kHeaderWords) return corrupt("shorter than its header");
  if (words.size() > kMaxModuleWords) return corrupt("larger than 64 MiB");
  if (words[0] != kMagic) return corrupt("the magic number is missing");
  for (std::size_t at = kHeaderWords; at < words.size();) {
    const std::uint32_t op = words[at] & 0xffff, length = words[at] >> 16;
    if (length == 0 || length > words.size() - at)
      return corrupt("instruction at word " + std::to_string(at) + " reaches outside the module");
    if (Status status = take(op, words.subspan(at + 1, length - 1)); !status.ok()) return status;
    at += length;
  }
  return Done{};
}

// Operands are checked to be there; what they refer to is looked up, and may be missing, later.
Status Reader::take(std::uint32_t op, std::span<const std::uint32_t> operands) {
  const auto needs = [&](std::size_t count) { return operands.size() >= count; };
  const Error cut = corrupt("instruction " + std::to_string(op) + " is cut short");
  switch (op) {
    case kOpName:
      if (!needs(2)) return cut;
      names_[operands[0]] = text_of(operands.subspan(1));
      break;
    case kOpMemberName:
      if (!needs(3)) return cut;
      member_names_[operands[0]][operands[1]] = text_of(operands.subspan(2));
      break;
    case kOpEntryPoint:
      if (!needs(2)) return cut;
      entry_models_.push_back(operands[0]);
      break;
    case kOpExecutionMode:
    case kOpExecutionModeId:
      if (!needs(2)) return cut;
      if (operands[1] != kLocalSize && operands[1] != kLocalSizeId) break;
      if (!needs(5)) return cut;
      (operands[1] == kLocalSize ? local_size_literals_ : local_size_ids_).assign(operands.begin() + 2, operands.begin() + 5);
      break;
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
      // Types refer only to types before them, which keeps every walk over them finite.
      if (types_.contains(operands[0])) return corrupt("a type is defined twice");
      types_[operands[0]] = {op, {operands.begin() + 1, operands.end()}};
      break;
    }
    case kOpConstant:
    case kOpSpecConstant:
      if (!needs(3)) return cut;
      constants_[operands[1]] = operands[2];
      if (op == kOpSpecConstant) specialised_.insert(operands[1]);
      break;
    case kOpConstantComposite:
    case kOpSpecConstantComposite:
      if (!needs(2)) return cut;
      composites_[operands[1]].assign(operands.begin() + 2, operands.end());
      break;
    case kOpCapability:
      if (!needs(1)) return cut;
      needs_64_bit_atomics_ |= operands[0] == kInt64Atomics;
      break;
    case kOpVariable:
      if (!needs(3)) return cut;
      variables_.push_back({operands[0], operands[2], operands[1]});
      break;
    case kOpDecorate:
      if (!needs(2)) return cut;
      take_decoration(operands);
      break;
    case kOpMemberDecorate:
      if (!needs(3)) return cut;
      take_member_decoration(operands);
      break;
    default: break;
  }
  return Done{};
}

void Reader::take_decoration(std::span<const std::uint32_t> operands) {
  decorations_[pair_of(operands[0], operands[1])] = operands.size() > 2 ? operands[2] : 0;
}

void Reader::take_member_decoration(std::span<const std::uint32_t> operands) {
  member_decorations_[pair_of(operands[0], operands[1])][operands[2]] = operands.size() > 3 ? operands[3] : 0;
}

std::optional<std::uint32_t> Reader::decoration(std::uint32_t id, Decoration kind) const {
  const auto found = decorations_.find(pair_of(id, kind));
  return found == decorations_.end() ? std::nullopt : std::optional(found->second);
}

std::optional<std::uint32_t> Reader::member_decoration(std::uint64_t member_key, Decoration kind) const {
  const auto member = member_decorations_.find(member_key);
  if (member == member_decorations_.end()) return std::nullopt;
  const auto found = member->second.find(kind);
  return found == member->second.end() ? std::nullopt : std::optional(found->second);
}

std::optional<std::uint32_t> Reader::constant(std::uint32_t id) const {
  const auto found = constants_.find(id);
  return found == constants_.end() ? std::nullopt : std::optional(found->second);
}

// In falling precedence: the constant decorated WorkgroupSize (what `local_size_x_id` becomes), LocalSizeId, LocalSize.
Status Reader::read_local_size(ShaderInterface& shader) const {
  std::vector<std::uint32_t> ids = local_size_ids_;
  for (const auto& [id, parts] : composites_)
    if (decoration(id, kBuiltIn) == kWorkgroupSize) ids = parts;
  if (!ids.empty() && ids.size() != 3) return corrupt("a work group size of " + std::to_string(ids.size()) + " parts");
  if (ids.empty() && local_size_literals_.empty()) return unsupported("no local size");
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::optional<std::uint32_t> size = ids.empty() ? local_size_literals_[axis] : constant(ids[axis]);
    if (!size) return unsupported("the local size is not made of constants");
    if (*size == 0 || *size > 65536) return unsupported("a local size of " + std::to_string(*size));
    shader.local_size[axis] = *size;
    if (!ids.empty() && specialised_.contains(ids[axis])) shader.local_size_constant[axis] = decoration(ids[axis], kSpecId);
  }
  return Done{};
}

Result<Binding> Reader::kind_of(const Variable& variable) const {
  if (variable.storage_class == kStorageBuffer) return Binding::kStorage;
  const auto type_of = [&](std::uint32_t id, Op op) {
    const auto found = types_.find(id);
    return found != types_.end() && found->second.op == op ? &found->second : nullptr;
  };
  const Type* const pointer = type_of(variable.pointer_type, kOpTypePointer);
  const Type* const sampled = pointer ? type_of(pointer->operands[1], kOpTypeSampledImage) : nullptr;
  const Type* const image = sampled ? type_of(sampled->operands[0], kOpTypeImage) : nullptr;
  if (image && image->operands[1] == kBufferImage && image->operands[5] == kSampled) return Binding::kTexels;
  return unsupported("only storage and texel buffers can be bound, no uniforms or images");
}

// A block without a name of its own goes by its last member.
std::string Reader::name_of(const Variable& variable) const {
  if (const auto own = names_.find(variable.id); own != names_.end() && !own->second.empty()) return own->second;
  const auto pointer = types_.find(variable.pointer_type);
  if (pointer == types_.end() || pointer->second.op != kOpTypePointer) return "";
  const auto members = member_names_.find(pointer->second.operands[1]);
  return members == member_names_.end() ? "" : members->second.rbegin()->second;
}

Status Reader::read_bindings(ShaderInterface& shader) const {
  std::map<std::uint32_t, Binding> bindings;
  std::map<std::uint32_t, std::string> names;
  for (const Variable& variable : variables_) {
    if (variable.storage_class != kUniform && variable.storage_class != kUniformConstant && variable.storage_class != kStorageBuffer)
      continue;
    const Result<Binding> kind = kind_of(variable);
    if (!kind.ok()) return kind.error();
    const auto set = decoration(variable.id, kDescriptorSet), binding = decoration(variable.id, kBinding);
    if (!binding) return unsupported("a buffer without a binding");
    if (set.value_or(0) != 0) return unsupported("binding " + std::to_string(*binding) + " is not in set 0");
    names.emplace(*binding, name_of(variable));
    // Two views of one buffer may share a binding, if they see it alike.
    if (bindings.emplace(*binding, *kind).first->second != *kind)
      return unsupported("binding " + std::to_string(*binding) + " is a storage and a texel buffer");
  }
  if (!bindings.empty() && bindings.rbegin()->first + std::uint64_t{1} != bindings.size())
    return unsupported("bindings go up to " + std::to_string(bindings.rbegin()->first) + " but only " + std::to_string(bindings.size()) +
                       " are declared");
  for (const auto& [number, kind] : bindings) shader.bindings.push_back(kind);
  for (const auto& [number, name] : names) shader.binding_names.push_back(name);
  return Done{};
}

Status Reader::read_push_constants(ShaderInterface& shader) {
  for (const Variable& variable : variables_) {
    if (variable.storage_class != kPushConstant) continue;
    const auto pointer = types_.find(variable.pointer_type);
    if (pointer == types_.end() || pointer->second.op != kOpTypePointer) return corrupt("push constants without a pointer type");
    const Result<std::uint64_t> bytes = size_of(pointer->second.operands[1], std::nullopt, 0, 0);
    if (!bytes.ok()) return in_context("push constants", bytes.error());
    shader.push_constant_bytes = std::max(shader.push_constant_bytes, static_cast<std::uint32_t>(*bytes));
  }
  return Done{};
}

// `member` of `parent` is where the type stands: matrices take their layout from there, also through arrays.
Result<std::uint64_t> Reader::size_of(std::uint32_t type, std::optional<std::uint32_t> member, std::uint32_t parent, int depth) {
  if (--steps_left_ < 0) return unsupported("a type of more than 10000 parts");
  if (depth > kMaxNesting) return unsupported("types nested more than 16 deep");
  const auto found = types_.find(type);
  if (found == types_.end()) return unsupported("a type other than scalars, vectors, matrices, arrays and structs");
  const std::vector<std::uint32_t>& operands = found->second.operands;
  switch (found->second.op) {
    case kOpTypeInt:
    case kOpTypeFloat: {
      if (operands[0] != 8 && operands[0] != 16 && operands[0] != 32 && operands[0] != 64) return corrupt("a scalar of odd width");
      return std::uint64_t{operands[0] / 8};
    }
    case kOpTypeVector: {
      if (operands[1] < 2 || operands[1] > 4) return corrupt("a vector that has not 2 to 4 parts");
      const Result<std::uint64_t> part = size_of(operands[0], std::nullopt, 0, depth + 1);
      return part.ok() ? Result<std::uint64_t>(*part * operands[1]) : part;
    }
    case kOpTypeMatrix: return size_of_matrix(found->second, pair_of(parent, member.value_or(0xffffffff)), depth);
    case kOpTypeArray: return size_of_array(type, found->second, member, parent, depth);
    case kOpTypeStruct: return size_of_struct(type, operands, depth);
    case kOpTypePointer:
      if (depth > 0) return std::uint64_t{8};  // a buffer address
      [[fallthrough]];
    default: return unsupported("a type that has no size");
  }
}

Result<std::uint64_t> Reader::size_of_matrix(const Type& matrix, std::uint64_t member_key, int depth) {
  const std::optional<std::uint32_t> stride = member_decoration(member_key, kMatrixStride);
  if (!stride) return corrupt("a matrix without a stride");
  const auto column = types_.find(matrix.operands[0]);
  if (column == types_.end() || column->second.op != kOpTypeVector) return corrupt("a matrix that is not made of vectors");
  const Result<std::uint64_t> scalar = size_of(column->second.operands[0], std::nullopt, 0, depth + 1);
  if (!scalar.ok()) return scalar;
  const std::uint64_t column_count = matrix.operands[1], row_count = column->second.operands[1];
  if (column_count < 2 || column_count > 4 || row_count < 2 || row_count > 4) return corrupt("a matrix that is not 2x2 to 4x4");
  const bool row_major = member_decoration(member_key, kRowMajor).has_value();
  const std::uint64_t bytes =
      row_major ? (row_count - 1) * *stride + column_count * *scalar : (column_count - 1) * *stride + row_count * *scalar;
  if (bytes > kMaxTypeBytes) return unsupported("a type larger than 1 MiB");
  return bytes;
}

Result<std::uint64_t> Reader::size_of_array(std::uint32_t type, const Type& array, std::optional<std::uint32_t> member,
                                            std::uint32_t parent, int depth) {
  const std::optional<std::uint32_t> length = constant(array.operands[1]), stride = decoration(type, kArrayStride);
  if (!length || specialised_.contains(array.operands[1])) return unsupported("an array whose length is not a plain constant");
  if (!stride || *length == 0) return corrupt("an array without stride or elements");
  const Result<std::uint64_t> element = size_of(array.operands[0], member, parent, depth + 1);
  if (!element.ok()) return element;
  const std::uint64_t bytes = (std::uint64_t{*length} - 1) * *stride + *element;
  if (bytes > kMaxTypeBytes) return unsupported("a type larger than 1 MiB");
  return bytes;
}

Result<std::uint64_t> Reader::size_of_struct(std::uint32_t type, const std::vector<std::uint32_t>& members, int depth) {
  std::uint64_t bytes = 0;
  for (std::uint32_t i = 0; i < members.size(); ++i) {
    const std::optional<std::uint32_t> offset = member_decoration(pair_of(type, i), kOffset);
    if (!offset) return corrupt("a struct member without an offset");
    const Result<std::uint64_t> member = size_of(members[i], i, type, depth + 1);
    if (!member.ok()) return member;
    bytes = std::max(bytes, *offset + *member);
  }
  if (bytes > kMaxTypeBytes) return unsupported("a type larger than 1 MiB");
  return bytes;
}

}  // namespace

Result<ShaderInterface> read_interface(std::span<const std::uint32_t> words) { return Reader().read(words); }

}  // namespace hermite::gpu
