#include "core/mesh/loop_triangulation.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

namespace hermite::mesh {
namespace {

using Eigen::Vector3d;

struct PolygonWeight {
  double fold = 0;  // 1 - cosine of the sharpest fold
  double area_m2 = 0;

  bool operator<(const PolygonWeight& other) const {
    return fold != other.fold ? fold < other.fold : area_m2 < other.area_m2;
  }
  bool is_possible() const { return fold < std::numeric_limits<double>::infinity(); }
};

constexpr PolygonWeight kImpossible{std::numeric_limits<double>::infinity(), 0};
// Smaller differences between folds (below about ten degrees) are noise of the boundary; then the
// smaller area wins.
constexpr double kSmooth = 0.015;

double fold_between(const Vector3d& a, const Vector3d& b) {
  if (a.isZero() || b.isZero()) return 0;
  return std::max(kSmooth, 1 - a.dot(b));
}

class PolygonFiller {
 public:
  explicit PolygonFiller(const LoopToFill& loop) : loop_(loop) {}

  std::optional<std::vector<output::TriangleCorners>> fill() {
    std::vector<std::size_t> all(loop_.points_m.size());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
    if (!fill_polygon(all, loop_.face_normals.back())) return std::nullopt;
    return std::move(triangles_);
  }

 private:
  struct Span {
    PolygonWeight weight = kImpossible;
    // The third vertex of the triangle at the edge from the first to the last point.
    std::size_t middle = 0;
    Vector3d normal = Vector3d::Zero();  // of that triangle
  };

  bool fill_polygon(const std::vector<std::size_t>& polygon, const Vector3d& closing_normal);
  std::vector<std::size_t> coarse(const std::vector<std::size_t>& polygon) const;
  bool fill_small_polygon(const std::vector<std::size_t>& polygon, const Vector3d& closing_normal);
  Vector3d normal_beyond(std::size_t from, std::size_t to) const;
  Span best_span(const std::vector<std::size_t>& polygon, std::size_t first, std::size_t last,
                 const Vector3d* closing_normal) const;
  void keep_triangles(const std::vector<std::size_t>& polygon, std::size_t first, std::size_t last);
  Span& span(std::size_t first, std::size_t last) {
    return spans_[first * kMostPolygonPoints + last];
  }
  const Span& span(std::size_t first, std::size_t last) const {
    return spans_[first * kMostPolygonPoints + last];
  }

  const LoopToFill& loop_;
  std::vector<Span> spans_;
  std::vector<output::TriangleCorners> triangles_;
};

// Returns the normal across the boundary between two of its points, or the mean along it.
Vector3d PolygonFiller::normal_beyond(std::size_t from, std::size_t to) const {
  Vector3d sum = Vector3d::Zero();
  for (std::size_t i = from; i < to; ++i) sum += loop_.face_normals[i];
  const double length = sum.norm();
  return length > 0 ? Vector3d(sum / length) : Vector3d(Vector3d::Zero());
}

// Selects at most kMostPolygonPoints of the points, including both ends, so that none of the edges
// between them exists already.
std::vector<std::size_t> PolygonFiller::coarse(const std::vector<std::size_t>& polygon) const {
  const std::size_t step = (polygon.size() - 1 + kMostPolygonPoints - 2) / (kMostPolygonPoints - 1);
  std::vector<std::size_t> few{0};
  while (few.back() + 1 < polygon.size()) {
    std::size_t next = std::min(few.back() + step, polygon.size() - 1);
    while (next > few.back() + 1 && loop_.is_taken(polygon[few.back()], polygon[next])) --next;
    few.push_back(next);
  }
  return few;
}

// `polygon` holds ascending indices into the loop; the normal is that of the triangle across the
// edge from its last to its first point.
bool PolygonFiller::fill_polygon(const std::vector<std::size_t>& polygon,
                                 const Vector3d& closing_normal) {
  if (polygon.size() <= kMostPolygonPoints) return fill_small_polygon(polygon, closing_normal);
  const std::vector<std::size_t> few = coarse(polygon);
  if (few.size() >= polygon.size() || few.size() < 3) return false;
  std::vector<std::size_t> coarse_polygon;
  for (const std::size_t i : few) coarse_polygon.push_back(polygon[i]);
  const std::size_t before = triangles_.size();
  if (!fill_polygon(coarse_polygon, closing_normal)) return false;
  const std::vector<output::TriangleCorners> made(
      triangles_.begin() + static_cast<std::ptrdiff_t>(before), triangles_.end());
  for (std::size_t i = 0; i + 1 < few.size(); ++i) {
    if (few[i + 1] == few[i] + 1) continue;
    const std::vector<std::size_t> chain(
        polygon.begin() + static_cast<std::ptrdiff_t>(few[i]),
        polygon.begin() + static_cast<std::ptrdiff_t>(few[i + 1] + 1));
    Vector3d normal = Vector3d::Zero();
    for (const output::TriangleCorners& t : made) {
      const auto has = [&t](std::size_t point) {
        return std::find(t.begin(), t.end(), point) != t.end();
      };
      if (!has(chain.front()) || !has(chain.back())) continue;
      const auto& p = loop_.points_m;
      normal = (p[t[1]] - p[t[0]]).cross(p[t[2]] - p[t[0]]).stableNormalized();
      break;
    }
    if (!fill_polygon(chain, normal)) return false;
  }
  return true;
}

PolygonFiller::Span PolygonFiller::best_span(const std::vector<std::size_t>& polygon,
                                             std::size_t first, std::size_t last,
                                             const Vector3d* closing_normal) const {
  const auto& p = loop_.points_m;
  Span best;
  for (std::size_t middle = first + 1; middle < last; ++middle) {
    const Span &before = span(first, middle), &after = span(middle, last);
    if (!before.weight.is_possible() || !after.weight.is_possible()) continue;
    const Vector3d across =
        (p[polygon[middle]] - p[polygon[first]]).cross(p[polygon[last]] - p[polygon[first]]);
    const double length = across.norm();
    const Vector3d normal = length > 0 ? Vector3d(across / length) : Vector3d(Vector3d::Zero());
    double fold = length > 0 ? std::max(fold_between(normal, before.normal),
                                        fold_between(normal, after.normal))
                             : 2;
    if (closing_normal) fold = std::max(fold, fold_between(normal, *closing_normal));
    const PolygonWeight weight{std::max({fold, before.weight.fold, after.weight.fold}),
                               before.weight.area_m2 + after.weight.area_m2 + 0.5 * length};
    if (weight < best.weight) best = {weight, middle, normal};
  }
  return best;
}

bool PolygonFiller::fill_small_polygon(const std::vector<std::size_t>& polygon,
                                       const Vector3d& closing_normal) {
  const std::size_t count = polygon.size();
  spans_.assign(kMostPolygonPoints * kMostPolygonPoints, {});
  for (std::size_t i = 0; i + 1 < count; ++i)
    span(i, i + 1) = {{0, 0}, i, normal_beyond(polygon[i], polygon[i + 1])};
  for (std::size_t length = 2; length < count; ++length)
    for (std::size_t first = 0; first + length < count; ++first) {
      const std::size_t last = first + length;
      const bool is_whole = length + 1 == count;
      if (is_whole || !loop_.is_taken(polygon[first], polygon[last]))
        span(first, last) = best_span(polygon, first, last, is_whole ? &closing_normal : nullptr);
    }
  if (!span(0, count - 1).weight.is_possible()) return false;
  keep_triangles(polygon, 0, count - 1);
  return true;
}

void PolygonFiller::keep_triangles(const std::vector<std::size_t>& polygon, std::size_t first,
                                   std::size_t last) {
  std::vector<std::pair<std::size_t, std::size_t>> waiting{{first, last}};
  while (!waiting.empty()) {
    const auto [begin, end] = waiting.back();
    waiting.pop_back();
    if (end == begin + 1) continue;
    const std::size_t middle = span(begin, end).middle;
    triangles_.push_back({static_cast<std::uint32_t>(polygon[begin]),
                          static_cast<std::uint32_t>(polygon[middle]),
                          static_cast<std::uint32_t>(polygon[end])});
    waiting.emplace_back(begin, middle);
    waiting.emplace_back(middle, end);
  }
}

}  // namespace

std::optional<std::vector<output::TriangleCorners>> triangulated(const LoopToFill& loop) {
  return PolygonFiller(loop).fill();
}

}  // namespace hermite::mesh
