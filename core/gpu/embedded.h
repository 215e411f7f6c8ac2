// The SPIR-V of every shader, by path without ".comp" ("frame/bilateral"). Generated at build time;
// valid as long as the program runs.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <utility>

namespace hermite::gpu {

// How a shader binds buffers that it only reads.
enum class ReadAs { kTexels, kStorage };

// Returns the same names in the same order for both.
std::span<const std::pair<std::string_view, std::span<const std::uint32_t>>> embedded_kernels(
    ReadAs read_as = ReadAs::kTexels);

}  // namespace hermite::gpu
