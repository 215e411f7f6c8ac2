#include "core/calibrate/calibrate.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/frame/rectify.h"

namespace hermite {
namespace {

double overlap_of(const CalibrationView& a, const std::vector<Facet>& facets_a, const std::vector<Facet>& facets_b, const Rigid3& b_from_a, const CalibrationView& b, const Camera& camera) {
  int all = 0, met = 0;
  for (int row = 4; row < a.patches.nodes.height; row += 8)
    for (int column = 4; column < a.patches.nodes.width; column += 8) {
      const Facet& facet = facets_a[a.patches.nodes.index(column, row)];
      if (facet.point_m.z() <= 0) continue;
      ++all;
      const Eigen::Vector3d point = b_from_a * facet.point_m.cast<double>();
      if (point.z() < 0.2) continue;
      const Eigen::Vector2d at = camera.project(point);
      const double x = (at.x() - b.patches.step_px / 2) / b.patches.step_px + 0.5, y = (at.y() - b.patches.step_px / 2) / b.patches.step_px + 0.5;
      if (!(x >= 0 && y >= 0 && x < b.patches.nodes.width && y < b.patches.nodes.height)) continue;
      const Facet& there = facets_b[b.patches.nodes.index(static_cast<int>(x), static_cast<int>(y))];
      if (there.point_m.z() <= 0) continue;
      if (std::abs(there.plane_per_m.cast<double>().dot(point) - 1) / static_cast<double>(there.plane_per_m.norm()) < 0.15) ++met;
    }
  return all < 50 ? 0 : static_cast<double>(met) / all;
}

}  // namespace

int prototype_calibrate(const Sequence& sequence, const Trajectory& trajectory, FrameRange range, std::size_t most) {
  const Camera camera = rectified(sequence.camera());
  Camera lenses = sequence.camera();
  lenses.depth_distortion = {};
  const std::optional<Rectifier> rectifier = rectifier_of(lenses);
  std::vector<CalibrationView> views;
  const auto count = static_cast<std::size_t>(range.count());
  most = std::min(most, count);
  for (std::size_t i = 0; i < most; ++i) {
    const std::int64_t index = range.begin + static_cast<std::int64_t>(i * count / most);
    const auto pose = pose_at(trajectory, sequence.timestamp_s(index), 0.02);
    if (!pose) continue;
    auto recorded = sequence.read(index);
    if (!recorded.ok()) continue;
    auto frame = decode_frame(*std::move(recorded));
    if (!frame.ok()) continue;
    if (rectifier) *frame = rectifier->apply(*frame);
    views.push_back({*pose, patches_of(frame->depth, camera), detect_features(*frame, camera)});
  }
  std::vector<std::vector<Facet>> facets;
  for (const CalibrationView& view : views) facets.push_back(facets_of(view.patches, camera));
  std::vector<ViewPair> fitted, held;
  for (std::uint32_t b = 1; b < views.size(); ++b) {
    std::vector<std::uint32_t> others;
    for (std::uint32_t a = 0; a < b; ++a) {
      const Rigid3 b_from_a = inverse(views[b].world_from_camera) * views[a].world_from_camera;
      if (overlap_of(views[a], facets[a], facets[b], b_from_a, views[b], camera) > 0.25) others.push_back(a);
    }
    const std::size_t cap = 12;
    for (std::size_t i = 0; i < std::min(cap, others.size()); ++i) {
      const std::uint32_t a = others.size() <= cap ? others[i] : others[i * (others.size() - 1) / (cap - 1)];
      ((a * 7 + b * 3) % 5 == 0 && b - a > 1 ? held : fitted).push_back({a, b});
    }
  }
  std::fprintf(stderr, "%zu views, %zu pairs fitted, %zu held back\n", views.size(), fitted.size(), held.size());
  JointOptions options;
  options.prior_deviation << 0.03, 10, 10, 0.03, 0.02;
  const auto report = [&](const char* name, std::array<bool, kCameraNumbers> is_free) {
    options.is_free = is_free;
    const JointSolution solution = adjust_jointly(views, fitted, camera, options);
    const PairAgreement in = agreement_of(views, solution.world_from_camera, fitted, changed(camera, solution.change));
    const PairAgreement out = agreement_of(views, solution.world_from_camera, held, changed(camera, solution.change));
    std::printf("%-10s", name);
    const double unit[] = {100, 1, 1, 100, 1};
    for (int k = 0; k < 5; ++k) std::printf(" %+8.4f(%.4f)", unit[k] * solution.change[k], unit[k] * std::sqrt(std::max(0.0, solution.covariance(k, k))));
    std::printf("  fitted %.2f %.2f  held %.2f %.2f (%lld)\n", 1000 * in.median_m, 1000 * in.rms_m, 1000 * out.median_m, 1000 * out.rms_m, static_cast<long long>(out.point_count));
    std::fflush(stdout);
  };
  report("none", {false, false, false, false, false});
  report("f bend", {true, false, false, true, false});
  report("f b off", {true, false, false, true, true});
  report("f c bend", {true, true, true, true, false});
  report("all", {true, true, true, true, true});
  return 0;
}

}  // namespace hermite
