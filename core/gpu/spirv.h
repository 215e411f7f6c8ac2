// Reads from a compute shader's SPIR-V what a pipeline needs, so that bindings are declared only in
// the shader.
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
  std::vector<Binding> bindings;  // buffers of set 0, by binding number
  // By binding number: the name of a texel buffer, or of the last member of a storage buffer's
  // block; if two variables share a binding, the name of the first. Empty if the module has no
  // names.
  std::vector<std::string> binding_names;
  bool needs_64_bit_atomics = false;
  // Up to the end of the block's last member; 0 without a block.
  std::uint32_t push_constant_bytes = 0;
  std::array<std::uint32_t, 3> local_size = {1, 1, 1};
  // The constant_id that overrides it by specialisation.
  std::array<std::optional<std::uint32_t>, 3> local_size_constant;
};

// Returns the interface; kCorruptData for words that are no SPIR-V module; kUnsupported, with a
// reason, for anything but one compute entry point with storage and texel buffers in set 0,
// numbered without gaps, and push constants of scalars, vectors, matrices, arrays and structs.
// Pure; safe for any words.
Result<ShaderInterface> read_interface(std::span<const std::uint32_t> words);

}  // namespace hermite::gpu
