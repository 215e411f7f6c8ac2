// What a pipeline needs to know about a compute shader. It is read from the SPIR-V while Hermite is
// built (shaders/embed_shader.cpp), so that bindings are declared only in the shader. Plain values.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace hermite::gpu {

enum class Binding { kStorage, kTexels };

struct ShaderInterface {
  std::vector<Binding> bindings;  // buffers of set 0, by binding number
  // By binding number: the name of a texel buffer, or of the last member of a storage buffer's
  // block; if two variables share a binding, the name of the first.
  std::vector<std::string> binding_names;
  bool needs_64_bit_atomics = false;
  // Up to the end of the block's last member; 0 without a block.
  std::uint32_t push_constant_bytes = 0;
  std::array<std::uint32_t, 3> local_size = {1, 1, 1};
  // The constant_id that overrides it by specialisation.
  std::array<std::optional<std::uint32_t>, 3> local_size_constant;
};

}  // namespace hermite::gpu
