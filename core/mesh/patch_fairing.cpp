#include "core/mesh/patch_fairing.h"

#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>

namespace hermite::mesh {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Sparse = Eigen::SparseMatrix<double>;

// Bounds for half the cotangent of an angle. It is kept positive, so that inner values stay within
// the range of the boundary for any triangles.
constexpr double kLeastWeight = 0.02, kMostWeight = 10;

double cotangent_weight(const Vector3d& corner_m, const Vector3d& a_m, const Vector3d& b_m) {
  const Vector3d to_a = a_m - corner_m, to_b = b_m - corner_m;
  const double sine = to_a.cross(to_b).norm(), cosine = to_a.dot(to_b);
  return sine > 0 ? std::clamp(0.5 * cosine / sine, kLeastWeight, kMostWeight) : kLeastWeight;
}

// Sums over triangles, of all points or only of the patch: entries of the Laplacian, and a third of
// each area per vertex.
class LaplacianSums {
 public:
  explicit LaplacianSums(std::size_t count) : areas_m2_(count, 0.0) {}

  template <class Position>
  void add(const std::vector<output::TriangleCorners>& triangles, const Position& position_m) {
    for (const output::TriangleCorners& t : triangles) {
      const std::array<Vector3d, 3> p = {position_m(t[0]), position_m(t[1]), position_m(t[2])};
      const double third_m2 = (p[1] - p[0]).cross(p[2] - p[0]).norm() / 6;
      for (std::size_t k = 0; k < 3; ++k) {
        areas_m2_[t[k]] += third_m2;
        const auto a = static_cast<int>(t[(k + 1) % 3]), b = static_cast<int>(t[(k + 2) % 3]);
        const double weight = cotangent_weight(p[k], p[(k + 1) % 3], p[(k + 2) % 3]);
        entries_.emplace_back(a, b, weight);
        entries_.emplace_back(b, a, weight);
        entries_.emplace_back(a, a, -weight);
        entries_.emplace_back(b, b, -weight);
      }
    }
  }

  Sparse matrix() const {
    const auto count = static_cast<Index>(areas_m2_.size());
    Sparse sums(count, count);
    sums.setFromTriplets(entries_.begin(), entries_.end());
    return sums;
  }
  // Returns the inverse areas, relative to their mean.
  Eigen::VectorXd inverse_areas() const {
    double mean = 0;
    for (const double area_m2 : areas_m2_) mean += area_m2 / static_cast<double>(areas_m2_.size());
    Eigen::VectorXd inverse(static_cast<Index>(areas_m2_.size()));
    for (std::size_t i = 0; i < areas_m2_.size(); ++i)
      inverse[static_cast<Index>(i)] = mean > 0 ? mean / std::max(areas_m2_[i], 1e-3 * mean) : 1;
    return inverse;
  }

 private:
  std::vector<double> areas_m2_;
  std::vector<Eigen::Triplet<double>> entries_;
};

// `matrix` is symmetric and positive definite.
bool solve(const Sparse& matrix, const MatrixXd& wanted, MatrixXd& values) {
  const Eigen::SimplicialLDLT<Sparse> solver(matrix);
  if (solver.info() != Eigen::Success) return false;
  values = solver.solve(wanted);
  return solver.info() == Eigen::Success && values.allFinite();
}

}  // namespace

bool bend_least(Patch& patch, const PatchSurroundings& around) {
  const auto border = static_cast<Index>(patch.border_count),
             own = static_cast<Index>(patch.points_m.size());
  const Index all = own + static_cast<Index>(around.points_m.size()), inner = own - border;
  if (inner == 0) return true;
  const auto position_m = [&](std::size_t i) -> const Vector3d& {
    return i < patch.points_m.size() ? patch.points_m[i]
                                     : around.points_m[i - patch.points_m.size()];
  };
  LaplacianSums sums(static_cast<std::size_t>(all));
  sums.add(patch.triangles, position_m);
  sums.add(around.triangles, position_m);
  MatrixXd fixed_m = MatrixXd::Zero(all, 3);
  for (Index i = 0; i < all; ++i)
    if (i < border || i >= own)
      fixed_m.row(i) = position_m(static_cast<std::size_t>(i)).transpose();
  const Eigen::VectorXd inverse_areas = sums.inverse_areas();
  // The neighbourhoods of outer points are incomplete.
  const Sparse laplacian = Sparse(sums.matrix().topRows(own));
  const Sparse weighted = Sparse(inverse_areas.head(own).asDiagonal() * laplacian);
  const Sparse to_inner = Sparse(laplacian.middleCols(border, inner)),
               weighted_to_inner = Sparse(weighted.middleCols(border, inner));
  MatrixXd values_m;
  if (!solve(Sparse(weighted_to_inner.transpose() * to_inner),
             -(weighted_to_inner.transpose() * (laplacian * fixed_m)), values_m))
    return false;
  for (Index i = 0; i < inner; ++i)
    patch.points_m[static_cast<std::size_t>(border + i)] = values_m.row(i).transpose();
  return true;
}

MatrixXd spread_from_border(const Patch& patch, const MatrixXd& border) {
  const auto count = static_cast<Index>(patch.points_m.size()),
             outer = static_cast<Index>(patch.border_count), inner = count - outer;
  MatrixXd values(count, border.cols());
  values.topRows(outer) = border;
  if (inner == 0) return values;
  LaplacianSums sums(patch.points_m.size());
  sums.add(patch.triangles, [&](std::size_t i) -> const Vector3d& { return patch.points_m[i]; });
  const Sparse laplacian = sums.matrix();
  const Sparse rows = Sparse(laplacian.middleCols(outer, inner).transpose());  // it is symmetric
  MatrixXd found;
  if (!solve(Sparse(-rows.middleCols(outer, inner)), rows.middleCols(0, outer) * border, found))
    return {};
  values.bottomRows(inner) = found;
  return values;
}

}  // namespace hermite::mesh
