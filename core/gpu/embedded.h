// The SPIR-V of every shader and its interface. Generated at build time (shaders/CMakeLists.txt);
// valid as long as the program runs. Thread-safe.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "core/gpu/shader_interface.h"

namespace hermite::gpu {

// How a shader binds buffers that it only reads.
enum class ReadAs { kTexels, kStorage };

struct EmbeddedKernel {
  std::string_view name;  // path without ".comp": "frame/bilateral"
  std::span<const std::uint32_t> words;
  // The names of the bindings are those of the version with texel buffers in both versions.
  ShaderInterface interface;
};

// Returns the same names in the same order for both.
std::span<const EmbeddedKernel> embedded_kernels(ReadAs read_as = ReadAs::kTexels);

}  // namespace hermite::gpu
