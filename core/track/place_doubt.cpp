#include "core/track/place_doubt.h"

#include <algorithm>
#include <cmath>

#include "core/track/pose_uncertainty.h"

namespace hermite::track {

namespace {

// So far tracking allows between two frames (track.max_step_m).
constexpr double kTracked_m = 0.3;

// A person walks 1.2 to 1.4 m/s, slower with a camera in the hands; in haste 2.
constexpr double kWalk_m_per_s = 1, kHaste_m_per_s = 2;

// Where less is known than the stretches above, nearly all of it must be seen again: a small object
// on a table is complete.
constexpr double kNearlyAll = 0.8;

// Farther away would be another building.
constexpr double kFarthest_m = 10;

// Desks, doors, windows and shelves are less wide. Whole rooms that are alike are not told apart.
constexpr double kSeries_m = 3;

double way_m(const SightGap& gap) { return std::max(kWalk_m_per_s * gap.unseen_s, gap.jump_m); }

}  // namespace

bool PlaceDoubt::is_cast_by(const SightGap& gap) { return way_m(gap) > kTracked_m; }

double PlaceDoubt::reach_m(double unseen_s) { return kTracked_m + kHaste_m_per_s * unseen_s; }

void PlaceDoubt::count_gap(const SightGap& gap, double known_m) {
  elsewhere_m_ = std::min(kFarthest_m, elsewhere_m_ + way_m(gap));
  needed_m_ = std::min({elsewhere_m_, kSeries_m, kNearlyAll * known_m});
  seen_.setEmpty();
}

void PlaceDoubt::observe(const Eigen::AlignedBox3d& known, bool is_distinctive) {
  if (elsewhere_m_ == 0) return;
  seen_.extend(known);
  if (is_distinctive && !seen_.isEmpty() && seen_.sizes().maxCoeff() >= needed_m_) elsewhere_m_ = 0;
}

Matrix6d PlaceDoubt::second_moment() const {
  Matrix6d result = Matrix6d::Zero();
  if (elsewhere_m_ == 0) return result;
  result.topLeftCorner<3, 3>().diagonal().setConstant(2 * elsewhere_m_ * elsewhere_m_ / kRegion99);
  result.bottomRightCorner<3, 3>().diagonal().setConstant(2 * M_PI * M_PI / kRegion99);
  return result;
}

void PlaceDoubt::save(ByteWriter& bytes) const {
  bytes.number(elsewhere_m_);
  bytes.number(needed_m_);
  bytes.numbers(seen_.min().data(), 3);
  bytes.numbers(seen_.max().data(), 3);
}

void PlaceDoubt::restore(ByteReader& bytes) {
  bytes.number(elsewhere_m_);
  bytes.number(needed_m_);
  bytes.numbers(seen_.min().data(), 3);
  bytes.numbers(seen_.max().data(), 3);
  bytes.require(elsewhere_m_ >= 0 && elsewhere_m_ <= kFarthest_m && needed_m_ >= 0 &&
                    needed_m_ <= kSeries_m && !seen_.min().hasNaN() && !seen_.max().hasNaN(),
                "the doubt about the camera's place");
}

}  // namespace hermite::track
