#include "core/texture/view_exposure.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/parallel.h"
#include "core/texture/view_samples.h"

namespace hermite::texture {

namespace {

constexpr double kLightSpacing_m = 0.03;
constexpr std::size_t kMaxLightSamples = 40'000;
constexpr float kLightEdge_px = 4;
// Values outside this range are saturated or lost in noise.
constexpr float kDarkest = 12, kBrightest = 245;
constexpr int kLightRounds = 6;
// Differences of logarithms up to this have at least half weight: a tenth of the brightness.
constexpr double kLightDifference = 0.1;
// The weight of the prior that a gain is 1, relative to the points of an average view. The points
// of one pair of views share their errors (reflections, vignetting), which would accumulate along a
// chain of views without a prior.
constexpr double kPriorShare = 0.03;
constexpr double kLargestLog = 1.3862943611198906;  // of 4

// The light of one sample in one view, by channel.
struct Light {
  std::uint32_t sample = 0;
  std::array<float, 3> log_linear{};
};

// The mean over 3 x 3 pixels, which tolerates a view that is off by a pixel.
std::optional<Light> light_of(const TextureView& view, const Seen& seen, std::uint32_t sample) {
  const int x = static_cast<int>(std::lround(seen.u)), y = static_cast<int>(std::lround(seen.v));
  if (x < 1 || y < 1 || x + 1 >= view.color.width || y + 1 >= view.color.height)
    return std::nullopt;
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx) {
      const Rgb8& pixel = view.color.at(x + dx, y + dy);
      const Eigen::Vector3f value(pixel.r, pixel.g, pixel.b);
      if (value.minCoeff() < kDarkest || value.maxCoeff() > kBrightest) return std::nullopt;
      sum += value;
    }
  Light light{sample, {}};
  for (std::size_t c = 0; c < 3; ++c)
    light.log_linear[c] = std::log(linear_from_srgb_byte(sum[static_cast<Eigen::Index>(c)] / 9));
  return light;
}

struct Mean {
  double weight = 0, sum = 0;
};

// Solves for the log gains of one channel. Points are eliminated: each is the weighted mean over
// its views.
class ChannelSolver {
 public:
  ChannelSolver(const std::vector<std::vector<Light>>& lights, std::size_t sample_count,
                std::size_t channel, const TextureOptions& options)
      : lights_(lights),
        options_(options),
        channel_(channel),
        points_(sample_count),
        gains_(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(lights.size()))) {}

  Eigen::VectorXd solved() {
    for (int round = 0; round < kLightRounds && !is_stopped(options_); ++round) {
      find_points(round == 0);
      step(round == 0);
    }
    return gains_;
  }

 private:
  double value(std::size_t view, const Light& light) const {
    return static_cast<double>(light.log_linear[channel_]) -
           gains_[static_cast<Eigen::Index>(view)];
  }
  double weight(std::size_t view, const Light& light, bool is_first) const {
    if (is_first) return 1;
    const double off = (value(view, light) - points_[light.sample].sum) / kLightDifference;
    return 1 / (1 + off * off);
  }
  // Computes the mean of each sample over its views; afterwards `sum` holds the mean.
  void find_points(bool is_first) {
    std::vector<Mean> means(points_.size());
    for (std::size_t view = 0; view < lights_.size(); ++view)
      for (const Light& light : lights_[view]) {
        const double w = weight(view, light, is_first);
        means[light.sample].weight += w;
        means[light.sample].sum += w * value(view, light);
      }
    for (Mean& mean : means)
      if (mean.weight > 0) mean.sum /= mean.weight;
    points_ = std::move(means);
  }
  // Minimises the sum over points of w_i w_j / W (g_i - g_j)^2: a dense matrix with one row per
  // view.
  void step(bool is_first) {
    const auto count = static_cast<Eigen::Index>(lights_.size());
    // View, weight, value without its gain.
    std::vector<std::vector<std::array<double, 3>>> of_point(points_.size());
    for (std::size_t view = 0; view < lights_.size(); ++view)
      for (const Light& light : lights_[view])
        of_point[light.sample].push_back({static_cast<double>(view), weight(view, light, is_first),
                                          static_cast<double>(light.log_linear[channel_])});
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(count, count);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(count);
    for (const auto& looks : of_point) {
      if (looks.size() < 2) continue;
      double all = 0, sum = 0;
      for (const auto& [view, w, log_linear] : looks) {
        all += w;
        sum += w * log_linear;
      }
      for (const auto& [view, w, log_linear] : looks) {
        const auto row = static_cast<Eigen::Index>(view);
        matrix(row, row) += w;
        right[row] += w * (log_linear - sum / all);
        for (const auto& [other, other_w, ignored] : looks)
          matrix(row, static_cast<Eigen::Index>(other)) -= w * other_w / all;
      }
    }
    matrix.diagonal().array() += kPriorShare * matrix.diagonal().mean() + 1e-9;
    gains_ = matrix.ldlt().solve(right);
    gains_.array() -= gains_.mean();
    gains_ = gains_.cwiseMax(-kLargestLog).cwiseMin(kLargestLog);
  }

  const std::vector<std::vector<Light>>& lights_;
  const TextureOptions& options_;
  const std::size_t channel_;
  std::vector<Mean> points_;
  Eigen::VectorXd gains_;  // logarithms
};

}  // namespace

void solve_exposure(const output::TriangleMesh& mesh, const Camera& camera,
                    const TextureOptions& options, std::vector<TextureView>& views) {
  const std::vector<MeshSample> samples = samples_of(mesh, kLightSpacing_m, kMaxLightSamples);
  std::vector<std::vector<Light>> lights(views.size());
  in_parallel(views.size(), options.thread_count, [&](std::size_t i) {
    if (is_stopped(options)) return;
    for (std::uint32_t k = 0; k < samples.size(); ++k)
      if (const std::optional<Seen> seen =
              seen_at(views[i], camera, samples[k].position_m, samples[k].normal, kLightEdge_px))
        if (const std::optional<Light> light = light_of(views[i], *seen, k))
          lights[i].push_back(*light);
  });
  std::array<Eigen::VectorXd, 3> logs;
  in_parallel(3, options.thread_count, [&](std::size_t channel) {
    logs[channel] = ChannelSolver(lights, samples.size(), channel, options).solved();
  });
  if (is_stopped(options)) return;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    set_gain(views[i],
             Eigen::Vector3d(std::exp(logs[0][row]), std::exp(logs[1][row]), std::exp(logs[2][row]))
                 .cast<float>());
  }
}

}  // namespace hermite::texture
