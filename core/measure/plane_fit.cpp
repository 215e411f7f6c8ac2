#include "core/measure/plane_fit.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "core/math/principal_axes.h"

namespace hermite::measure {

namespace {

// The first reach is covered with certainty by the plane of the place; each is iterated twice,
// because the plane turns.
constexpr std::array kReaches_m{0.08, 0.125, 0.25, 0.5, kPlaneReach_m};
constexpr int kRoundsOfReach = 2;
constexpr int kCellsToSide = 21;  // to either side of the place's cell
constexpr int kCellsAcross = 2 * kCellsToSide + 1;
// Least cosines between normals of surfels and that of the plane, and that of the place, which is
// not yet the plane's.
constexpr double kMemberCosine = 0.9, kCandidateCosine = 0.8;
// Surfels within this many standard deviations of the plane belong to it, within these bounds: the
// noise of a wall at 4 m, and never the edge of a shelf.
constexpr double kGateDeviations = 3, kLeastGate_m = 0.003, kMostGate_m = 0.012;
// A plane needs some decimetres of surface; less does not determine its direction.
constexpr int kLeastCells = 6;
constexpr double kLeastSpread_m = 0.025;
// Where the surface bends away or has steps, many more surfels lie within a gate that is wider by
// this factor.
constexpr double kWiderGate = 3, kMostBeside = 1.5;

// Factor for the unevenness of cells, and the uncertainty that remains if all their means lie in
// the plane. Measured.
constexpr double kOfUnevenness = 3.5, kLeastHeightSigma_m = 0.0003, kLeastSlopeSigma_rad = 0.0007;

struct FlatPoint {
  Eigen::Vector3d position_m;
  double weight = 0;  // from its confidence
};

struct FlatFit {
  Eigen::Vector3d centre_m, normal;
  std::array<Eigen::Vector3d, 2> axes;
  std::array<double, 2> spread_m{};
  double deviation_m = 0;
};

FlatFit flat_fit_of(const std::vector<FlatPoint>& points, const Eigen::Vector3d& normal) {
  std::vector<Eigen::Vector3d> positions_m;
  std::vector<double> weights;
  for (const FlatPoint& point : points) {
    positions_m.push_back(point.position_m);
    weights.push_back(point.weight);
  }
  const PrincipalAxes axes = principal_axes(positions_m, weights);
  return {axes.centre,
          facing(axes.direction[2], normal),
          {axes.direction[0], axes.direction[1]},
          {axes.deviation[0], axes.deviation[1]},
          axes.deviation[2]};
}

// A grid of cells on a plane around a place.
class Cells {
 public:
  Cells(const Eigen::Vector3d& origin, const Eigen::Vector3d& normal)
      : origin_(origin), along_(normal.unitOrthogonal()), across_(normal.cross(along_)) {}

  std::size_t cell_of(const Eigen::Vector3d& position) const {
    const Eigen::Vector3d off = position - origin_;
    return index_of(axis_of(off.dot(along_)), axis_of(off.dot(across_)));
  }
  void fill(const Eigen::Vector3d& position) { filled_[cell_of(position)] = true; }

  // Returns the cells that are connected with that of the origin, which is included.
  std::vector<bool> connected() const {
    std::vector<bool> reached(filled_.size());
    std::vector<std::size_t> next{index_of(kCellsToSide, kCellsToSide)};
    reached[next.front()] = true;
    while (!next.empty()) {
      const int row = static_cast<int>(next.back()) / kCellsAcross,
                column = static_cast<int>(next.back()) % kCellsAcross;
      next.pop_back();
      for (const auto& [down, right] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
        if (row + down < 0 || row + down >= kCellsAcross || column + right < 0 ||
            column + right >= kCellsAcross)
          continue;
        const std::size_t beside = index_of(column + right, row + down);
        if (reached[beside] || !filled_[beside]) continue;
        reached[beside] = true;
        next.push_back(beside);
      }
    }
    return reached;
  }

 private:
  static int axis_of(double off_m) {
    return std::clamp(static_cast<int>(std::lround(off_m / kPlaneCell_m)) + kCellsToSide, 0,
                      kCellsAcross - 1);
  }
  static std::size_t index_of(int column, int row) {
    return static_cast<std::size_t>(row * kCellsAcross + column);
  }

  Eigen::Vector3d origin_, along_, across_;
  std::vector<bool> filled_ = std::vector<bool>(kCellsAcross * kCellsAcross);
};

// Returns the points within `reach_m` that are connected with the place.
std::vector<FlatPoint> members_of(const FlatFit& plane,
                                  const std::vector<output::CloudPoint>& points,
                                  const Eigen::Vector3d& place, double reach_m, double widen = 1) {
  const double gate_m =
      widen * std::clamp(kGateDeviations * plane.deviation_m, kLeastGate_m, kMostGate_m);
  Cells cells(place, plane.normal);
  std::vector<FlatPoint> near;
  for (const output::CloudPoint& point : points) {
    const Eigen::Vector3d position = point.position_m.cast<double>();
    if ((position - place).norm() > reach_m ||
        std::abs(plane.normal.dot(position - plane.centre_m)) > gate_m)
      continue;
    if (point.normal.cast<double>().dot(plane.normal) < kMemberCosine) continue;
    near.push_back({position, std::sqrt(double{point.confidence})});
    cells.fill(position);
  }
  const std::vector<bool> connected = cells.connected();
  std::erase_if(
      near, [&](const FlatPoint& point) { return !connected[cells.cell_of(point.position_m)]; });
  return near;
}

struct Evenness {
  double unevenness_m = 0;
  int cell_count = 0;
};

Evenness evenness_of(const FlatFit& plane, const std::vector<FlatPoint>& members,
                     const Eigen::Vector3d& place) {
  const Cells cells(place, plane.normal);
  struct Sum {
    double weight = 0, off_m = 0;
  };
  std::vector<Sum> sums(kCellsAcross * kCellsAcross);
  for (const FlatPoint& point : members) {
    Sum& sum = sums[cells.cell_of(point.position_m)];
    sum.weight += point.weight;
    sum.off_m += point.weight * plane.normal.dot(point.position_m - plane.centre_m);
  }
  Evenness evenness;
  double squares = 0;
  for (const Sum& sum : sums) {
    if (!(sum.weight > 0)) continue;
    ++evenness.cell_count;
    squares += std::pow(sum.off_m / sum.weight, 2);
  }
  evenness.unevenness_m = std::sqrt(squares / std::max(1, evenness.cell_count));
  return evenness;
}

MeasuredPlane measured_plane(const FlatFit& fit, const Evenness& evenness,
                             const MeasuredPlace& place) {
  MeasuredPlane plane;
  plane.place = place;
  plane.place.normal = fit.normal;
  plane.place.position_m =
      place.position_m - fit.normal * fit.normal.dot(place.position_m - fit.centre_m);
  plane.centre_m = fit.centre_m;
  plane.axes = fit.axes;
  plane.spread_m = fit.spread_m;
  plane.unevenness_m = evenness.unevenness_m;
  plane.cell_count = evenness.cell_count;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const PlaneErrors errors =
        plane_errors_of(evenness.unevenness_m, evenness.cell_count, fit.spread_m[axis]);
    plane.height_sigma_m = errors.height_sigma_m;
    plane.slope_sigma[axis] = errors.slope_sigma;
  }
  plane.place.normal_sigma_m = plane.sigma_at_m(plane.place.position_m);
  return plane;
}

}  // namespace

PlaneErrors plane_errors_of(double unevenness_m, double cell_count, double spread_m) {
  const double mean_sigma_m = kOfUnevenness * unevenness_m / std::sqrt(cell_count);
  return {std::hypot(mean_sigma_m, kLeastHeightSigma_m),
          std::hypot(mean_sigma_m / spread_m, kLeastSlopeSigma_rad)};
}

double MeasuredPlane::sigma_at_m(const Eigen::Vector3d& point) const {
  return std::hypot(height_sigma_m, slope_sigma[0] * axes[0].dot(point - centre_m),
                    slope_sigma[1] * axes[1].dot(point - centre_m));
}

bool may_be_of_plane(const output::CloudPoint& point, const MeasuredPlace& place) {
  const Eigen::Vector3d off = point.position_m.cast<double>() - place.position_m;
  return off.squaredNorm() <= kPlaneReach_m * kPlaneReach_m &&
         std::abs(off.dot(place.normal)) <= kPlaneBand_m &&
         point.normal.cast<double>().dot(place.normal) >= kCandidateCosine && point.confidence > 0;
}

Result<MeasuredPlane> fit_plane(std::span<const output::CloudPoint> points,
                                const MeasuredPlace& place, bool one_submap) {
  std::vector<output::CloudPoint> candidates;
  for (const output::CloudPoint& point : points)
    if (may_be_of_plane(point, place) && (!one_submap || point.submap == place.submap))
      candidates.push_back(point);
  FlatFit fit{place.position_m, place.normal, {}, {}, kLeastGate_m / kGateDeviations};
  std::vector<FlatPoint> members;
  for (const double reach_m : kReaches_m)
    for (int round = 0; round < kRoundsOfReach; ++round) {
      members = members_of(fit, candidates, place.position_m, reach_m);
      if (members.size() < 3)
        return Error{ErrorCode::kNotFound, "the surface there is too broken to be a plane"};
      fit = flat_fit_of(members, fit.normal);
    }
  const Evenness evenness = evenness_of(fit, members, place.position_m);
  if (evenness.cell_count < kLeastCells || fit.spread_m[1] < kLeastSpread_m)
    return Error{ErrorCode::kNotFound,
                 "the surface there is too small or too bent for a plane: one needs a decimetre of "
                 "it to each side"};
  const std::size_t beside =
      members_of(fit, candidates, place.position_m, kPlaneReach_m, kWiderGate).size();
  if (static_cast<double>(beside) > kMostBeside * static_cast<double>(members.size()))
    return Error{ErrorCode::kNotFound, "the surface there bends or has steps: it is no plane"};
  return measured_plane(fit, evenness, place);
}

}  // namespace hermite::measure
