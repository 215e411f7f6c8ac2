// Reads from a compute shader's SPIR-V what a pipeline must know, so that the shader is the only declaration of its bindings.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/result.h"

namespace hermite::gpu {

enum class Binding { kStorage, kTexels };

struct ShaderInterface {
  std::vector<Binding> bindings;  // buffers at set 0, by number
  // By the same number: the name of a texel buffer, or of the last member of a storage buffer's block; of two views, the first one's. Empty
  // where the module has no names.
  std::vector<std::string> binding_names;
  bool needs_64_bit_atomics = false;
  std::uint32_t push_constant_bytes = 0;  // up to the end of the block's last member; 0 without a block
  std::array<std::uint32_t, 3> local_size = {1, 1, 1};
  std::array<std::optional<std::uint32_t>, 3> local_size_constant;  // the constant_id that replaces it when specialised
};

// kCorruptData for words that are no SPIR-V module; kUnsupported, in words, for anything but one compute entry point with storage and texel
// buffers at set 0, numbered without a gap, and push constants of scalars, vectors, matrices, arrays and structs. Pure; any words are safe.
Result<ShaderInterface> read_interface(std::span<const std::uint32_t> words);

}  // namespace hermite::gpu
