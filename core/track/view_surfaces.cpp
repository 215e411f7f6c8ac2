#include "core/track/view_surfaces.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/frame/frame_options.h"

namespace hermite::track {

namespace {

// Share of the pixels; smaller ones are edges or reflections, or have too few pairs.
constexpr double kLeastSurface = 0.01;

// Two pixels are on one surface if one lies this close to the plane of the other, in standard
// deviations and as a share of their distance, and if the surface does not bend towards the camera
// by more than this angle between them: 30 degrees, four times the noise of a coarse pixel's
// normal.
constexpr double kStep = 3, kSlope = 0.15, kConcaveCosine = 0.87;

// Where surfaces meet, normals turn over up to three coarse pixels, since they are computed over
// windows and averaged over blocks. So no two neighbours may differ by that angle, and pixels this
// far on both sides are compared, too.
constexpr int kEdge_px = 2;

// Numbers of surfaces by pixel, from 1.
using Numbers = std::vector<std::uint32_t>;
constexpr std::uint32_t kNone = 0;

class Segmentation {
 public:
  explicit Segmentation(const frame::CoarseView& view)
      : view_(view), points_(frame::points_of(view)), edges_(concave_edges()) {}

  // Returns the connected surfaces, of any size.
  Numbers surfaces() const {
    Numbers numbers = between_edges();
    add_edges(numbers);
    return numbers;
  }

 private:
  std::vector<bool> concave_edges() const;
  Numbers between_edges() const;
  void add_edges(Numbers& numbers) const;

  // Returns whether the surface bends towards the camera between two pixels that have one.
  bool is_concave(std::size_t from, std::size_t to) const {
    const Eigen::Vector3f &normal = view_.normals[from], &next_normal = view_.normals[to];
    const Eigen::Vector3d way = points_[to] - points_[from];
    return double{normal.dot(next_normal)} <= kConcaveCosine &&
           way.dot((next_normal - normal).cast<double>()) >= 0;
  }
  bool is_continued(std::size_t from, std::size_t to) const {
    const Eigen::Vector3d way = points_[to] - points_[from];
    const double off_m = std::min(std::abs(view_.normals[from].cast<double>().dot(way)),
                                  std::abs(view_.normals[to].cast<double>().dot(way)));
    return off_m <= kStep * frame::kinect_noise_m(points_[from].z()) + kSlope * way.norm() &&
           !is_concave(from, to);
  }
  template <typename Use>
  void for_each_continued(std::size_t from, const Use& use) const {
    const int x = static_cast<int>(from % view_.camera.width),
              y = static_cast<int>(from / view_.camera.width);
    for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
      if (!view_.contains(x + dx, y + dy)) continue;
      const std::size_t to = view_.index(x + dx, y + dy);
      if (view_.depth_m[to] > 0 && is_continued(from, to)) use(to);
    }
  }

  const frame::CoarseView& view_;
  const std::vector<Eigen::Vector3d> points_;
  const std::vector<bool> edges_;  // by pixel: surfaces meet at most kEdge_px away
};

std::vector<bool> Segmentation::concave_edges() const {
  std::vector<bool> edges(view_.size(), false);
  const auto is_between = [this](int x, int y, int dx, int dy) {
    if (!view_.contains(x - dx, y - dy) || !view_.contains(x + dx, y + dy)) return false;
    const std::size_t from = view_.index(x - dx, y - dy), to = view_.index(x + dx, y + dy);
    return view_.depth_m[from] > 0 && view_.depth_m[to] > 0 && is_concave(from, to);
  };
  for (int y = 0; y < static_cast<int>(view_.camera.height); ++y)
    for (int x = 0; x < static_cast<int>(view_.camera.width); ++x)
      for (int reach = 1; reach <= kEdge_px; ++reach)
        if (is_between(x, y, reach, 0) || is_between(x, y, 0, reach))
          edges[view_.index(x, y)] = true;
  return edges;
}

Numbers Segmentation::between_edges() const {
  Numbers numbers(view_.size(), kNone);
  std::uint32_t last = kNone;
  std::vector<std::size_t> region;
  for (std::size_t start = 0; start < view_.size(); ++start) {
    if (numbers[start] != kNone || view_.depth_m[start] <= 0 || edges_[start]) continue;
    numbers[start] = ++last;
    region.assign(1, start);
    for (std::size_t next = 0; next < region.size(); ++next)
      for_each_continued(region[next], [&](std::size_t to) {
        if (numbers[to] != kNone || edges_[to]) return;
        numbers[to] = last;
        region.push_back(to);
      });
  }
  return numbers;
}

// Adds the pixels of edges to surfaces that they continue, equally far on both sides.
void Segmentation::add_edges(Numbers& numbers) const {
  std::vector<std::size_t> numbered;  // nearest to a surface first
  for (std::size_t i = 0; i < numbers.size(); ++i)
    if (numbers[i] != kNone) numbered.push_back(i);
  for (std::size_t next = 0; next < numbered.size(); ++next)
    for_each_continued(numbered[next], [&](std::size_t to) {
      if (numbers[to] != kNone || !edges_[to]) return;
      numbers[to] = numbers[numbered[next]];
      numbered.push_back(to);
    });
}

}  // namespace

ViewSurfaces surfaces_of(const frame::CoarseView& view) {
  const Numbers numbers = Segmentation(view).surfaces();
  std::vector<std::size_t> pixel_count(1, 0);
  for (const std::uint32_t number : numbers) {
    if (number >= pixel_count.size()) pixel_count.resize(number + 1, 0);
    ++pixel_count[number];
  }
  const double least_pixels = kLeastSurface * static_cast<double>(view.size());
  ViewSurfaces surfaces{Numbers(view.size(), kNone), {0}};
  Numbers renumbered(pixel_count.size(), kNone);
  for (std::size_t i = kNone + 1; i < pixel_count.size(); ++i) {
    if (static_cast<double>(pixel_count[i]) < least_pixels) continue;
    renumbered[i] = static_cast<std::uint32_t>(surfaces.pixel_count.size());
    surfaces.pixel_count.push_back(0);
  }
  for (std::size_t i = 0; i < view.size(); ++i) {
    surfaces.of_pixel[i] = renumbered[numbers[i]];
    ++surfaces.pixel_count[surfaces.of_pixel[i]];
  }
  return surfaces;
}

}  // namespace hermite::track
