// The implicit surface of a finished cloud: the closed-form Hermite RBF (core/math/hrbf.h; paper
// Eq. 2 and 3) of all its surfels, in the world frame. Each surfel is a kernel whose support radius
// follows the distance to its neighbours, so that the surface is closed between surfels and ends
// where they end.
//
// Normals point to the side that the surface was seen from; the value is positive there and
// negative behind the surface. Built once; then const and thread-safe.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "core/base/image.h"
#include "core/base/result.h"
#include "core/output/cloud.h"

namespace hermite::mesh {

// The cell size of the grid that contours the field; supports and bins are multiples of it.
inline constexpr double kLeastCell_m = 0.002, kMostCell_m = 0.1;
// Cell indices have 20 bits per axis.
inline constexpr int kMostCell = 1 << 19;

struct FieldOptions {
  // 0: the median distance of neighbouring surfels, clamped to 5 mm to 4 cm.
  double cell_m = 0;
  // Support radius of a kernel, as a multiple of the distance to its neighbours.
  double support_spacings = 3;
  // Surfels across an edge count for less (robust implicit moving least squares).
  bool keep_edges = true;
};

struct FieldKernel {
  Eigen::Vector3f position_m = Eigen::Vector3f::Zero();
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();
  float radius_m = 0;  // of the support
  float weight = 0;    // 1 / radius^2
  // Area that the surfel represents, scaled so that the kernels in the middle of a plane add up
  // to 1.
  float area = 0;
  Rgb8 color;
  std::uint8_t confidence_eighths = 0;  // only of a live surface; not capped as the weight is
};

// Kernels are weighted by the confidence of their surfels, up to this limit: three times the
// confidence of a stable surfel (map.stable_confidence). More would not help, and old surfels must
// not outweigh all others around them.
inline constexpr float kMostConfidence = 10;

// Sets radius, weight and area of a kernel from the distance to its neighbours. On entry `weight`
// holds the confidence.
void spread(FieldKernel& kernel, float spacing_m, double support_spacings, double cell_m);

// The field at a point. `value_m` and `normal` are those of the nearest sheet of surface.
struct FieldSample {
  // Signed distance to the surface, from the tangent planes of the kernels.
  float value_m = 0;
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  // unit
  // 1: within a surface, 1/2: on its border, 0: nothing is near.
  float coverage = 0;
  // Offset of the centroid of the kernels, in supports: 0 within a surface, 0.2 on its border.
  float lean = 0;
  Eigen::Vector3f color = Eigen::Vector3f::Zero();  // 0 to 255
  // Confidence of the kernels, with the weights of the colour.
  float confidence_eighths = 0;
  // Distance to the nearest kernel, and the radius of its support.
  float nearest_m = 0, nearest_support_m = 0;
  int kernel_count = 0;  // 0: no other member is set
};

class SurfelField {
 public:
  // Returns the field. Ignores points whose position or normal is not finite, whose normal is zero,
  // or that have no confidence while others do. kInvalidArgument when no point is left, for a cell
  // outside kLeastCell_m to kMostCell_m, and for an extent beyond the range of the cell index. A
  // cloud that is moved in is freed as soon as its kernels are made.
  static Result<SurfelField> create(const output::Cloud& cloud, const FieldOptions& options);
  static Result<SurfelField> create(output::Cloud&& cloud, const FieldOptions& options);

  // Makes a field from existing kernels; their order within a bin is kept. CHECK: their positions
  // are within kMostCell cells.
  static SurfelField of(std::vector<FieldKernel> kernels, double cell_m);

  double cell_m() const { return cell_m_; }
  float reach_m() const { return reach_m_; }  // the largest support radius
  std::span<const FieldKernel> kernels() const { return kernels_; }
  std::size_t rejected_count() const { return rejected_count_; }

  // Length of a bin's edge in cells.
  static constexpr int kBinCells = 4;

  // Returns the kernels of bin (x, y, z), which spans kBinCells cells from x * kBinCells on; may be
  // empty.
  std::span<const FieldKernel> bin(const Eigen::Vector3i& index) const;
  Eigen::Vector3i bin_of(const Eigen::Vector3f& point_m) const;

  // Returns the bins that contain kernels, ordered by z, y, x.
  std::span<const Eigen::Vector3i> bins() const { return bins_; }

  const FieldOptions& options() const { return options_; }

 private:
  struct Range {
    std::uint32_t first = 0, last = 0;
  };
  SurfelField() = default;
  static Result<SurfelField> of_kernels(std::vector<FieldKernel> kernels, std::size_t point_count,
                                        const FieldOptions& options);
  void sort_into_bins(std::vector<FieldKernel> kernels);

  FieldOptions options_;
  double cell_m_ = 0;
  float reach_m_ = 0;
  std::size_t rejected_count_ = 0;
  std::vector<FieldKernel> kernels_;  // sorted by bin, within a bin in the order of the cloud
  std::vector<Eigen::Vector3i> bins_;
  std::unordered_map<std::uint64_t, Range> range_by_bin_;
};

// A box of the field, prepared for many evaluations. The value at a point does not depend on the
// box.
class FieldWindow {
 public:
  // Points within the cells from `first_cell` up to, not including, `last_cell` may be evaluated.
  FieldWindow(const SurfelField& field, const Eigen::Vector3i& first_cell,
              const Eigen::Vector3i& last_cell);

  bool empty() const { return kernel_count_ == 0; }

  // Calls use(kernel) for each kernel whose support could reach a point of the box, in the field's
  // order.
  template <class Use>
  void for_each_kernel(const Use& use) const {
    for (const std::span<const FieldKernel>& bin : bins_)
      for (const FieldKernel& kernel : bin) use(kernel);
  }

  FieldSample sample(const Eigen::Vector3f& point_m);

 private:
  // A kernel relative to the point that is evaluated.
  struct Near {
    const FieldKernel* kernel = nullptr;
    Eigen::Vector3f from_kernel_m = Eigen::Vector3f::Zero();
    float weight = 0;
  };
  void find_near(const Eigen::Vector3f& point_m);
  void add_if_near(const FieldKernel& kernel, const Eigen::Vector3f& point_m);
  const std::vector<const FieldKernel*>& reaching(const Eigen::Vector3i& box);
  void begin(FieldSample& sample) const;
  void keep_to_one_sheet(FieldSample& sample) const;

  const SurfelField& field_;
  Eigen::Vector3i first_bin_, bin_counts_;
  std::vector<std::span<const FieldKernel>> bins_;  // x runs fastest
  std::size_t kernel_count_ = 0;
  std::vector<Near> near_;  // of the last point

  // Kernels whose support reaches a box of kBoxCells cells, in the field's order; computed when the
  // first point in the box is evaluated.
  static constexpr int kBoxCells = 2;
  struct Reaching {
    bool is_made = false;
    std::vector<const FieldKernel*> kernels;
  };
  Eigen::Vector3i first_box_, box_counts_;
  std::vector<Reaching> reaching_;  // x runs fastest
};

}  // namespace hermite::mesh
