#include "core/texture/view_alignment.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <optional>

#include "core/base/parallel.h"
#include "core/texture/sampled_views.h"

namespace hermite::texture {

namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr SampleDensity kAlignDensity{0.01, 200'000, 4};  // the pose may move by some pixels
// Images of a quarter, half and full size.
constexpr int kRoundsOfLevel[kBrightnessLevels] = {15, 12, 12};
// The prior towards the tracked pose: at this distance it weighs as much as this many points with
// the usual difference.
constexpr double kPriorPoints = 100, kPriorMove_m = 0.01, kPriorTurn_rad = 0.006;
constexpr std::size_t kFewestPoints = 300;

class ViewAligner {
 public:
  explicit ViewAligner(SampledViews& seen) : seen_(seen) {
    for (const TextureView& view : seen_.views) first_poses_.push_back(view.world_from_camera);
  }

  Alignment align() {
    for (std::size_t l = 0; l < std::size(kRoundsOfLevel); ++l)
      for (int round = 0; round < kRoundsOfLevel[l] && !is_stopped(seen_.options); ++round) {
        find_points(seen_.levels[l]);
        seen_.for_each_moving([&](std::size_t i) { step(seen_.levels[l], i); });
      }
    find_points(seen_.levels.back());
    return keep_the_better();
  }

 private:
  Vector3f in_camera(const TextureView& view, const MeshSample& sample) const {
    return view.rotation * sample.position_m + view.translation_m;
  }
  Eigen::Vector2f pixel_of(const Vector3f& point) const {
    return {static_cast<float>(seen_.camera.fx) * point.x() / point.z() +
                static_cast<float>(seen_.camera.cx),
            static_cast<float>(seen_.camera.fy) * point.y() / point.z() +
                static_cast<float>(seen_.camera.cy)};
  }

  Look look(const BrightnessLevel& level, std::size_t i, const TextureView& view,
            std::uint32_t sample) const {
    const Vector3f point = in_camera(view, seen_.samples[sample]);
    if (!(point.z() > 0.05f)) return {};
    const Eigen::Vector2f pixel = pixel_of(point);
    const std::optional<BrightnessSample> brightness = level.at(i, pixel.x(), pixel.y());
    if (!brightness) return {};
    const Vector3f way = view.place_m - seen_.samples[sample].position_m;
    const float cosine = std::max(seen_.samples[sample].normal.dot(way) / way.norm(), 0.05f);
    return {brightness->value, cosine / (point.z() * point.z())};
  }

  void find_points(const BrightnessLevel& level) {
    seen_.find_points([&](std::size_t i, std::uint32_t sample) {
      return look(level, i, seen_.views[i], sample);
    });
  }

  // One Gauss-Newton step of camera_from_world, by a twist on its left.
  void step(const BrightnessLevel& level, std::size_t i) {
    TextureView& view = seen_.views[i];
    Matrix6d matrix = Matrix6d::Zero();
    Vector6d right = Vector6d::Zero();
    std::size_t count = 0;
    for (std::size_t k = 0; k < seen_.sights[i].size(); ++k) {
      const std::optional<float> others = seen_.others_say(i, k);
      if (!others) continue;
      const Vector3f point = in_camera(view, seen_.samples[seen_.sights[i][k]]);
      const Eigen::Vector2f pixel = pixel_of(point);
      const std::optional<BrightnessSample> here = level.at(i, pixel.x(), pixel.y());
      if (!here) continue;
      const float iz = 1 / point.z(), du = here->du * static_cast<float>(seen_.camera.fx) * iz,
                  dv = here->dv * static_cast<float>(seen_.camera.fy) * iz;
      const Vector3f by_point(du, dv, -(du * point.x() + dv * point.y()) * iz);
      Vector6d row;
      row << by_point.cast<double>(), point.cross(by_point).cast<double>();
      const float difference = here->value - *others;
      const double weight = static_cast<double>(robust_weight(difference));
      matrix.selfadjointView<Eigen::Lower>().rankUpdate(row, weight);
      right -= weight * static_cast<double>(difference) * row;
      ++count;
    }
    if (count < kFewestPoints) return;
    // The twist, to the left of the present pose, that leads back to the first pose.
    const Vector6d back = log_se3(inverse(first_poses_[i]) * view.world_from_camera);
    const double unit = kPriorPoints * static_cast<double>(kUsualDifference * kUsualDifference);
    Vector6d prior;
    prior << Vector3d::Constant(unit / (kPriorMove_m * kPriorMove_m)),
        Vector3d::Constant(unit / (kPriorTurn_rad * kPriorTurn_rad));
    matrix.diagonal() += prior;
    right += prior.cwiseProduct(back);
    const Vector6d twist = matrix.selfadjointView<Eigen::Lower>().ldlt().solve(right);
    if (!twist.allFinite()) return;
    set_pose(view, inverse(exp_se3(twist) * inverse(view.world_from_camera)));
  }

  struct Misfit {
    double sum = 0;
    std::size_t count = 0;
  };
  // Returns the robust squared difference between the view at this pose and the other views at
  // theirs.
  Misfit misfit(std::size_t i, const Rigid3& world_from_camera) const {
    TextureView view;
    set_pose(view, world_from_camera);
    Misfit misfit;
    for (std::size_t k = 0; k < seen_.sights[i].size(); ++k) {
      const std::optional<float> others = seen_.others_say(i, k);
      if (!others) continue;
      const Look here = look(seen_.levels.back(), i, view, seen_.sights[i][k]);
      if (here.weight <= 0) continue;
      const float difference = here.value - *others;
      misfit.sum += static_cast<double>(robust_weight(difference) * difference * difference);
      ++misfit.count;
    }
    return misfit;
  }

  Alignment keep_the_better() {
    struct Judged {
      Misfit before, after;
      bool is_kept = false;
    };
    std::vector<Judged> judged(seen_.views.size());
    seen_.for_each_moving([&](std::size_t i) {
      const Rigid3 move = inverse(first_poses_[i]) * seen_.views[i].world_from_camera;
      judged[i].before = misfit(i, first_poses_[i]);
      judged[i].after = misfit(i, seen_.views[i].world_from_camera);
      const Misfit &before = judged[i].before, &after = judged[i].after;
      judged[i].is_kept =
          move.translation.norm() <= kFarthestMove_m &&
          angle_rad(move.rotation) <= kFarthestTurn_rad && after.count >= kFewestPoints &&
          10 * after.count >= 9 * before.count &&
          after.sum / static_cast<double>(after.count) <
              before.sum / static_cast<double>(std::max<std::size_t>(before.count, 1));
    });
    Alignment alignment;
    Misfit before, after;
    for (std::size_t i = seen_.first_moving; i < seen_.views.size(); ++i) {
      if (judged[i].is_kept &&
          !(seen_.views[i].world_from_camera.matrix() == first_poses_[i].matrix()))
        ++alignment.moved_count;
      else
        set_pose(seen_.views[i], first_poses_[i]);
      const Misfit& kept = judged[i].is_kept ? judged[i].after : judged[i].before;
      before.sum += judged[i].before.sum;
      before.count += judged[i].before.count;
      after.sum += kept.sum;
      after.count += kept.count;
    }
    if (before.count > 0)
      alignment.before_rms = std::sqrt(before.sum / static_cast<double>(before.count));
    if (after.count > 0)
      alignment.after_rms = std::sqrt(after.sum / static_cast<double>(after.count));
    return alignment;
  }

  SampledViews& seen_;
  std::vector<Rigid3> first_poses_;
};

}  // namespace

Alignment align_views(const output::TriangleMesh& mesh, const TextureFrames& frames,
                      const TextureOptions& options, std::vector<TextureView>& views,
                      std::size_t guest_count) {
  SampledViews seen(mesh, frames.camera, options, {views, guest_count}, kAlignDensity);
  const Alignment alignment = ViewAligner(seen).align();
  in_parallel(views.size(), options.thread_count, [&](std::size_t i) {
    if (!is_stopped(options)) see_mesh(views[i], mesh, frames);
  });
  return alignment;
}

}  // namespace hermite::texture
