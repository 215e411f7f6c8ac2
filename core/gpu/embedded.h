// The SPIR-V of every shader, by path without ".comp" ("frame/bilateral"). Generated at build time; lives as long as the program.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <utility>

namespace hermite::gpu {

std::span<const std::pair<std::string_view, std::span<const std::uint32_t>>> embedded_kernels();

}  // namespace hermite::gpu
