#include "core/mesh/surfel_field.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <string>
#include <utility>

#include "core/output/spacing.h"

namespace hermite::mesh {
namespace {

// The cell size follows the distance of the surfels: finer cells add no detail, coarser ones lose
// it.
constexpr double kLeastOwnCell_m = 0.005, kMostOwnCell_m = 0.04;
// The corners of a cell that the surface passes through are within one cell edge of it; supports
// are at least twice as large, so that some kernels have weight there. The upper bound keeps a lone
// surfel from reaching across the room.
constexpr double kLeastSupport_cells = 2, kMostSupport_cells = 8;
// The integral of (1 - d / r)^3 over a disc of radius r, in r^2.
constexpr double kSupportOfPlane = std::numbers::pi / 10;
// Room for the cells and bins around the farthest ones.
constexpr int kSpareCells = 128;
// How much normals may differ within one sheet (Oztireli, Guennebaud, Gross 2009, Eq. 14, where 0.5
// to 1.5 is recommended). Weighting them by distance as well made no measurable difference.
constexpr float kNormalSpread = 0.7f;
constexpr int kSheetSteps = 3;

bool is_usable(const output::CloudPoint& point) {
  return point.position_m.allFinite() && point.normal.allFinite() &&
         point.normal.squaredNorm() > 0.25f;
}

std::uint64_t key_of(const Eigen::Vector3i& bin) {
  const auto part = [](int value) { return static_cast<std::uint64_t>(value + kMostCell); };
  return part(bin.z()) << 40 | part(bin.y()) << 20 | part(bin.x());
}

// Returns the mean distance to the neighbours, by kernel.
std::vector<float> spacings_of(const std::vector<FieldKernel>& kernels) {
  std::vector<Eigen::Vector3f> positions_m;
  positions_m.reserve(kernels.size());
  for (const FieldKernel& kernel : kernels) positions_m.push_back(kernel.position_m);
  return output::spacings_of_positions_m(positions_m);
}

float median_of(std::vector<float> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// In a cloud without confidences all points have the same weight.
std::vector<FieldKernel> kernels_of(const output::Cloud& cloud) {
  const bool is_known =
      std::any_of(cloud.begin(), cloud.end(),
                  [](const output::CloudPoint& point) { return point.confidence > 0; });
  std::vector<FieldKernel> kernels;
  kernels.reserve(cloud.size());
  for (const output::CloudPoint& point : cloud) {
    const float confidence = is_known ? std::min(point.confidence, kMostConfidence) : 1;
    if (is_usable(point) && confidence > 0)
      kernels.push_back(
          {point.position_m, point.normal.normalized(), 0, confidence, 0, point.color});
  }
  return kernels;
}

}  // namespace

void spread(FieldKernel& kernel, float spacing_m, double support_spacings, double cell_m) {
  const double wanted_m = support_spacings * static_cast<double>(spacing_m);
  kernel.radius_m = static_cast<float>(
      std::clamp(wanted_m, kLeastSupport_cells * cell_m, kMostSupport_cells * cell_m));
  kernel.weight /= kernel.radius_m * kernel.radius_m;
  kernel.area = spacing_m * spacing_m /
                (kernel.radius_m * kernel.radius_m * static_cast<float>(kSupportOfPlane));
}

SurfelField SurfelField::of(std::vector<FieldKernel> kernels, double cell_m) {
  SurfelField field;
  field.cell_m_ = cell_m;
  for (const FieldKernel& kernel : kernels)
    field.reach_m_ = std::max(field.reach_m_, kernel.radius_m);
  field.sort_into_bins(std::move(kernels));
  return field;
}

Result<SurfelField> SurfelField::create(const output::Cloud& cloud, const FieldOptions& options) {
  return of_kernels(kernels_of(cloud), cloud.size(), options);
}

Result<SurfelField> SurfelField::create(output::Cloud&& cloud, const FieldOptions& options) {
  const std::size_t count = cloud.size();
  std::vector<FieldKernel> kernels = kernels_of(cloud);
  output::Cloud().swap(cloud);
  return of_kernels(std::move(kernels), count, options);
}

Result<SurfelField> SurfelField::of_kernels(std::vector<FieldKernel> kernels,
                                            std::size_t point_count, const FieldOptions& options) {
  SurfelField field;
  field.options_ = options;
  field.rejected_count_ = point_count - kernels.size();
  if (kernels.empty())
    return Error{
        ErrorCode::kInvalidArgument,
        "the cloud has no point with a position and a normal: there is no surface to mesh"};
  const std::vector<float> spacings = spacings_of(kernels);
  field.cell_m_ = options.cell_m;
  if (options.cell_m == 0)
    field.cell_m_ = std::clamp<double>(median_of(spacings), kLeastOwnCell_m, kMostOwnCell_m);
  if (!(field.cell_m_ >= kLeastCell_m && field.cell_m_ <= kMostCell_m))
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("cell of {:f} m: expected {:f} to {:f}, or 0 for what fits the cloud",
                             options.cell_m, kLeastCell_m, kMostCell_m)};
  const float most_m = static_cast<float>(field.cell_m_ * (kMostCell - kSpareCells));
  for (std::size_t i = 0; i < kernels.size(); ++i) {
    FieldKernel& kernel = kernels[i];
    if (!(kernel.position_m.cwiseAbs().maxCoeff() < most_m))
      return Error{
          ErrorCode::kInvalidArgument,
          fmt::format(
              "a point lies more than {:f} m from the origin, too far for cells of this size",
              most_m)};
    spread(kernel, spacings[i], options.support_spacings, field.cell_m_);
    field.reach_m_ = std::max(field.reach_m_, kernel.radius_m);
  }
  field.sort_into_bins(std::move(kernels));
  return field;
}

void SurfelField::sort_into_bins(std::vector<FieldKernel> kernels) {
  std::vector<std::uint64_t> keys(kernels.size());
  for (std::size_t i = 0; i < kernels.size(); ++i) keys[i] = key_of(bin_of(kernels[i].position_m));
  std::vector<std::uint32_t> order(kernels.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&keys](std::uint32_t a, std::uint32_t b) { return keys[a] < keys[b]; });
  kernels_.reserve(kernels.size());
  for (const std::uint32_t i : order) {
    const auto at = static_cast<std::uint32_t>(kernels_.size());
    kernels_.push_back(kernels[i]);
    const auto [range, is_new] = range_by_bin_.try_emplace(keys[i], Range{at, at});
    if (is_new) bins_.push_back(bin_of(kernels[i].position_m));
    range->second.last = at + 1;
  }
}

Eigen::Vector3i SurfelField::bin_of(const Eigen::Vector3f& point_m) const {
  return (point_m.cast<double>() / (cell_m_ * kBinCells)).array().floor().cast<int>();
}

std::span<const FieldKernel> SurfelField::bin(const Eigen::Vector3i& index) const {
  const auto range = range_by_bin_.find(key_of(index));
  if (range == range_by_bin_.end()) return {};
  return std::span(kernels_).subspan(range->second.first, range->second.last - range->second.first);
}

FieldWindow::FieldWindow(const SurfelField& field, const Eigen::Vector3i& first_cell,
                         const Eigen::Vector3i& last_cell)
    : field_(field) {
  const Eigen::Vector3f reach_m = Eigen::Vector3f::Constant(field.reach_m());
  const auto corner_m = [&field](const Eigen::Vector3i& cell) -> Eigen::Vector3f {
    return (cell.cast<double>() * field.cell_m()).cast<float>();
  };
  first_bin_ = field.bin_of(corner_m(first_cell) - reach_m);
  bin_counts_ = field.bin_of(corner_m(last_cell) + reach_m) - first_bin_ + Eigen::Vector3i::Ones();
  bins_.reserve(static_cast<std::size_t>(bin_counts_.prod()));
  for (int z = 0; z < bin_counts_.z(); ++z)
    for (int y = 0; y < bin_counts_.y(); ++y)
      for (int x = 0; x < bin_counts_.x(); ++x) {
        bins_.push_back(field.bin(first_bin_ + Eigen::Vector3i(x, y, z)));
        kernel_count_ += bins_.back().size();
      }
  const auto box_of = [](int cell) {
    return cell >= 0 ? cell / kBoxCells : -((kBoxCells - 1 - cell) / kBoxCells);
  };
  first_box_ = first_cell.unaryExpr(box_of);
  box_counts_ = last_cell.unaryExpr(box_of) - first_box_ + Eigen::Vector3i::Ones();
  reaching_.resize(static_cast<std::size_t>(box_counts_.prod()));
}

void FieldWindow::add_if_near(const FieldKernel& kernel, const Eigen::Vector3f& point_m) {
  const Eigen::Vector3f from_kernel_m = point_m - kernel.position_m;
  const float distance2 = from_kernel_m.squaredNorm();
  if (!(distance2 < kernel.radius_m * kernel.radius_m)) return;
  const float s = 1 - std::sqrt(distance2) / kernel.radius_m;
  near_.push_back({&kernel, from_kernel_m, kernel.weight * s * s * s});
}

const std::vector<const FieldKernel*>& FieldWindow::reaching(const Eigen::Vector3i& box) {
  Reaching& reaching = reaching_[static_cast<std::size_t>(
      (box.z() * box_counts_.y() + box.y()) * box_counts_.x() + box.x())];
  if (std::exchange(reaching.is_made, true)) return reaching.kernels;
  // Slightly wider, so that rounding loses no kernel.
  const double spare_m = 0.01 * field_.cell_m();
  const auto corner_m = [&](const Eigen::Vector3i& at, double beyond_m) -> Eigen::Vector3f {
    return ((first_box_ + at).cast<double>() * (kBoxCells * field_.cell_m()) +
            Eigen::Vector3d::Constant(beyond_m))
        .cast<float>();
  };
  const Eigen::Vector3f low_m = corner_m(box, -spare_m),
                        high_m = corner_m(box + Eigen::Vector3i::Ones(), spare_m);
  const Eigen::Vector3f reach_m = Eigen::Vector3f::Constant(field_.reach_m());
  const Eigen::Vector3i first = (field_.bin_of(low_m - reach_m) - first_bin_).cwiseMax(0);
  const Eigen::Vector3i last = (field_.bin_of(high_m + reach_m) - first_bin_)
                                   .cwiseMin(bin_counts_ - Eigen::Vector3i::Ones());
  for (int z = first.z(); z <= last.z(); ++z)
    for (int y = first.y(); y <= last.y(); ++y)
      for (int x = first.x(); x <= last.x(); ++x)
        for (const FieldKernel& kernel :
             bins_[static_cast<std::size_t>((z * bin_counts_.y() + y) * bin_counts_.x() + x)]) {
          const Eigen::Vector3f nearest_m = kernel.position_m.cwiseMax(low_m).cwiseMin(high_m);
          if ((nearest_m - kernel.position_m).squaredNorm() < kernel.radius_m * kernel.radius_m)
            reaching.kernels.push_back(&kernel);
        }
  return reaching.kernels;
}

void FieldWindow::find_near(const Eigen::Vector3f& point_m) {
  near_.clear();
  const Eigen::Vector3i box =
      (point_m.cast<double>() / (kBoxCells * field_.cell_m())).array().floor().cast<int>() -
      first_box_.array();
  if ((box.array() >= 0).all() && (box.array() < box_counts_.array()).all()) {
    for (const FieldKernel* kernel : reaching(box)) add_if_near(*kernel, point_m);
  } else {
    for_each_kernel([&](const FieldKernel& kernel) { add_if_near(kernel, point_m); });
  }
}

// Computes the field of the paper: the value divided by the sum of weights, and the direction of
// the mean normal.
void FieldWindow::begin(FieldSample& sample) const {
  float weights = 0, distances_m = 0, color_weights = 0,
        nearest2_m2 = std::numeric_limits<float>::max();
  Eigen::Vector3f normals = Eigen::Vector3f::Zero(), aside = Eigen::Vector3f::Zero();
  for (const Near& near : near_) {
    const FieldKernel& kernel = *near.kernel;
    weights += near.weight;
    distances_m += near.weight * kernel.normal.dot(near.from_kernel_m);
    normals += near.weight * kernel.normal;
    const float area = near.weight / kernel.weight * kernel.area;
    aside -= area / kernel.radius_m * near.from_kernel_m;
    sample.coverage += area;
    if (const float distance2_m2 = near.from_kernel_m.squaredNorm(); distance2_m2 < nearest2_m2) {
      nearest2_m2 = distance2_m2;
      sample.nearest_support_m = kernel.radius_m;
    }
    const float color_weight = near.weight * near.weight;
    color_weights += color_weight;
    sample.color += color_weight * Eigen::Vector3f(kernel.color.r, kernel.color.g, kernel.color.b);
    sample.confidence_eighths += color_weight * static_cast<float>(kernel.confidence_eighths);
  }
  sample.nearest_m = std::sqrt(nearest2_m2);
  sample.value_m = distances_m / weights;
  const float length = normals.norm();
  sample.normal = length > 0 ? Eigen::Vector3f(normals / length) : Eigen::Vector3f::UnitZ();
  aside /= sample.coverage;
  sample.lean = (aside - aside.dot(sample.normal) * sample.normal).norm();
  sample.color /= color_weights;
  sample.confidence_eighths /= color_weights;
}

// Robust implicit moving least squares (Oztireli et al. 2009): kernels whose plane or normal
// contradicts the others have less weight, so that each side of a sharp edge keeps its own surface.
// Planes use the mean of both normals, which removes the bias on curved surfaces (core/math/hrbf.h,
// correct_bias).
void FieldWindow::keep_to_one_sheet(FieldSample& sample) const {
  const float by_normal = field_.options().keep_edges ? 1 / (kNormalSpread * kNormalSpread) : 0;
  for (int step = 0; step < kSheetSteps; ++step) {
    float weights = 0, distances_m = 0;
    Eigen::Vector3f normals = Eigen::Vector3f::Zero();
    for (const Near& near : near_) {
      const FieldKernel& kernel = *near.kernel;
      const Eigen::Vector3f between = kernel.normal + sample.normal;
      const float along = between.dot(sample.normal);
      if (!(along > 0.1f)) continue;  // it faces the other way
      const float distance_m = between.dot(near.from_kernel_m) / along;
      const float weight =
          near.weight * std::exp(-by_normal * (kernel.normal - sample.normal).squaredNorm());
      weights += weight;
      distances_m += weight * distance_m;
      normals += weight * kernel.normal;
    }
    const float length = normals.norm();
    if (!(weights > 0) || !(length > 0)) return;
    sample.value_m = distances_m / weights;
    sample.normal = normals / length;
  }
}

FieldSample FieldWindow::sample(const Eigen::Vector3f& point_m) {
  find_near(point_m);
  FieldSample sample;
  if (near_.empty()) return sample;
  sample.kernel_count = static_cast<int>(near_.size());
  begin(sample);
  keep_to_one_sheet(sample);
  return sample;
}

}  // namespace hermite::mesh
