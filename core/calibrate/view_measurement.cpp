#include "core/calibrate/view_measurement.h"

#include <algorithm>
#include <cmath>

#include "core/adjust/bundle_noise.h"

namespace hermite::calibrate {
namespace {

// The step between a view's nodes in each direction: 12 pixels of 640, so that neighbouring windows
// hardly overlap.
constexpr int kEveryNode = 3;

constexpr double kGateOverScale = 3;
// A residual that noise explains is inside the gate, however narrow that is.
constexpr double kGateSigmas = 3;
constexpr double kLeastScale_px = 2;

constexpr float kAlikeCosine = 0.8f;  // of the normals of both sides, as in depth_links.cpp
constexpr float kBehind_m = 0.2f;

// Standard deviation [m] of a point on a plane, as in depth_links.cpp: the mean of a window's
// pixels, plus the error of tracking.
double deviation_m(double depth_m) {
  return adjust::kTracked_m + adjust::depth_deviation_m(depth_m) / 2;
}

// Moves the facets of each row from the time at which it was taken to that of the time stamp.
void move_to_time_stamp(const PatchGrid& grid, const Vector6d& twist_per_s, double readout_s,
                        int height_px, std::vector<Facet>& facets) {
  if (readout_s == 0) return;
  for (int row = 0; row < grid.nodes.height; ++row) {
    const Rigid3 stamp_from_row =
        exp_se3(twist_per_s * (readout_s * share_of_row(grid.pixel_of(row), height_px)));
    const Eigen::Matrix3f rotation = stamp_from_row.rotation.toRotationMatrix().cast<float>();
    const Eigen::Vector3f translation = stamp_from_row.translation.cast<float>();
    for (int column = 0; column < grid.nodes.width; ++column) {
      Facet& facet = facets[grid.nodes.index(column, row)];
      if (facet.point_m.z() <= 0) continue;
      const Eigen::Vector3f point_m = rotation * facet.point_m + translation,
                            normal = rotation * facet.plane_per_m;
      const float over_plane = normal.dot(point_m);
      facet = over_plane > 0 ? Facet{point_m, normal / over_plane} : Facet{};
    }
  }
}

void undistort(const Camera& camera, std::vector<adjust::Feature>& features) {
  for (adjust::Feature& feature : features) {
    const Eigen::Vector2d received_px = feature.pixel_px.cast<double>();
    feature.pixel_px = camera.undistort(received_px.x(), received_px.y()).cast<float>();
  }
}

// The derivative by k1 of the point of the plane at depth 1 that a pixel of the received image
// shows; `at` is where it is now.
Eigen::Vector2d by_radial(const Eigen::Vector2d& at, const Distortion& distortion) {
  const double r2 = at.squaredNorm();
  return -at * (r2 / (1 + 3 * distortion.k1 * r2));
}

}  // namespace

ViewMeasurement::ViewMeasurement(const std::vector<CalibrationView>& views, const Camera& trial,
                                 unsigned thread_count)
    : views_(views), camera_(trial), facets_(views.size()), corners_(views.size()) {
  for_all(views.size(), thread_count, [this](std::size_t i) {
    corners_[i] = views_[i].features;
    if (camera_.distortion != Distortion{}) undistort(camera_, corners_[i]);
    facets_[i] = facets_of(views_[i].patches, camera_);
    move_to_time_stamp(views_[i].patches, views_[i].twist_per_s(), camera_.timing.depth_readout_s,
                       camera_.height, facets_[i]);
  });
}

std::vector<SurfaceMatch> ViewMeasurement::surface_matches(const PairSide& side,
                                                           double gate_m) const {
  const auto& [source, target, target_from_source] = side;
  const PatchGrid &from = views_[source].patches, &to = views_[target].patches;
  const Eigen::Matrix3f rotation = target_from_source.rotation.toRotationMatrix().cast<float>();
  const Eigen::Vector3f translation = target_from_source.translation.cast<float>();
  const Eigen::Matrix<float, 6, 1> moving =
      (camera_.timing.depth_readout_s * views_[target].twist_per_s()).cast<float>();
  const Eigen::Array2f focal = Eigen::Array2d(camera_.fx, camera_.fy).cast<float>();
  const Eigen::Array2f center = Eigen::Array2d(camera_.cx, camera_.cy).cast<float>();
  const bool has_distortion = camera_.distortion != Distortion{};
  const auto projected_px = [&](const Eigen::Vector3f& point) {
    Eigen::Array2f at = point.head<2>().array() / point.z();
    if (has_distortion)
      at = camera_.distortion.apply(double{at.x()}, double{at.y()}).cast<float>().array();
    return Eigen::Array2f(at * focal + center);
  };
  // Where the target's depth image shows a point, which has moved by the time that its row is
  // taken.
  const auto seen_at_px = [&](const Eigen::Vector3f& point) {
    const Eigen::Array2f at_stamp_px = projected_px(point);
    const float share = at_stamp_px.y() / static_cast<float>(camera_.height - 1) - 0.5f;
    return projected_px(point - share * (moving.head<3>() + moving.tail<3>().cross(point)));
  };
  std::vector<SurfaceMatch> matches;
  for (int row = 1; row < from.nodes.height; row += kEveryNode)
    for (int column = 1; column < from.nodes.width; column += kEveryNode) {
      const Facet& facet = facets_[source][from.nodes.index(column, row)];
      if (facet.point_m.z() <= 0) continue;
      const Eigen::Vector3f point = rotation * facet.point_m + translation;
      if (point.z() < kBehind_m) continue;
      const Eigen::Array2f at = seen_at_px(point);
      const Eigen::Array2f node =
          (at - static_cast<float>(to.step_px / 2)) / static_cast<float>(to.step_px) + 0.5f;
      if (!(node.x() >= 0 && node.y() >= 0 && node.x() < static_cast<float>(to.nodes.width) &&
            node.y() < static_cast<float>(to.nodes.height)))
        continue;
      const Facet& there =
          facets_[target][to.nodes.index(static_cast<int>(node.x()), static_cast<int>(node.y()))];
      if (there.point_m.z() <= 0) continue;
      const float length_per_m = there.plane_per_m.norm(),
                  over_plane = there.plane_per_m.dot(point);
      if (!(over_plane > 0)) continue;
      const double distance_m = static_cast<double>((over_plane - 1) / length_per_m);
      const double behind_m = static_cast<double>(point.z() * (1 - 1 / over_plane));
      const double sigma_m =
          deviation_m(static_cast<double>(std::max(point.z(), facet.point_m.z())));
      const double near_m = std::max(gate_m, kGateSigmas * sigma_m);
      if (std::abs(distance_m) > near_m || std::abs(behind_m) > 2 * near_m) continue;
      const Eigen::Vector3f normal = rotation * facet.plane_per_m.normalized();
      if (normal.dot(there.plane_per_m) < kAlikeCosine * length_per_m) continue;
      matches.push_back({facet.point_m.cast<double>(), point.cast<double>(),
                         Eigen::Vector2d(from.pixel_of(column), from.pixel_of(row)),
                         at.matrix().cast<double>(), normal.cast<double>(), distance_m, behind_m,
                         sigma_m, near_m});
    }
  return matches;
}

// The derivative of a point measured at a pixel by the parameters of the camera, without those of
// the timing.
ViewMeasurement::PointByCamera ViewMeasurement::derivative_by_camera(
    const Eigen::Vector3d& point_m, const Eigen::Vector2d& pixel_px) const {
  const double rho2 = camera_.rho2(pixel_px.x(), pixel_px.y()),
               offset_per_m = camera_.depth_correction.inverse_offset_per_m;
  const double scale = 1 + offset_per_m * kUndistortedDepth_m;
  PointByCamera derivative = PointByCamera::Zero();
  derivative.col(kFocal) << -point_m.x(), -point_m.y(), 0;
  derivative.col(kCenterX) << -point_m.z() / camera_.fx, 0, 0;
  derivative.col(kCenterY) << 0, -point_m.z() / camera_.fy, 0;
  derivative.col(kRadial).head<2>() =
      point_m.z() * by_radial(point_m.head<2>() / point_m.z(), camera_.distortion);
  derivative.col(kBend) = point_m * (rho2 / (1 + camera_.depth_correction.bend * rho2) *
                                     (1 - offset_per_m * point_m.z() / scale));
  derivative.col(kInverseOffset) = point_m * ((kUndistortedDepth_m - point_m.z()) / scale);
  return derivative;
}

void ViewMeasurement::add_surfaces(const PairSide& side, double gate_m, SideQuadratic& sum) const {
  const Eigen::Matrix3d source_from_target =
      side.target_from_source.rotation.conjugate().toRotationMatrix();
  const auto by_camera = [this](const Eigen::Vector3d& point_m, const Eigen::Vector2d& pixel_px,
                                const Vector6d& twist_per_s) {
    PointByCamera derivative = derivative_by_camera(point_m, pixel_px);
    derivative.col(kDepthReadout) =
        share_of_row(pixel_px.y(), camera_.height) * velocity_of(point_m, twist_per_s);
    return derivative;
  };
  for (const SurfaceMatch& m : surface_matches(side, gate_m)) {
    const Eigen::Vector3d normal_in_source = source_from_target * m.normal_in_target;
    SideQuadratic::Vector derivative;
    derivative.segment<3>(0) = normal_in_source;
    derivative.segment<3>(3) = m.in_source_m.cross(normal_in_source);
    // The camera moves both the point and the surface seen at its pixel.
    derivative.tail<kCameraNumberCount>() =
        by_camera(m.in_source_m, m.source_px, views_[side.source].twist_per_s()).transpose() *
            normal_in_source -
        by_camera(m.in_target_m, m.target_px, views_[side.target].twist_per_s()).transpose() *
            m.normal_in_target;
    const double off = m.distance_m * kGateOverScale / m.gate_m;
    const double weight = 1 / (m.sigma_m * m.sigma_m * (1 + off * off));
    sum.information.selfadjointView<Eigen::Lower>().rankUpdate(derivative, weight);
    sum.gradient += weight * m.distance_m * derivative;
  }
}

std::vector<adjust::LandmarkMatch> ViewMeasurement::corner_matches(
    const PairSide& side, const MeasurementGates& gates) const {
  const auto& [source, target, target_from_source] = side;
  // Of the time within colour only the delay is considered: the readout moves a corner by less than
  // the gates.
  const Rigid3 of_colors = exp_se3(-camera_.timing.color_delay_s * views_[target].twist_per_s()) *
                           target_from_source *
                           exp_se3(camera_.timing.color_delay_s * views_[source].twist_per_s());
  return match_corners(corners_[source], corners_[target], of_colors, camera_, gates);
}

double ViewMeasurement::color_time_s(const Eigen::Vector2d& pixel_px) const {
  return camera_.timing.color_time_s(pixel_px.y(), camera_.height);
}

struct ViewMeasurement::Sighting {
  Eigen::Vector3d as_measured_m;         // in the source when it was taken
  Eigen::Vector3d in_source_m;           // in the source at its time stamp
  Eigen::Vector3d in_target_m;           // in the target when it was taken
  Eigen::Matrix3d target_from_source;    // rotation between these two
  Eigen::Vector2d source_px, target_px;  // where it is seen
  double scale = 1;                      // of the coarser of both octaves
  // From where it is seen in the target to where it is projected.
  Eigen::Vector2d error_px;
};

std::optional<ViewMeasurement::Sighting> ViewMeasurement::sighting(
    const PairSide& side, const adjust::LandmarkMatch& match) const {
  const auto& [source, target, target_from_source] = side;
  const adjust::Feature &seen = corners_[source][match.landmark],
                        &there = corners_[target][match.feature];
  const std::optional<Eigen::Vector3d> own = point_of(seen, camera_);
  if (!own) return std::nullopt;
  Sighting result;
  result.as_measured_m = *own;
  result.source_px = seen.pixel_px.cast<double>();
  result.target_px = there.pixel_px.cast<double>();
  result.scale = std::max(adjust::octave_scale(seen.octave), adjust::octave_scale(there.octave));
  result.in_source_m =
      exp_se3(color_time_s(result.source_px) * views_[source].twist_per_s()) * *own;
  const Rigid3 taken_from_source =
      exp_se3(-color_time_s(result.target_px) * views_[target].twist_per_s()) * target_from_source;
  result.target_from_source = taken_from_source.rotation.toRotationMatrix();
  result.in_target_m = taken_from_source * result.in_source_m;
  if (result.in_target_m.z() < static_cast<double>(kBehind_m)) return std::nullopt;
  result.error_px = camera_.project(result.in_target_m) - result.target_px;
  return result;
}

std::vector<Eigen::Vector2d> ViewMeasurement::corner_errors_px(
    const PairSide& side, const MeasurementGates& gates) const {
  std::vector<Eigen::Vector2d> errors_px;
  for (const adjust::LandmarkMatch& match : corner_matches(side, gates)) {
    if (const std::optional<Sighting> corner = sighting(side, match))
      errors_px.push_back(corner->error_px);
  }
  return errors_px;
}

// Both pixels have errors, and derivatives taken at either would be correlated with them: the bias
// of errors in variables (Fuller, Measurement Error Models, 1987). At 320x240 it was 0.7 % of focal
// length, 0.004 of k1 and 0.3 % of bend with rendered walls without any noise of depth. Halfway
// between them, where errors of equal size cancel, it is 0.2 %, 0.0015 and 0.
ViewMeasurement::Sighting ViewMeasurement::halfway(Sighting corner) const {
  const Eigen::Array2d half_px = 0.5 * corner.error_px.array(),
                       focal_px = Eigen::Array2d(camera_.fx, camera_.fy);
  Eigen::Vector3d moved_m = Eigen::Vector3d::Zero();
  moved_m.head<2>() = -corner.in_target_m.z() * (half_px / focal_px).matrix();
  corner.in_target_m += moved_m;
  const Eigen::Vector3d moved_in_source_m = corner.target_from_source.transpose() * moved_m;
  corner.in_source_m += moved_in_source_m;
  corner.as_measured_m += moved_in_source_m;
  corner.source_px = camera_.project(corner.as_measured_m);
  corner.target_px = camera_.project(corner.in_target_m);
  return corner;
}

void ViewMeasurement::add_corner(const PairSide& side, const adjust::LandmarkMatch& match,
                                 double gate_px, SideQuadratic& sum) const {
  const std::optional<Sighting> measured = sighting(side, match);
  if (!measured) return;
  const double sigma_px = measured->scale;
  if (measured->error_px.norm() > gate_px * sigma_px) return;
  const Sighting corner = halfway(*measured);
  const Eigen::Vector3d& point = corner.in_target_m;
  Eigen::Matrix<double, 2, 3> by_point;
  by_point << camera_.fx / point.z(), 0, -camera_.fx * point.x() / (point.z() * point.z()),  //
      0, camera_.fy / point.z(), -camera_.fy * point.y() / (point.z() * point.z());
  const Eigen::Matrix<double, 2, 3> by_own = by_point * corner.target_from_source;
  Eigen::Matrix<double, 2, kSideNumberCount> derivative;
  derivative.leftCols<3>() = by_own;
  derivative.middleCols<3>(3) = -by_own * skew(corner.in_source_m);
  derivative.rightCols<kCameraNumberCount>() =
      by_own * derivative_by_camera(corner.as_measured_m, corner.source_px);
  derivative(0, 6 + kFocal) += camera_.fx * point.x() / point.z();
  derivative(1, 6 + kFocal) += camera_.fy * point.y() / point.z();
  const Eigen::Array2d focal(camera_.fx, camera_.fy);
  derivative.col(6 + kRadial) -=
      (by_radial(point.head<2>() / point.z(), camera_.distortion).array() * focal).matrix();
  derivative(0, 6 + kCenterX) += 1;
  derivative(1, 6 + kCenterY) += 1;
  const Eigen::Vector2d later_source = by_own * velocity_of(corner.in_source_m,
                                                            views_[side.source].twist_per_s()),
                        later_target =
                            -by_point * velocity_of(point, views_[side.target].twist_per_s());
  derivative.col(6 + kColorDelay) = later_source + later_target;
  derivative.col(6 + kColorReadout) =
      share_of_row(corner.source_px.y(), camera_.height) * later_source +
      share_of_row(corner.target_px.y(), camera_.height) * later_target;
  const double scale_px = std::max(kLeastScale_px, gate_px / kGateOverScale) * sigma_px;
  const double weight =
      1 / (sigma_px * sigma_px * (1 + measured->error_px.squaredNorm() / (scale_px * scale_px)));
  sum.information.selfadjointView<Eigen::Lower>().rankUpdate(derivative.transpose(), weight);
  sum.gradient += weight * derivative.transpose() * measured->error_px;
}

}  // namespace hermite::calibrate
