#include "tests/support/packing.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace hermite::test {

namespace {

constexpr std::uint32_t kNoNormal = 0x80008000u;

std::uint32_t snorm16(double value) {
  return static_cast<std::uint16_t>(
      static_cast<std::int16_t>(std::lround(std::clamp(value, -1.0, 1.0) * 32767)));
}
double from_snorm16(std::uint32_t bits) {
  return std::max(-1.0, static_cast<std::int16_t>(bits & 0xffffu) / 32767.0);
}

}  // namespace

std::uint32_t float_to_half(double value) {
  const std::uint32_t sign = std::signbit(value) ? 0x8000u : 0u;
  const double magnitude = std::abs(value);
  if (magnitude >= 65520) return sign | 0x7c00u;
  // The exponent of the last bit; below 2^-14 halves are evenly spaced.
  const int exponent = std::max(magnitude > 0 ? std::ilogb(magnitude) : -14, -14);
  const double steps = std::nearbyint(std::ldexp(magnitude, 10 - exponent));
  return sign |
         (static_cast<std::uint32_t>(exponent + 14) * 1024u + static_cast<std::uint32_t>(steps));
}

double half_to_float(std::uint32_t half) {
  const int exponent = static_cast<int>((half >> 10) & 31u);
  const double mantissa = half & 1023u;
  const double magnitude =
      exponent == 0 ? std::ldexp(mantissa, -24) : std::ldexp(mantissa + 1024, exponent - 25);
  return (half & 0x8000u) != 0 ? -magnitude : magnitude;
}

std::uint32_t pack_halves(double first, double second) {
  return float_to_half(first) | (float_to_half(second) << 16);
}

Eigen::Vector2d unpack_halves(std::uint32_t packed) {
  return {half_to_float(packed & 0xffffu), half_to_float(packed >> 16)};
}

std::uint32_t pack_unit(const Eigen::Vector3d& unit) {
  Eigen::Vector2d p = unit.head<2>() / unit.lpNorm<1>();
  if (unit.z() < 0) {
    const auto folded = [](double other, double own) {
      return (1 - std::abs(other)) * (own >= 0 ? 1 : -1);
    };
    p = Eigen::Vector2d(folded(p.y(), p.x()), folded(p.x(), p.y()));
  }
  return snorm16(p.x()) | (snorm16(p.y()) << 16);
}

std::uint32_t pack_normal(const Eigen::Vector3d& normal) {
  return normal.isZero() ? kNoNormal : snorm16(normal.x()) | (snorm16(normal.y()) << 16);
}

Eigen::Vector3d unpack_normal(std::uint32_t packed) {
  if (packed == kNoNormal) return Eigen::Vector3d::Zero();
  const double x = from_snorm16(packed), y = from_snorm16(packed >> 16);
  return {x, y, std::sqrt(std::max(0.0, 1 - x * x - y * y))};
}

}  // namespace hermite::test
