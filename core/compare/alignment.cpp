#include "core/compare/alignment.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <tuple>
#include <vector>

#include "core/base/parallel.h"
#include "core/compare/sheet_distance.h"

namespace hermite::compare {

namespace {

using Eigen::Vector3d;

constexpr std::array kGates{5.0, 3.0, 2.0, 1.0};  // spacings of samples
constexpr int kStepsOfGate = 6;
constexpr double kGateCosine = 0.7;
// Factor from the median of absolute values to a Gaussian's standard deviation.
constexpr double kOfDeviation = 1.4826;
constexpr double kTukey = 4.685;         // deviations: 95 % efficient for Gaussian errors
constexpr double kLeastScale_m = 0.004;  // of samples, which are single surfels
constexpr std::size_t kMostAlignedPlaces = 6000;
constexpr std::array kReaches_m{0.06, 0.04, 0.03, 0.03, 0.03};
constexpr double kRegion_m = 0.5;
constexpr std::size_t kLeastOfRegion = 6;
// Damps motions along which flat surfaces give no information, relative to the largest.
constexpr double kDamping = 1e-7;
// The noise of normals, about a hundredth, looks like information about a motion along a flat
// surface. Below this share of all information about translations a direction counts as free, with
// this standard deviation.
constexpr double kLeastHeldShare = 5e-4, kFreeSigma_m = 1;

double median_of(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double tukey_weight(double deviations) {
  const double share = deviations / kTukey;
  return std::abs(share) < 1 ? std::pow(1 - share * share, 2) : 0;
}

// The surface of A at a place of B: residual = normal . (surface of A - place of B), in A's world.
struct Residual {
  bool is_known = false;
  Vector3d point_m, normal;  // of B, of A
  double value_m = 0, sigma_m = 1, weight = 0;

  Vector6d gradient() const {
    Vector6d row;
    row << normal, point_m.cross(normal);
    return row;
  }
};

struct Sums {
  Matrix6d information = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
};

Sums weighted_sums(std::vector<Residual>& residuals, double least_scale) {
  std::vector<double> deviations;
  for (const Residual& residual : residuals)
    if (residual.is_known) deviations.push_back(std::abs(residual.value_m) / residual.sigma_m);
  const double scale = std::max(least_scale, kOfDeviation * median_of(deviations));
  Sums sums;
  for (Residual& residual : residuals) {
    if (!residual.is_known) continue;
    residual.weight = tukey_weight(residual.value_m / residual.sigma_m / scale) /
                      (residual.sigma_m * residual.sigma_m);
    const Vector6d row = residual.gradient();
    sums.information += residual.weight * row * row.transpose();
    sums.gradient += residual.weight * residual.value_m * row;
  }
  return sums;
}

Rigid3 stepped(const Sums& sums, const Rigid3& a_from_b) {
  const Matrix6d damped =
      sums.information + kDamping * sums.information.diagonal().maxCoeff() * Matrix6d::Identity();
  const Vector6d twist = damped.ldlt().solve(sums.gradient);
  return twist.allFinite() ? exp_se3(twist) * a_from_b : a_from_b;
}

std::vector<Residual> sample_residuals(const SampleGrid& a, std::span<const SurfaceSample> b,
                                       const Rigid3& a_from_b, std::size_t stride, double gate_m) {
  std::vector<Residual> residuals;
  for (std::size_t i = 0; i < b.size(); i += stride) {
    const Vector3d point_m = a_from_b * b[i].position_m;
    const std::optional<std::uint32_t> near =
        a.nearest(point_m, a_from_b.rotation * b[i].normal, gate_m, kGateCosine);
    if (!near) continue;
    const SurfaceSample& surface = a.sample(*near);
    residuals.push_back(
        {true, point_m, surface.normal, surface.normal.dot(surface.position_m - point_m), 1, 0});
  }
  return residuals;
}

std::vector<measure::MeasuredPlace> places_of(const CoarseScan& scan) {
  const std::span<const SurfaceSample> samples = scan.samples();
  const std::size_t stride = samples.size() / kMostAlignedPlaces + 1;
  std::vector<std::optional<measure::MeasuredPlace>> fitted((samples.size() + stride - 1) / stride);
  in_parallel(fitted.size(), [&](std::size_t i) {
    fitted[i] = place_at(scan.scan(), samples[i * stride].position_m);
  });
  std::vector<measure::MeasuredPlace> places;
  for (const std::optional<measure::MeasuredPlace>& place : fitted)
    if (place) places.push_back(*place);
  return places;
}

std::vector<Residual> place_residuals(const ComparedScan& a,
                                      const std::vector<measure::MeasuredPlace>& places_b,
                                      const Rigid3& a_from_b, double reach_m) {
  std::vector<Residual> residuals(places_b.size());
  in_parallel(places_b.size(), [&](std::size_t i) {
    measure::MeasuredPlace place = places_b[i];
    place.position_m = a_from_b * place.position_m;
    place.normal = a_from_b.rotation * place.normal;
    const std::optional<SheetDistance> found = sheet_distance(place, a, reach_m);
    if (!found) return;
    const Vector3d& normal = found->on_surface.normal;
    residuals[i] = {true,           place.position_m,
                    normal,         normal.dot(found->on_surface.position_m - place.position_m),
                    found->sigma_m, 0};
  });
  return residuals;
}

// Residuals of one region of space that face the same way.
using RegionKey = std::tuple<int, int, int, int>;
struct Region {
  Vector6d gradient = Vector6d::Zero();
  double weight = 0, weighted_m = 0;
  std::size_t count = 0;
};

RegionKey region_of(const Residual& residual) {
  const Eigen::Vector3i cube = (residual.point_m / kRegion_m).array().floor().cast<int>();
  Eigen::Index axis = 0;
  residual.normal.cwiseAbs().maxCoeff(&axis);
  return {cube.x(), cube.y(), cube.z(),
          static_cast<int>(2 * axis) + (residual.normal[axis] < 0 ? 1 : 0)};
}

std::map<RegionKey, Region> regions_of(const std::vector<Residual>& residuals) {
  std::map<RegionKey, Region> regions;
  for (const Residual& residual : residuals) {
    if (!residual.is_known || residual.weight <= 0) continue;
    Region& region = regions[region_of(residual)];
    region.gradient += residual.weight * residual.value_m * residual.gradient();
    region.weight += residual.weight;
    region.weighted_m += residual.weight * residual.value_m;
    ++region.count;
  }
  return regions;
}

// Adds the variance of a translation that nothing holds.
void add_freedom(const std::vector<Residual>& residuals, Matrix6d& covariance) {
  Eigen::Matrix3d held = Eigen::Matrix3d::Zero();
  for (const Residual& residual : residuals)
    if (residual.is_known) held += residual.weight * residual.normal * residual.normal.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(held);
  for (int axis = 0; axis < 3; ++axis)
    if (axes.eigenvalues()[axis] < kLeastHeldShare * held.trace())
      covariance.topLeftCorner<3, 3>() += kFreeSigma_m * kFreeSigma_m *
                                          axes.eigenvectors().col(axis) *
                                          axes.eigenvectors().col(axis).transpose();
}

void add_uncertainty(const std::vector<Residual>& residuals, const Sums& sums,
                     ScanAlignment& alignment) {
  const std::map<RegionKey, Region> regions = regions_of(residuals);
  Matrix6d scatter = Matrix6d::Zero();
  std::vector<double> means_m;
  for (const auto& [key, region] : regions) {
    scatter += region.gradient * region.gradient.transpose();
    if (region.count >= kLeastOfRegion)
      means_m.push_back(std::abs(region.weighted_m / region.weight));
  }
  const double largest = sums.information.diagonal().maxCoeff();
  const Matrix6d inverse_information =
      (sums.information + 1e-9 * largest * Matrix6d::Identity()).inverse();
  const auto region_count = static_cast<double>(regions.size());
  alignment.covariance = inverse_information * scatter * inverse_information *
                             (region_count / std::max(1.0, region_count - 6)) +
                         inverse_information;
  add_freedom(residuals, alignment.covariance);
  alignment.disagreement_m = kOfDeviation * median_of(means_m);
  Eigen::Matrix<double, 3, 6> motion;
  motion << Eigen::Matrix3d::Identity(), -skew(alignment.middle_m);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(motion * alignment.covariance *
                                                            motion.transpose());
  alignment.weakest_sigma_m = std::sqrt(std::max(0.0, axes.eigenvalues()[2]));
  alignment.weakest_direction = axes.eigenvectors().col(2);
}

}  // namespace

Rigid3 aligned_roughly(const CoarseScan& a, const CoarseScan& b, const Rigid3& a_from_b,
                       std::size_t most) {
  Rigid3 pose = a_from_b;
  const std::size_t stride = b.samples().size() / most + 1;
  const double spacing_m = std::max(a.spacing_m(), b.spacing_m());
  for (const double gate : kGates)
    for (int step = 0; step < kStepsOfGate; ++step) {
      std::vector<Residual> residuals =
          sample_residuals(a.grid(), b.samples(), pose, stride, gate * spacing_m);
      if (residuals.size() < kLeastPlaces) return pose;
      pose = stepped(weighted_sums(residuals, kLeastScale_m), pose);
    }
  return pose;
}

ScanAlignment aligned_exactly(const CoarseScan& a, const CoarseScan& b, const Rigid3& a_from_b) {
  const std::vector<measure::MeasuredPlace> places = places_of(b);
  ScanAlignment alignment{a_from_b};
  std::vector<Residual> residuals;
  Sums sums;
  for (const double reach_m : kReaches_m) {
    residuals = place_residuals(a.scan(), places, alignment.a_from_b, reach_m);
    sums = weighted_sums(residuals, 1);
    alignment.place_count = 0;
    alignment.middle_m.setZero();
    for (const Residual& residual : residuals) {
      if (!residual.is_known || residual.weight <= 0) continue;
      ++alignment.place_count;
      alignment.middle_m += residual.point_m;
    }
    if (alignment.place_count < kLeastPlaces) return alignment;
    alignment.middle_m /= static_cast<double>(alignment.place_count);
    alignment.a_from_b = stepped(sums, alignment.a_from_b);
  }
  residuals = place_residuals(a.scan(), places, alignment.a_from_b, kReaches_m.back());
  sums = weighted_sums(residuals, 1);
  add_uncertainty(residuals, sums, alignment);
  return alignment;
}

}  // namespace hermite::compare
