#include "core/frame/repaired_depth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "core/frame/sensor_noise.h"

namespace hermite::frame {

namespace {

constexpr int kFillPasses = 2;

// Of the difference of two independent depths, in standard deviations of one: 99.5 % differ less.
constexpr double kNoiseSigmas = 4;

// A removed depth has at least this many neighbours with depth; a single other one proves nothing.
constexpr int kLeastNeighbours = 2;

using Depth = std::uint16_t;
using Row = std::vector<Depth>;

// The rows above, at and below the one in work, as they were before this pass.
using Rows = std::array<Row, 3>;

class Agreement {
 public:
  Agreement(double depth_units_per_metre, const FrameOptions& options)
      : units_per_metre_(depth_units_per_metre),
        options_(options),
        gate_(static_cast<int>(0.5 * options.depth_gate_m * depth_units_per_metre)) {}

  // Whatever the noise.
  bool is_clear(Depth a, Depth b) const { return std::abs(a - b) <= gate_; }

  bool operator()(Depth a, Depth b) const {
    if (is_clear(a, b)) return true;
    const int apart = std::abs(a - b);
    const double sigma_m = model_deviation_m(options_, std::min(a, b) / units_per_metre_);
    return apart <= kNoiseSigmas * sigma_m * units_per_metre_;
  }

 private:
  const double units_per_metre_;
  const FrameOptions& options_;
  const int gate_;
};

// Calls change(rows, x), which returns the new depth of the middle row, for each pixel that is not
// on the border. Returns true if any depth changed.
template <class Change>
bool pass_over(DepthImage& depth, const Change& change) {
  const auto width = static_cast<std::size_t>(depth.width);
  const auto row_of = [&](int y) { return Row(&depth.at(0, y), &depth.at(0, y) + width); };
  bool is_changed = false;
  Rows rows = {row_of(0), row_of(1), row_of(2)};
  for (int y = 1; y + 1 < depth.height; ++y) {
    for (std::size_t x = 1; x + 1 < width; ++x) {
      const Depth before = rows[1][x], after = change(rows, x);
      if (after == before) continue;
      depth.at(static_cast<int>(x), y) = after;
      is_changed = true;
    }
    std::rotate(rows.begin(), rows.begin() + 1, rows.end());
    if (y + 2 < depth.height) std::copy_n(&depth.at(0, y + 2), width, rows[2].begin());
  }
  return is_changed;
}

// Neighbours in the order of opposite pairs.
std::array<Depth, 8> neighbours(const Rows& rows, std::size_t x) {
  return {rows[1][x - 1], rows[1][x + 1], rows[0][x],     rows[2][x],
          rows[0][x - 1], rows[2][x + 1], rows[0][x + 1], rows[2][x - 1]};
}

bool is_lone(const Rows& rows, std::size_t x, const Agreement& agree) {
  // Nearly all pixels are like the one before.
  if (rows[1][x - 1] != 0 && agree.is_clear(rows[1][x], rows[1][x - 1])) return false;
  int count = 0;
  for (const Depth other : neighbours(rows, x)) {
    if (other == 0) continue;
    if (agree(rows[1][x], other)) return false;
    ++count;
  }
  return count >= kLeastNeighbours;
}

// The reciprocal of the mean inverse, rounded.
Depth between(std::uint64_t a, std::uint64_t b) {
  return static_cast<Depth>((2 * a * b + (a + b) / 2) / (a + b));
}

// Returns 0 if no pair of neighbours encloses the pixel.
Depth filling(const Rows& rows, std::size_t x, const Agreement& agree) {
  const std::array<Depth, 8> around = neighbours(rows, x);
  int closest = 0x10000;
  Depth depth = 0;
  for (std::size_t i = 0; i < around.size(); i += 2) {
    const Depth a = around[i], b = around[i + 1];
    if (a == 0 || b == 0 || std::abs(a - b) >= closest || !agree(a, b)) continue;
    closest = std::abs(a - b);
    depth = between(a, b);
  }
  return depth;
}

}  // namespace

bool repair_depth(DepthImage& depth, double depth_units_per_metre, const FrameOptions& options) {
  if (depth.width < 3 || depth.height < 3) return false;
  const Agreement agree(depth_units_per_metre, options);
  bool is_changed = pass_over(depth, [&](const Rows& rows, std::size_t x) -> Depth {
    return rows[1][x] == 0 || is_lone(rows, x, agree) ? Depth{0} : rows[1][x];
  });
  for (int pass = 0; pass < kFillPasses; ++pass)
    is_changed |= pass_over(depth, [&](const Rows& rows, std::size_t x) -> Depth {
      return rows[1][x] != 0 ? rows[1][x] : filling(rows, x, agree);
    });
  return is_changed;
}

}  // namespace hermite::frame
