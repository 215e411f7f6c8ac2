#include "core/compare/agreement.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/base/parallel.h"

namespace hermite::compare {

namespace {

using Eigen::Vector3d;

// Surfaces agree if they are this near along their normals, in spacings of samples, with samples up
// to 1.5 of them aside.
constexpr double kMatchedAlong = 0.6, kMatchedSpacings = 1.5, kMatchedCosine = 0.85;
// A surface is contradicted if the other camera saw something this far behind it, in spacings.
constexpr double kBehind = 1.6;

enum class Finding : std::uint8_t { kUnseen, kMatched, kContradicted };

struct Found {
  Finding finding = Finding::kUnseen;
  std::uint32_t partner = 0;
};

Found look_up(const SurfaceSample& sample, const Rigid3& other_from_own, const CoarseScan& other) {
  const Vector3d position_m = other_from_own * sample.position_m,
                 normal = other_from_own.rotation * sample.normal;
  const std::optional<std::uint32_t> near = other.grid().nearest(
      position_m, normal, kMatchedSpacings * other.spacing_m(), kMatchedCosine);
  if (near) {
    const SurfaceSample& partner = other.samples()[*near];
    if (std::abs(partner.normal.dot(position_m - partner.position_m)) <=
        kMatchedAlong * other.spacing_m())
      return {Finding::kMatched, *near};
  }
  return {!near && other.sight().looked_through(position_m, kBehind * other.spacing_m())
              ? Finding::kContradicted
              : Finding::kUnseen,
          0};
}

std::vector<Found> look_up_all(const CoarseScan& own, const Rigid3& other_from_own,
                               const CoarseScan& other) {
  std::vector<Found> found(own.samples().size());
  in_parallel(found.size(),
              [&](std::size_t i) { found[i] = look_up(own.samples()[i], other_from_own, other); });
  return found;
}

double color_difference_of(const std::vector<Found>& found_of_b, const CoarseScan& a,
                           const CoarseScan& b) {
  Vector3d products = Vector3d::Zero(), squares = Vector3d::Constant(1e-9);
  for (std::size_t i = 0; i < found_of_b.size(); ++i) {
    if (found_of_b[i].finding != Finding::kMatched) continue;
    const Vector3d &in_a = a.samples()[found_of_b[i].partner].color, &in_b = b.samples()[i].color;
    products += in_a.cwiseProduct(in_b);
    squares += in_b.cwiseProduct(in_b);
  }
  const Vector3d gain = products.cwiseQuotient(squares);
  std::vector<double> differences;
  for (std::size_t i = 0; i < found_of_b.size(); ++i)
    if (found_of_b[i].finding == Finding::kMatched)
      differences.push_back(
          (a.samples()[found_of_b[i].partner].color - gain.cwiseProduct(b.samples()[i].color))
              .cwiseAbs()
              .mean());
  if (differences.empty()) return 0;
  const auto middle = differences.begin() + static_cast<std::ptrdiff_t>(differences.size() / 2);
  std::nth_element(differences.begin(), middle, differences.end());
  return *middle;
}

std::size_t count_of(const std::vector<Found>& found, Finding finding) {
  return static_cast<std::size_t>(std::count_if(
      found.begin(), found.end(), [&](const Found& f) { return f.finding == finding; }));
}

}  // namespace

double coarse_spacing_m(const ComparedScan& a, const ComparedScan& b) {
  return std::clamp(std::min(a.extent_m(), b.extent_m()) / 100, kLeastCoarseSpacing_m,
                    kMostCoarseSpacing_m);
}

CoarseScan::CoarseScan(const ComparedScan& scan, double spacing_m)
    : scan_(scan),
      samples_(surface_samples(scan.surfels(), spacing_m, kMostCoarseSamples)),
      grid_(samples_.samples, 3 * samples_.spacing_m),
      sight_(scan) {}

double CoarseAgreement::share() const {
  const std::size_t seen = matched + contradicted;
  return seen == 0 ? 0 : static_cast<double>(matched) / static_cast<double>(seen);
}

double CoarseAgreement::overlap() const {
  const auto ratio = [](std::size_t part, std::size_t of) {
    return of == 0 ? 0 : static_cast<double>(part) / static_cast<double>(of);
  };
  return std::max(ratio(matched_a, samples_a), ratio(matched_b, samples_b));
}

CoarseAgreement agreement_of(const CoarseScan& a, const CoarseScan& b, const Rigid3& a_from_b) {
  const std::vector<Found> of_b = look_up_all(b, a_from_b, a),
                           of_a = look_up_all(a, inverse(a_from_b), b);
  CoarseAgreement agreement;
  agreement.samples_a = of_a.size();
  agreement.samples_b = of_b.size();
  agreement.sample_count = of_a.size() + of_b.size();
  agreement.matched_a = count_of(of_a, Finding::kMatched);
  agreement.matched_b = count_of(of_b, Finding::kMatched);
  agreement.matched = agreement.matched_a + agreement.matched_b;
  agreement.contradicted =
      count_of(of_a, Finding::kContradicted) + count_of(of_b, Finding::kContradicted);
  agreement.has_color = a.scan().has_color() && b.scan().has_color();
  if (agreement.has_color) agreement.color_difference = color_difference_of(of_b, a, b);
  return agreement;
}

}  // namespace hermite::compare
