#include "core/gpu/spirv.h"

#include <algorithm>
#include <map>
#include <utility>

#include "core/gpu/spirv_module.h"

namespace hermite::gpu {

namespace {

// Limit for the nesting of types; a malicious module must not exhaust the stack.
constexpr int kMaxNesting = 16;
constexpr std::uint64_t kMaxTypeBytes = 1u << 20;

class Reader {
 public:
  explicit Reader(SpirvModule module) : module_(std::move(module)) {}

  Result<ShaderInterface> read();

 private:
  Status read_local_size(ShaderInterface& shader) const;
  Result<Binding> kind_of(const SpirvVariable& variable) const;
  std::string name_of(const SpirvVariable& variable) const;
  Status read_bindings(ShaderInterface& shader) const;
  Status read_push_constants(ShaderInterface& shader);
  Result<std::uint64_t> size_of(std::uint32_t type, std::optional<std::uint32_t> member,
                                std::uint32_t parent, int depth);
  Result<std::uint64_t> size_of_struct(std::uint32_t type,
                                       const std::vector<std::uint32_t>& members, int depth);
  Result<std::uint64_t> size_of_matrix(const SpirvType& matrix, std::uint64_t member_key,
                                       int depth);
  Result<std::uint64_t> size_of_array(std::uint32_t type, const SpirvType& array,
                                      std::optional<std::uint32_t> member, std::uint32_t parent,
                                      int depth);

  const SpirvModule module_;
  // Deeply nested structs can be small in words but take endless time to traverse.
  int steps_left_ = 10000;
};

Error unsupported(const std::string& words) {
  return {ErrorCode::kUnsupported, "shader: " + words};
}

Result<ShaderInterface> Reader::read() {
  if (module_.entry_models.size() != 1 || module_.entry_models[0] != kGlCompute)
    return unsupported("exactly one compute entry point is expected");
  ShaderInterface shader;
  shader.needs_64_bit_atomics = module_.needs_64_bit_atomics;
  if (Status status = read_local_size(shader); !status.ok()) return status.error();
  if (Status status = read_bindings(shader); !status.ok()) return status.error();
  if (Status status = read_push_constants(shader); !status.ok()) return status.error();
  return shader;
}

// Sources of the local size in decreasing precedence: the constant decorated WorkgroupSize (the
// result of `local_size_x_id`), LocalSizeId, LocalSize.
Status Reader::read_local_size(ShaderInterface& shader) const {
  std::vector<std::uint32_t> ids = module_.local_size_ids;
  for (const auto& [id, parts] : module_.composites)
    if (module_.decoration(id, kBuiltIn) == kWorkgroupSize) ids = parts;
  if (!ids.empty() && ids.size() != 3)
    return corrupt_module("a work group size of " + std::to_string(ids.size()) + " parts");
  if (ids.empty() && module_.local_size_literals.empty()) return unsupported("no local size");
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::optional<std::uint32_t> size =
        ids.empty() ? module_.local_size_literals[axis] : module_.constant(ids[axis]);
    if (!size) return unsupported("the local size is not made of constants");
    if (*size == 0 || *size > 65536) return unsupported("a local size of " + std::to_string(*size));
    shader.local_size[axis] = *size;
    if (!ids.empty() && module_.specialised.contains(ids[axis]))
      shader.local_size_constant[axis] = module_.decoration(ids[axis], kSpecId);
  }
  return Done{};
}

Result<Binding> Reader::kind_of(const SpirvVariable& variable) const {
  if (variable.storage_class == kStorageBuffer) return Binding::kStorage;
  const auto type_of = [&](std::uint32_t id, SpirvOp op) {
    const auto found = module_.types.find(id);
    return found != module_.types.end() && found->second.op == op ? &found->second : nullptr;
  };
  const SpirvType* const pointer = type_of(variable.pointer_type, kOpTypePointer);
  const SpirvType* const sampled =
      pointer ? type_of(pointer->operands[1], kOpTypeSampledImage) : nullptr;
  const SpirvType* const image = sampled ? type_of(sampled->operands[0], kOpTypeImage) : nullptr;
  if (image && image->operands[1] == kBufferImage && image->operands[5] == kSampled)
    return Binding::kTexels;
  return unsupported("only storage and texel buffers can be bound, no uniforms or images");
}

// A block without a name of its own is called by its last member.
std::string Reader::name_of(const SpirvVariable& variable) const {
  if (const auto own = module_.names.find(variable.id);
      own != module_.names.end() && !own->second.empty())
    return own->second;
  const auto pointer = module_.types.find(variable.pointer_type);
  if (pointer == module_.types.end() || pointer->second.op != kOpTypePointer) return "";
  const auto members = module_.member_names.find(pointer->second.operands[1]);
  return members == module_.member_names.end() ? "" : members->second.rbegin()->second;
}

Status Reader::read_bindings(ShaderInterface& shader) const {
  std::map<std::uint32_t, Binding> bindings;
  std::map<std::uint32_t, std::string> names;
  for (const SpirvVariable& variable : module_.variables) {
    if (variable.storage_class != kUniform && variable.storage_class != kUniformConstant &&
        variable.storage_class != kStorageBuffer)
      continue;
    const Result<Binding> kind = kind_of(variable);
    if (!kind.ok()) return kind.error();
    const auto set = module_.decoration(variable.id, kDescriptorSet),
               binding = module_.decoration(variable.id, kBinding);
    if (!binding) return unsupported("a buffer without a binding");
    if (set.value_or(0) != 0)
      return unsupported("binding " + std::to_string(*binding) + " is not in set 0");
    names.emplace(*binding, name_of(variable));
    // Two variables may share a binding if they have the same kind.
    if (bindings.emplace(*binding, *kind).first->second != *kind)
      return unsupported("binding " + std::to_string(*binding) +
                         " is a storage and a texel buffer");
  }
  if (!bindings.empty() && bindings.rbegin()->first + std::uint64_t{1} != bindings.size())
    return unsupported("bindings go up to " + std::to_string(bindings.rbegin()->first) +
                       " but only " + std::to_string(bindings.size()) + " are declared");
  for (const auto& [number, kind] : bindings) shader.bindings.push_back(kind);
  for (const auto& [number, name] : names) shader.binding_names.push_back(name);
  return Done{};
}

Status Reader::read_push_constants(ShaderInterface& shader) {
  for (const SpirvVariable& variable : module_.variables) {
    if (variable.storage_class != kPushConstant) continue;
    const auto pointer = module_.types.find(variable.pointer_type);
    if (pointer == module_.types.end() || pointer->second.op != kOpTypePointer)
      return corrupt_module("push constants without a pointer type");
    const Result<std::uint64_t> bytes = size_of(pointer->second.operands[1], std::nullopt, 0, 0);
    if (!bytes.ok()) return in_context("push constants", bytes.error());
    shader.push_constant_bytes =
        std::max(shader.push_constant_bytes, static_cast<std::uint32_t>(*bytes));
  }
  return Done{};
}

// `member` of `parent` is where the type is used: matrices, also within arrays, get their layout
// from there.
Result<std::uint64_t> Reader::size_of(std::uint32_t type, std::optional<std::uint32_t> member,
                                      std::uint32_t parent, int depth) {
  if (--steps_left_ < 0) return unsupported("a type of more than 10000 parts");
  if (depth > kMaxNesting) return unsupported("types nested more than 16 deep");
  const auto found = module_.types.find(type);
  if (found == module_.types.end())
    return unsupported("a type other than scalars, vectors, matrices, arrays and structs");
  const std::vector<std::uint32_t>& operands = found->second.operands;
  switch (found->second.op) {
    case kOpTypeInt:
    case kOpTypeFloat: {
      if (operands[0] != 8 && operands[0] != 16 && operands[0] != 32 && operands[0] != 64)
        return corrupt_module("a scalar of odd width");
      return std::uint64_t{operands[0] / 8};
    }
    case kOpTypeVector: {
      if (operands[1] < 2 || operands[1] > 4)
        return corrupt_module("a vector that has not 2 to 4 parts");
      const Result<std::uint64_t> part = size_of(operands[0], std::nullopt, 0, depth + 1);
      return part.ok() ? Result<std::uint64_t>(*part * operands[1]) : part;
    }
    case kOpTypeMatrix:
      return size_of_matrix(found->second, key_of(parent, member.value_or(0xffffffff)), depth);
    case kOpTypeArray: return size_of_array(type, found->second, member, parent, depth);
    case kOpTypeStruct: return size_of_struct(type, operands, depth);
    case kOpTypePointer:
      if (depth > 0) return std::uint64_t{8};  // a buffer address
      [[fallthrough]];
    default: return unsupported("a type that has no size");
  }
}

Result<std::uint64_t> Reader::size_of_matrix(const SpirvType& matrix, std::uint64_t member_key,
                                             int depth) {
  const std::optional<std::uint32_t> stride = module_.member_decoration(member_key, kMatrixStride);
  if (!stride) return corrupt_module("a matrix without a stride");
  const auto column = module_.types.find(matrix.operands[0]);
  if (column == module_.types.end() || column->second.op != kOpTypeVector)
    return corrupt_module("a matrix that is not made of vectors");
  const Result<std::uint64_t> scalar =
      size_of(column->second.operands[0], std::nullopt, 0, depth + 1);
  if (!scalar.ok()) return scalar;
  const std::uint64_t column_count = matrix.operands[1], row_count = column->second.operands[1];
  if (column_count < 2 || column_count > 4 || row_count < 2 || row_count > 4)
    return corrupt_module("a matrix that is not 2x2 to 4x4");
  const bool row_major = module_.member_decoration(member_key, kRowMajor).has_value();
  const std::uint64_t bytes = row_major ? (row_count - 1) * *stride + column_count * *scalar
                                        : (column_count - 1) * *stride + row_count * *scalar;
  if (bytes > kMaxTypeBytes) return unsupported("a type larger than 1 MiB");
  return bytes;
}

Result<std::uint64_t> Reader::size_of_array(std::uint32_t type, const SpirvType& array,
                                            std::optional<std::uint32_t> member,
                                            std::uint32_t parent, int depth) {
  const std::optional<std::uint32_t> length = module_.constant(array.operands[1]),
                                     stride = module_.decoration(type, kArrayStride);
  if (!length || module_.specialised.contains(array.operands[1]))
    return unsupported("an array whose length is not a plain constant");
  if (!stride || *length == 0) return corrupt_module("an array without stride or elements");
  const Result<std::uint64_t> element = size_of(array.operands[0], member, parent, depth + 1);
  if (!element.ok()) return element;
  const std::uint64_t bytes = (std::uint64_t{*length} - 1) * *stride + *element;
  if (bytes > kMaxTypeBytes) return unsupported("a type larger than 1 MiB");
  return bytes;
}

Result<std::uint64_t> Reader::size_of_struct(std::uint32_t type,
                                             const std::vector<std::uint32_t>& members, int depth) {
  std::uint64_t bytes = 0;
  for (std::uint32_t i = 0; i < members.size(); ++i) {
    const std::optional<std::uint32_t> offset = module_.member_decoration(key_of(type, i), kOffset);
    if (!offset) return corrupt_module("a struct member without an offset");
    const Result<std::uint64_t> member = size_of(members[i], i, type, depth + 1);
    if (!member.ok()) return member;
    bytes = std::max(bytes, *offset + *member);
  }
  if (bytes > kMaxTypeBytes) return unsupported("a type larger than 1 MiB");
  return bytes;
}

}  // namespace

Result<ShaderInterface> read_interface(std::span<const std::uint32_t> words) {
  Result<SpirvModule> module = scan_module(words);
  if (!module.ok()) return module.error();
  return Reader(*std::move(module)).read();
}

}  // namespace hermite::gpu
