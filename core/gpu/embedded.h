// The SPIR-V of every shader, by path without ".comp" ("frame/bilateral"). Generated at build time; lives as long as the program.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <utility>

namespace hermite::gpu {

// How a shader binds the buffers that it only reads.
enum class ReadAs { kTexels, kStorage };

// The same names in the same order for both.
std::span<const std::pair<std::string_view, std::span<const std::uint32_t>>> embedded_kernels(ReadAs read_as = ReadAs::kTexels);

}  // namespace hermite::gpu
