#include "core/map/surfel.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace hermite::map {

namespace {

float half_to_float(std::uint32_t half) {
  return static_cast<float>(Eigen::numext::bit_cast<Eigen::half>(static_cast<std::uint16_t>(half)));
}
std::uint32_t float_to_half(float value) {
  return Eigen::numext::bit_cast<std::uint16_t>(Eigen::half(value));
}

// The same octahedral encoding as in shaders/lib/geometry.glsl.
Eigen::Vector3f unpack_unit(std::uint32_t packed) {
  const auto snorm = [](std::uint32_t bits) {
    return std::clamp(static_cast<float>(static_cast<std::int16_t>(bits & 0xffffu)) / 32767.0f,
                      -1.0f, 1.0f);
  };
  const float x = snorm(packed), y = snorm(packed >> 16);
  Eigen::Vector3f n(x, y, 1.0f - std::abs(x) - std::abs(y));
  if (n.z() < 0) {
    n.x() = (1.0f - std::abs(y)) * (x >= 0 ? 1.0f : -1.0f);
    n.y() = (1.0f - std::abs(x)) * (y >= 0 ? 1.0f : -1.0f);
  }
  return n.normalized();
}

std::uint32_t pack_unit(const Eigen::Vector3f& n) {
  const auto snorm = [](float value) {
    return static_cast<std::uint32_t>(std::lround(std::clamp(value, -1.0f, 1.0f) * 32767.0f)) &
           0xffffu;
  };
  const auto sign = [](float value) { return value >= 0 ? 1.0f : -1.0f; };
  Eigen::Vector2f p = n.head<2>() / n.lpNorm<1>();
  if (n.z() < 0)
    p = Eigen::Vector2f((1 - std::abs(p.y())) * sign(p.x()), (1 - std::abs(p.x())) * sign(p.y()));
  return snorm(p.x()) | (snorm(p.y()) << 16);
}

// The same encoding as in shaders/lib/surfel.glsl.
std::uint32_t pack_color(float r, float g, float b) {
  const auto steps = [](float value, float per_one) {
    return static_cast<std::uint32_t>(std::lround(std::clamp(value, 0.0f, 255.0f) * per_one));
  };
  return steps(r, 8) | (steps(g, 8) << 11) | (steps(b, 4) << 22);
}

// Maps floats to integers of the same order, as in shaders/lib/blocks.glsl.
std::uint32_t ordered(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  return (bits & 0x80000000u) != 0 ? ~bits : bits | 0x80000000u;
}

}  // namespace

shared::SurfelAttributes pack_attributes(const Surfel& s) {
  return {pack_unit(s.normal_in_submap), float_to_half(s.radius_m) | (s.submap << 16),
          pack_color(s.r, s.g, s.b),
          float_to_half(s.curvature_max_per_m) | (float_to_half(s.curvature_min_per_m) << 16)};
}

Surfel unpack(const shared::vec4& p, const shared::SurfelAttributes& a, const shared::uvec2& t) {
  Surfel s;
  s.position_in_submap_m = {p.x, p.y, p.z};
  s.normal_in_submap = unpack_unit(a.normal);
  s.radius_m = half_to_float(a.radius_submap & 0xffffu);
  s.confidence = p.w;
  s.curvature_max_per_m = half_to_float(a.curvatures & 0xffffu);
  s.curvature_min_per_m = half_to_float(a.curvatures >> 16);
  s.r = static_cast<float>(a.color & 2047u) / 8;
  s.g = static_cast<float>((a.color >> 11) & 2047u) / 8;
  s.b = static_cast<float>(a.color >> 22) / 4;
  s.submap = a.radius_submap >> 16;
  s.created_frame = t.x;
  s.observed_frame = t.y;
  return s;
}

std::vector<shared::BlockBounds> bounds_of(std::span<const Surfel> surfels) {
  std::vector<shared::BlockBounds> bounds((surfels.size() + kSlotsPerBlock - 1) / kSlotsPerBlock);
  for (std::size_t slot = 0; slot < surfels.size(); ++slot) {
    const Surfel& s = surfels[slot];
    if (s.confidence <= 0) continue;
    const Eigen::Vector3f& p = s.position_in_submap_m;
    const auto submap = static_cast<float>(s.submap);
    const float reach[8] = {p.x(), p.y(), p.z(), -p.x(), -p.y(), -p.z(), submap, -submap};
    for (int i = 0; i < 8; ++i) {
      std::uint32_t& farthest = bounds[slot / kSlotsPerBlock].reach[i];
      farthest = std::max(farthest, ordered(reach[i]));
    }
  }
  return bounds;
}

}  // namespace hermite::map
