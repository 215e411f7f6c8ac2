#include "core/texture/view_warp.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

#include "core/texture/sampled_views.h"

namespace hermite::texture {

namespace {

using Eigen::Vector2f;

constexpr SampleDensity kWarpDensity{0.015, 100'000, 2};
constexpr int kWarpRounds[kBrightnessLevels] = {0, 6, 6};
// Regularisation: the weights, in points with the usual difference, of a difference of one pixel
// between adjacent nodes and of an offset of one pixel.
constexpr double kSpringPoints = 20, kHoldPoints = 0.5;

class ViewWarper {
 public:
  explicit ViewWarper(SampledViews& seen) : seen_(seen) {}

  void warp() {
    for (std::size_t i = seen_.first_moving; i < seen_.views.size(); ++i)
      seen_.views[i].warp = ViewWarp(seen_.camera.width, seen_.camera.height);
    for (std::size_t l = 0; l < seen_.levels.size(); ++l)
      for (int round = 0; round < kWarpRounds[l] && !is_stopped(seen_.options); ++round) {
        seen_.find_points(
            [&](std::size_t i, std::uint32_t sample) { return look(seen_.levels[l], i, sample); });
        seen_.for_each_moving([&](std::size_t i) { step(seen_.levels[l], i); });
      }
  }

 private:
  struct Place {
    Vector2f pixel = Vector2f::Zero();
    float depth_m = 0;
  };
  // Returns the projection of the sample without a warp.
  Place place_of(const TextureView& view, std::uint32_t sample) const {
    const Eigen::Vector3f point =
        view.rotation * seen_.samples[sample].position_m + view.translation_m;
    return {{static_cast<float>(seen_.camera.fx) * point.x() / point.z() +
                 static_cast<float>(seen_.camera.cx),
             static_cast<float>(seen_.camera.fy) * point.y() / point.z() +
                 static_cast<float>(seen_.camera.cy)},
            point.z()};
  }

  Look look(const BrightnessLevel& level, std::size_t i, std::uint32_t sample) const {
    const TextureView& view = seen_.views[i];
    const Place place = place_of(view, sample);
    const Vector2f at = place.pixel + view.warp.at(place.pixel.x(), place.pixel.y());
    const std::optional<BrightnessSample> brightness = level.at(i, at.x(), at.y());
    if (!brightness) return {};
    const Eigen::Vector3f way = view.place_m - seen_.samples[sample].position_m;
    return {brightness->value, std::max(seen_.samples[sample].normal.dot(way) / way.norm(), 0.05f) /
                                   (place.depth_m * place.depth_m)};
  }

  // Adds the springs between nodes and to 0, in px^2, linearised at the present offsets.
  static void add_springs(const ViewWarp& warp, Eigen::MatrixXd& matrix, Eigen::VectorXd& right) {
    const double unit = static_cast<double>(kUsualDifference * kUsualDifference);
    const auto tie = [&](std::size_t a, std::size_t b) {
      for (Eigen::Index c = 0; c < 2; ++c) {
        const Eigen::Index m = 2 * static_cast<Eigen::Index>(a) + c,
                           n = 2 * static_cast<Eigen::Index>(b) + c;
        const double pull =
            kSpringPoints * unit * static_cast<double>(warp.nodes_px[a][c] - warp.nodes_px[b][c]);
        matrix(m, m) += kSpringPoints * unit;
        matrix(n, n) += kSpringPoints * unit;
        matrix(std::max(m, n), std::min(m, n)) -= kSpringPoints * unit;
        right[m] -= pull;
        right[n] += pull;
      }
    };
    for (int y = 0; y < warp.rows; ++y)
      for (int x = 0; x < warp.columns; ++x) {
        const std::size_t node = warp.node(x, y);
        if (x + 1 < warp.columns) tie(node, warp.node(x + 1, y));
        if (y + 1 < warp.rows) tie(node, warp.node(x, y + 1));
        for (Eigen::Index c = 0; c < 2; ++c) {
          const Eigen::Index m = 2 * static_cast<Eigen::Index>(node) + c;
          matrix(m, m) += kHoldPoints * unit;
          right[m] -= kHoldPoints * unit * static_cast<double>(warp.nodes_px[node][c]);
        }
      }
  }

  void step(const BrightnessLevel& level, std::size_t i) {
    ViewWarp& warp = seen_.views[i].warp;
    const auto count = static_cast<Eigen::Index>(2 * warp.nodes_px.size());
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(count, count);  // only its lower half is set
    Eigen::VectorXd right = Eigen::VectorXd::Zero(count);
    for (std::size_t k = 0; k < seen_.sights[i].size(); ++k) {
      const std::optional<float> others = seen_.others_say(i, k);
      if (!others) continue;
      const Vector2f pixel = place_of(seen_.views[i], seen_.sights[i][k]).pixel;
      const std::array<WarpNode, 4> around = warp.around(pixel.x(), pixel.y());
      const Vector2f at = pixel + warp.at(pixel.x(), pixel.y());
      const std::optional<BrightnessSample> here = level.at(i, at.x(), at.y());
      if (!here) continue;
      const float difference = here->value - *others;
      const double weight = static_cast<double>(robust_weight(difference));
      std::array<std::pair<Eigen::Index, double>, 8> row;
      for (std::size_t n = 0; n < 4; ++n) {
        const auto first = 2 * static_cast<Eigen::Index>(around[n].index);
        row[2 * n] = {first, static_cast<double>(around[n].weight * here->du)};
        row[2 * n + 1] = {first + 1, static_cast<double>(around[n].weight * here->dv)};
      }
      for (const auto& [a, slope] : row) {
        right[a] -= weight * static_cast<double>(difference) * slope;
        for (const auto& [b, other] : row)
          if (b <= a) matrix(a, b) += weight * slope * other;
      }
    }
    add_springs(warp, matrix, right);
    const Eigen::VectorXd change = matrix.selfadjointView<Eigen::Lower>().ldlt().solve(right);
    if (!change.allFinite()) return;
    for (std::size_t n = 0; n < warp.nodes_px.size(); ++n) {
      Vector2f& node = warp.nodes_px[n];
      node += change.segment<2>(2 * static_cast<Eigen::Index>(n)).cast<float>();
      node *= std::min(1.0f, kFarthestWarp_px / std::max(node.norm(), 1e-6f));
    }
  }

  SampledViews& seen_;
};

}  // namespace

void warp_views(const output::TriangleMesh& mesh, const TextureFrames& frames,
                const TextureOptions& options, std::vector<TextureView>& views,
                std::size_t guest_count) {
  SampledViews seen(mesh, frames.camera, options, {views, guest_count}, kWarpDensity);
  ViewWarper(seen).warp();
}

}  // namespace hermite::texture
