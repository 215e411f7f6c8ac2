#include "core/texture/view_warp.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

#include "core/base/parallel.h"
#include "core/texture/view_brightness.h"
#include "core/texture/view_samples.h"

namespace hermite {

namespace {

using Eigen::Vector2f;

constexpr double kWarpSpacing_m = 0.015;
constexpr std::size_t kMaxWarpSamples = 100'000;
constexpr float kWarpEdge_px = 2;
constexpr int kWarpRounds[kBrightnessLevels] = {0, 6, 6};
// Two neighbours of the lattice that differ by a pixel weigh as many points of the usual difference do; a node that is a pixel off too.
constexpr double kSpringPoints = 20, kHoldPoints = 0.5;

class ViewWarper {
 public:
  ViewWarper(const TriangleMesh& mesh, const Camera& camera, const TextureOptions& options, std::vector<TextureView>& views,
             std::size_t guest_count)
      : camera_(camera),
        options_(options),
        thread_count_(options.thread_count),
        views_(views),
        first_guest_(views.size() - guest_count),
        first_moving_(guest_count > 0 ? first_guest_ : 0),
        samples_(samples_of(mesh, kWarpSpacing_m, kMaxWarpSamples)),
        levels_(brightness_levels(views, thread_count_)),
        sights_(sights_of(samples_, views, camera, kWarpEdge_px, thread_count_)) {}

  void warp() {
    for (std::size_t i = first_moving_; i < views_.size(); ++i) views_[i].warp = ViewWarp(camera_.width, camera_.height);
    for (std::size_t l = 0; l < levels_.size(); ++l)
      for (int round = 0; round < kWarpRounds[l] && !is_stopped(options_); ++round) {
        find_points(levels_[l]);
        in_parallel(views_.size() - first_moving_, thread_count_, [&](std::size_t i) { step(levels_[l], first_moving_ + i); });
      }
  }

 private:
  struct Place {
    Vector2f pixel = Vector2f::Zero();
    float depth_m = 0;
  };
  // Where the sample would be without a warp.
  Place place_of(const TextureView& view, std::uint32_t sample) const {
    const Eigen::Vector3f point = view.rotation * samples_[sample].position_m + view.translation_m;
    return {{static_cast<float>(camera_.fx) * point.x() / point.z() + static_cast<float>(camera_.cx),
             static_cast<float>(camera_.fy) * point.y() / point.z() + static_cast<float>(camera_.cy)},
            point.z()};
  }

  Look look(const BrightnessLevel& level, std::size_t i, std::uint32_t sample) const {
    const TextureView& view = views_[i];
    const Place place = place_of(view, sample);
    const Vector2f at = place.pixel + view.warp.at(place.pixel.x(), place.pixel.y());
    const std::optional<Brightness> brightness = level.at(i, at.x(), at.y());
    if (!brightness) return {};
    const Eigen::Vector3f way = view.place_m - samples_[sample].position_m;
    return {brightness->value, std::max(samples_[sample].normal.dot(way) / way.norm(), 0.05f) / (place.depth_m * place.depth_m)};
  }

  // Looks by view at once, sums one view after the other.
  void find_points(const BrightnessLevel& level) {
    looks_.resize(views_.size());
    in_parallel(views_.size(), thread_count_, [&](std::size_t i) {
      looks_[i].resize(sights_[i].size());
      for (std::size_t k = 0; k < sights_[i].size(); ++k) looks_[i][k] = look(level, i, sights_[i][k]);
    });
    points_.assign(samples_.size(), {});
    for (std::size_t i = 0; i < first_guest_; ++i)
      for (std::size_t k = 0; k < sights_[i].size(); ++k) {
        PointMean& mean = points_[sights_[i][k]];
        mean.weight += static_cast<double>(looks_[i][k].weight);
        mean.sum += static_cast<double>(looks_[i][k].weight) * static_cast<double>(looks_[i][k].value);
      }
  }

  // Springs between the nodes and to 0, in px^2; their pull at the present offsets.
  static void add_springs(const ViewWarp& warp, Eigen::MatrixXd& matrix, Eigen::VectorXd& right) {
    const double unit = static_cast<double>(kUsualDifference * kUsualDifference);
    const auto tie = [&](std::size_t a, std::size_t b) {
      for (Eigen::Index c = 0; c < 2; ++c) {
        const Eigen::Index m = 2 * static_cast<Eigen::Index>(a) + c, n = 2 * static_cast<Eigen::Index>(b) + c;
        const double pull = kSpringPoints * unit * static_cast<double>(warp.nodes_px[a][c] - warp.nodes_px[b][c]);
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
    ViewWarp& warp = views_[i].warp;
    const auto count = static_cast<Eigen::Index>(2 * warp.nodes_px.size());
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(count, count);  // its lower half
    Eigen::VectorXd right = Eigen::VectorXd::Zero(count);
    for (std::size_t k = 0; k < sights_[i].size(); ++k) {
      const Look& own = looks_[i][k];
      const std::optional<float> others = own.weight > 0 ? points_[sights_[i][k]].without(i < first_guest_ ? own : Look()) : std::nullopt;
      if (!others) continue;
      const Vector2f pixel = place_of(views_[i], sights_[i][k]).pixel;
      const std::array<WarpNode, 4> around = warp.around(pixel.x(), pixel.y());
      const Vector2f at = pixel + warp.at(pixel.x(), pixel.y());
      const std::optional<Brightness> here = level.at(i, at.x(), at.y());
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

  const Camera& camera_;
  const TextureOptions& options_;
  const int thread_count_;
  std::vector<TextureView>& views_;
  const std::size_t first_guest_, first_moving_;
  const std::vector<MeshSample> samples_;
  const std::array<BrightnessLevel, kBrightnessLevels> levels_;
  const std::vector<std::vector<std::uint32_t>> sights_;
  std::vector<std::vector<Look>> looks_;
  std::vector<PointMean> points_;
};

}  // namespace

void warp_views(const TriangleMesh& mesh, const TextureFrames& frames, const TextureOptions& options, std::vector<TextureView>& views,
                std::size_t guest_count) {
  ViewWarper(mesh, frames.camera, options, views, guest_count).warp();
}

}  // namespace hermite
