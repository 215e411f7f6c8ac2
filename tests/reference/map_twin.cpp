#include "tests/reference/map_twin.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <tuple>

#include "core/map/index_map.h"
#include "tests/reference/frame_twin.h"

namespace hermite::test {

namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kNearest_m = 0.05, kFarthest_m = 20;

Vector2d project(const shared::Intrinsics& c, const Vector3d& p) {
  return {c.fx * p.x() / p.z() + c.cx, c.fy * p.y() / p.z() + c.cy};
}

bool inside(const shared::Intrinsics& c, int x, int y) {
  return x >= 0 && y >= 0 && x < static_cast<int>(c.width) && y < static_cast<int>(c.height);
}

std::size_t index(const shared::Intrinsics& c, int x, int y) {
  return static_cast<std::size_t>(y) * c.width + static_cast<std::size_t>(x);
}

struct Hit {
  double t = 0;
  Vector3d normal;
  std::size_t source = 0;  // the kernel that gives the attributes
};

// The nearest disc of 0.4 support radii that the ray meets from the front.
std::optional<Hit> meet_disc(const std::vector<HrbfKernel>& kernels, const Vector3d& ray) {
  std::optional<Hit> nearest;
  for (std::size_t i = 0; i < kernels.size(); ++i) {
    const HrbfKernel& k = kernels[i];
    const double slope = k.normal.dot(ray);
    if (slope <= 0.1) continue;
    const double t = k.normal.dot(k.position_m) / slope;
    if ((t * ray - k.position_m).norm() < 0.4 * k.radius_m && (!nearest || t < nearest->t))
      nearest = Hit{t, k.normal, i};
  }
  return nearest;
}

// Normal and attributes are those of the zero set; the correction moves the point only.
std::optional<Hit> meet_surface(const std::vector<HrbfKernel>& kernels, const Vector3d& ray,
                                const map::MapOptions& options) {
  HrbfRayOptions by_ray{.min_support_count = options.min_support};
  const auto hit = intersect_hrbf(kernels, ray, by_ray);
  by_ray.correct_bias = options.correct_bias;
  const auto corrected = intersect_hrbf(kernels, ray, by_ray);
  if (!hit || !corrected) return std::nullopt;
  const auto nearer = [&](const HrbfKernel& a, const HrbfKernel& b) {
    return (a.position_m - hit->point_m).norm() < (b.position_m - hit->point_m).norm();
  };
  const auto nearest = std::min_element(kernels.begin(), kernels.end(), nearer);
  return Hit{corrected->ray_parameter, hit->normal,
             static_cast<std::size_t>(nearest - kernels.begin())};
}

double grey(const map::Surfel& s) { return 0.299 * s.r + 0.587 * s.g + 0.114 * s.b; }

// One measurement: the pixel and what it continues.
struct Claim {
  int x = 0, y = 0;
  double distance_px = 0;
};

struct Association {
  std::map<std::uint32_t, std::vector<Claim>> claims;  // by slot, in order of pixels
  std::vector<Claim> fresh;
};

class Fusion {
 public:
  Fusion(const std::vector<map::Surfel>& surfels, const MapView& view, const FuseInput& frame,
         const FuseSettings& settings)
      : view_(view), frame_(frame), settings_(settings) {
    outcome_.surfels = surfels;
  }

  FuseOutcome run(const std::vector<std::vector<std::uint32_t>>& free_slots,
                  const std::vector<std::uint32_t>& ids) {
    Association association = associate(ids);
    for (const auto& [slot, claims] : association.claims)
      merge(outcome_.surfels[slot], winner(claims));
    const auto order = [this](const Claim& c) {
      return std::tuple(zone_of_tile_at(view_.camera, c.x, c.y), c.y / 16, c.x / 16, c.y, c.x);
    };
    std::sort(association.fresh.begin(), association.fresh.end(),
              [&](const Claim& a, const Claim& b) { return order(a) < order(b); });
    std::vector<std::size_t> used(free_slots.size());
    for (const Claim& pixel : association.fresh) {
      const map::Surfel surfel = measure(pixel.x, pixel.y);
      const std::size_t zone = zone_of_tile_at(view_.camera, pixel.x, pixel.y);
      if (used[zone] < free_slots[zone].size())
        outcome_.surfels[free_slots[zone][used[zone]++]] = surfel;
      else
        outcome_.surfels.push_back(surfel);
      ++outcome_.new_count;
    }
    return std::move(outcome_);
  }

 private:
  void decided_by(double margin) {
    outcome_.closest_decision = std::min(outcome_.closest_decision, std::abs(margin));
  }

  double fused_depth_m(std::size_t i) const {
    return settings_.map.fuse_surface ? frame_.surface.depth_m[i] : frame_.raw_depth_m[i];
  }

  Association associate(const std::vector<std::uint32_t>& ids) {
    Association association;
    for (int y = 0; y < static_cast<int>(view_.camera.height); ++y)
      for (int x = 0; x < static_cast<int>(view_.camera.width); ++x) {
        const std::size_t i = index(view_.camera, x, y);
        if (frame_.surface.depth_m[i] <= 0 || frame_.raw_depth_m[i] <= 0 ||
            frame_.surface.weight[i] <= 0)
          continue;
        double distance_px = 0;
        const std::optional<std::uint32_t> slot = continued(ids, x, y, distance_px);
        if (slot)
          association.claims[*slot].push_back({x, y, distance_px});
        else
          association.fresh.push_back({x, y, 0});
      }
    return association;
  }

  // The surfel of a 3x3 window nearest to the pixel's ray that passes the gates.
  std::optional<std::uint32_t> continued(const std::vector<std::uint32_t>& ids, int x, int y,
                                         double& best) {
    const Vector3d ray = frame_.surface.ray(x, y);
    const std::size_t own = index(view_.camera, x, y);
    std::optional<std::uint32_t> found;
    best = 1e9;
    for (int v = y - 1; v <= y + 1; ++v)
      for (int u = x - 1; u <= x + 1; ++u) {
        const std::uint32_t slot =
            inside(view_.camera, u, v) ? ids[index(view_.camera, u, v)] : map::kNoSurfel;
        if (slot == map::kNoSurfel) continue;
        const Vector3d p = view_.position_m(outcome_.surfels[slot]),
                       n = view_.normal(outcome_.surfels[slot]);
        const double gap =
            std::abs(p.z() - fused_depth_m(own)) * ray.norm() / settings_.map.fuse_depth_gate_m;
        decided_by(gap - 1);
        if (gap > 1) continue;
        const double cosine = n.dot(frame_.surface.normals[own]),
                     limit = std::cos(settings_.map.fuse_normal_gate_rad);
        decided_by(std::abs(n.z()) - 0.75);
        if (std::abs(n.z()) >= 0.75) decided_by(cosine - limit);
        if (std::abs(n.z()) >= 0.75 && cosine < limit) continue;
        const double distance_px =
            p.cross(ray).norm() / ray.norm() * view_.camera.fx / fused_depth_m(own);
        decided_by(distance_px - best);
        if (distance_px < best) {
          best = distance_px;
          found = slot;
        }
      }
    return found;
  }

  const Claim& winner(const std::vector<Claim>& claims) {
    const Claim* best = &claims.front();
    for (const Claim& claim : claims)
      if (claim.distance_px < best->distance_px) best = &claim;
    for (const Claim& claim : claims)
      // Distances count in steps of 1/256 px, of which the lower pixel wins: other claims must be
      // two steps away to be clear.
      if (&claim != best) decided_by(claim.distance_px - best->distance_px < 2.0 / 256 ? 0 : 1);
    outcome_.beaten_count += static_cast<int>(claims.size()) - 1;
    return *best;
  }

  // In the frame of submap 0.
  map::Surfel measure(int x, int y) const {
    const std::size_t i = index(view_.camera, x, y);
    const Rigid3 submap_from_camera = inverse(view_.camera_from_submap[0]);
    map::Surfel s;
    s.position_in_submap_m =
        (submap_from_camera * (fused_depth_m(i) * frame_.surface.ray(x, y))).cast<float>();
    s.normal_in_submap = (submap_from_camera.rotation * frame_.surface.normals[i]).cast<float>();
    s.radius_m = static_cast<float>(support_radius_m(view_.camera, settings_.support_radius_scale,
                                                     frame_.surface.depth_m[i],
                                                     frame_.surface.normals[i].z()));
    s.confidence = frame_.surface.weight[i];
    s.curvature_max_per_m = static_cast<float>(frame_.surface.curvatures[i].x());
    s.curvature_min_per_m = static_cast<float>(frame_.surface.curvatures[i].y());
    s.r = frame_.color[i].r;
    s.g = frame_.color[i].g;
    s.b = frame_.color[i].b;
    s.created_frame = s.observed_frame = settings_.frame_number;
    return s;
  }

  void merge(map::Surfel& s, const Claim& pixel) {
    const map::Surfel m = measure(pixel.x, pixel.y);
    const float total = s.confidence + m.confidence;
    const float coarser = settings_.map.weigh_by_radius ? m.radius_m / s.radius_m : 1.0f;
    const float new_share = m.confidence / (s.confidence * coarser * coarser + m.confidence),
                old_share = 1 - new_share;
    decided_by(m.radius_m / s.radius_m - 1.5);
    if (m.radius_m < 1.5f * s.radius_m) {
      const auto mean = [&](float a, float b) { return old_share * a + new_share * b; };
      s.normal_in_submap =
          (old_share * s.normal_in_submap + new_share * m.normal_in_submap).normalized();
      const Eigen::Vector3f& n = s.normal_in_submap;
      s.position_in_submap_m +=
          new_share * n.dot(m.position_in_submap_m - s.position_in_submap_m) * n;
      s.radius_m = mean(s.radius_m, m.radius_m);
      s.curvature_max_per_m = mean(s.curvature_max_per_m, m.curvature_max_per_m);
      s.curvature_min_per_m = mean(s.curvature_min_per_m, m.curvature_min_per_m);
      s.r = mean(s.r, m.r);
      s.g = mean(s.g, m.g);
      s.b = mean(s.b, m.b);
    }
    s.confidence =
        std::min(total, std::max(s.confidence, static_cast<float>(settings_.map.max_confidence)));
    s.observed_frame = settings_.frame_number;
    ++outcome_.merged_count;
  }

  const MapView& view_;
  const FuseInput& frame_;
  const FuseSettings& settings_;
  FuseOutcome outcome_;
};

}  // namespace

std::vector<std::uint32_t> index_map_twin(const std::vector<map::Surfel>& surfels,
                                          const MapView& view, double min_confidence) {
  const std::size_t pixels = static_cast<std::size_t>(view.camera.width) * view.camera.height;
  std::vector<std::uint32_t> ids(pixels, map::kNoSurfel);
  std::vector<double> nearest(pixels, 1e9);
  for (std::uint32_t slot = 0; slot < surfels.size(); ++slot) {
    const map::Surfel& surfel = surfels[slot];
    const Vector3d p = view.position_m(surfel);
    if (surfel.confidence <= 0 || surfel.confidence < min_confidence || p.z() <= kNearest_m ||
        p.z() > kFarthest_m)
      continue;
    const Vector2d uv = project(view.camera, p);
    const int x = static_cast<int>(std::lround(uv.x())), y = static_cast<int>(std::lround(uv.y()));
    if (!inside(view.camera, x, y)) continue;
    const std::size_t i = index(view.camera, x, y);
    if (p.z() < nearest[i]) {  // and not <=: the lowest slot stays
      nearest[i] = p.z();
      ids[i] = slot;
    }
  }
  return ids;
}

std::vector<HrbfKernel> prediction_window(const std::vector<map::Surfel>& surfels,
                                          const MapView& view,
                                          const std::vector<std::uint32_t>& ids, int x, int y,
                                          int window, std::vector<std::uint32_t>& slots) {
  std::vector<HrbfKernel> kernels;
  slots.clear();
  for (int v = y - window / 2; v <= y + window / 2; ++v)
    for (int u = x - window / 2; u <= x + window / 2; ++u) {
      const std::uint32_t slot =
          inside(view.camera, u, v) ? ids[index(view.camera, u, v)] : map::kNoSurfel;
      if (slot == map::kNoSurfel) continue;
      const Vector3d normal = view.normal(surfels[slot]);
      if (normal.z() < 0 || surfels[slot].confidence <= 0) continue;
      kernels.push_back({view.position_m(surfels[slot]), normal, surfels[slot].radius_m});
      slots.push_back(slot);
    }
  return kernels;
}

double tracking_weight_twin(const Eigen::Vector2d& curvatures, double confidence, double depth_m,
                            const map::MapOptions& options) {
  const double largest = std::max(curvatures.cwiseAbs().maxCoeff(), 1e-3),
               ratio = options.curvature_lambda_per_m / largest;
  const double feature = options.curvature_weight ? std::exp(-0.5 * ratio * ratio) : 0;
  return (confidence * options.confidence_scale + feature) / (depth_m * depth_m);
}

SurfaceImage predict_twin(const std::vector<map::Surfel>& surfels, const MapView& view,
                          const std::vector<std::uint32_t>& ids, const map::MapOptions& options) {
  SurfaceImage out(view.camera);
  std::vector<std::uint32_t> slots;
  for (int y = 0; y < static_cast<int>(view.camera.height); ++y)
    for (int x = 0; x < static_cast<int>(view.camera.width); ++x) {
      const std::vector<HrbfKernel> kernels =
          prediction_window(surfels, view, ids, x, y, options.window, slots);
      const Vector3d ray = out.ray(x, y);
      const auto hit =
          options.hrbf_prediction ? meet_surface(kernels, ray, options) : meet_disc(kernels, ray);
      if (!hit) continue;
      const map::Surfel& source = surfels[slots[hit->source]];
      const std::size_t i = out.index(x, y);
      out.depth_m[i] = static_cast<float>(hit->t);
      out.normals[i] = hit->normal;
      out.curvatures[i] = {source.curvature_max_per_m, source.curvature_min_per_m};
      out.weight[i] = static_cast<float>(
          tracking_weight_twin(out.curvatures[i], source.confidence, hit->t, options));
      out.intensity[i] = static_cast<float>(grey(source));
    }
  return out;
}

std::size_t zone_of_tile_at(const shared::Intrinsics& camera, int x, int y) {
  const auto part = [](int at, std::uint32_t size) {
    return std::min(static_cast<std::size_t>(4.0 * (16.0 * (at / 16) + 8.0) / size),
                    std::size_t{3});
  };
  return 4 * part(y, camera.height) + part(x, camera.width);
}

FuseOutcome fuse_twin(const std::vector<map::Surfel>& surfels,
                      const std::vector<std::vector<std::uint32_t>>& free_slots,
                      const MapView& view, const std::vector<std::uint32_t>& ids,
                      const FuseInput& frame, const FuseSettings& settings) {
  return Fusion(surfels, view, frame, settings).run(free_slots, ids);
}

}  // namespace hermite::test
