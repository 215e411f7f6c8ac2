#include "core/evaluate/true_surface.h"

#include <algorithm>
#include <cmath>

#include "core/dataset/associate.h"
#include "core/source/open_sequence.h"
#include "core/synthetic/synthetic_camera.h"

namespace hermite::evaluate {

namespace {

constexpr std::int64_t kFrames = 24;
constexpr std::size_t kSamples = 200'000;
constexpr int kWideImage_px = 320;

const std::string kSynthetic = "synthetic";

std::vector<Eigen::Vector3d> samples_of(const std::vector<Triangle>& triangles) {
  std::vector<Eigen::Vector3d> samples;
  const std::size_t stride = triangles.size() / kSamples + 1;
  for (std::size_t i = 0; i < triangles.size(); i += stride)
    samples.push_back(((triangles[i][0] + triangles[i][1] + triangles[i][2]) / 3).cast<double>());
  return samples;
}

}  // namespace

TrueSurface surface_of_triangles(const std::vector<Triangle>& triangles) {
  const auto grid = std::make_shared<const TriangleSurface>(triangles, kSurfaceReach_m);
  return {[grid](const Eigen::Vector3d& point) { return grid->distance_m(point); },
          samples_of(triangles)};
}

Result<TrueSurface> surface_of_sequence(const dataset::Sequence& sequence,
                                        const std::string& source) {
  if (sequence.groundtruth().empty())
    return Error{ErrorCode::kNotFound, source + " has no true poses: there is no true surface"};
  std::vector<Triangle> triangles;
  const std::int64_t stride =
      std::max<std::int64_t>(1, (sequence.frame_count() + kFrames - 1) / kFrames);
  for (std::int64_t i = 0; i < sequence.frame_count(); i += stride) {
    const std::optional<Rigid3> world_from_camera = dataset::pose_at(
        sequence.groundtruth(), sequence.timestamp_s(i), dataset::kMaxAssociationGap_s);
    if (!world_from_camera) continue;
    const Result<dataset::RecordedFrame> frame = sequence.read(i);
    if (!frame.ok()) continue;  // the other frames suffice
    append_depth_triangles(frame->depth, sequence.camera(), *world_from_camera,
                           sequence.camera().width > kWideImage_px ? 2 : 1, triangles);
  }
  const std::string base = source::source_without_suffixes(source);
  if (base.rfind(kSynthetic, 0) != 0) return surface_of_triangles(triangles);
  const std::string text =
      base.size() > kSynthetic.size() ? base.substr(kSynthetic.size() + 1) : "";
  const Result<synthetic::SyntheticOptions> options = synthetic::parse_synthetic_options(text);
  if (!options.ok()) return options.error();
  const auto room = std::make_shared<const synthetic::SyntheticRoom>(
      or_throw(synthetic::SyntheticRoom::create(options->scene, options->changes)));
  return TrueSurface{[room](const Eigen::Vector3d& point) {
                       return std::min(room->surface_distance(point), kSurfaceReach_m);
                     },
                     samples_of(triangles)};
}

double completeness(const TrueSurface& surface, const TriangleSurface& cloud_in_world,
                    double within_m) {
  if (surface.samples.empty()) return 0;
  const auto is_there = [&](const Eigen::Vector3d& sample) {
    return cloud_in_world.distance_m(sample) <= within_m;
  };
  return static_cast<double>(
             std::count_if(surface.samples.begin(), surface.samples.end(), is_there)) /
         static_cast<double>(surface.samples.size());
}

}  // namespace hermite::evaluate
