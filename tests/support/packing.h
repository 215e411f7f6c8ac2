// The packed words of shaders/lib/geometry.glsl and surfel.glsl on the host, for tests. Pure
// functions.
#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace hermite::test {

// What packing loses, relative to the value: a half float has 11 bits and a driver may round
// towards zero.
inline constexpr double kHalfLoss = 1.0 / 1024;
// Loss per component of a unit vector in 2 x snorm16, where its z is not near zero (z follows from
// x and y): a few steps of 1 / 32767.
inline constexpr double kNormalLoss = 1e-4;

std::uint32_t float_to_half(double value);  // to nearest, ties to even; infinite beyond 65504
double half_to_float(std::uint32_t half);
std::uint32_t pack_halves(double first, double second);
Eigen::Vector2d unpack_halves(std::uint32_t packed);

// Octahedral, any unit vector.
std::uint32_t pack_unit(const Eigen::Vector3d& unit);

// Unit vectors with z >= 0. Zero stands for "no normal" on this side.
std::uint32_t pack_normal(const Eigen::Vector3d& normal);
Eigen::Vector3d unpack_normal(std::uint32_t packed);

}  // namespace hermite::test
