#include "core/compare/register.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "core/base/parallel.h"
#include "core/base/printf_text.h"
#include "core/compare/start_poses.h"

namespace hermite::compare {

namespace {

constexpr double kDescriptorReach = 6;  // spacings of samples
constexpr std::size_t kMostFeatures = 3000, kPartners = 3;
constexpr std::size_t kByFeatures = 16, kByPlanes = 16;
constexpr std::size_t kRoughSamples = 1500, kFineSamples = 6000;
constexpr double kLeastShare = 0.75, kLeastShareByColor = 0.6, kSameColor = 15;
// The second if nobody knows what the cameras saw.
constexpr double kLeastOverlap = 0.15, kLeastOverlapUnseen = 0.6;
constexpr double kMostSigma_m = 0.02;
// Floor and walls of a corner agree with their reflection. So a reflection is tried unless the
// scans overlap this much; it is the right one if it overlaps more by this factor.
constexpr double kSurelyNotMirrored = 0.8, kMirrorRatio = 1.3;
// Another pose is as good if it scores this share of the best one, unless its colours differ
// clearly more.
constexpr double kAsGood = 0.85, kColorRatio = 1.5, kColorMargin = 4;
// Fractions of the time at which the steps end: the features, all candidates, and those of the
// reflection.
constexpr double kDescribed = 0.3, kJudged = 0.5, kReflected = 0.95;

struct Judged {
  Rigid3 a_from_b;
  CoarseAgreement agreement;
  double score = 0;
};

double score_of(const CoarseAgreement& agreement) {
  return static_cast<double>(agreement.matched) - static_cast<double>(agreement.contradicted);
}

// Without those that are left when it is stopped.
std::vector<Judged> judged(const CoarseScan& a, const CoarseScan& b,
                           const std::vector<Rigid3>& candidates, const CompareProgress& progress) {
  std::vector<Judged> poses;
  for (std::size_t i = 0;
       i < candidates.size() &&
       goes_on(progress, static_cast<double>(i) / static_cast<double>(candidates.size()));
       ++i) {
    const Rigid3 a_from_b = aligned_roughly(a, b, candidates[i], kRoughSamples);
    const CoarseAgreement agreement = agreement_of(a, b, a_from_b);
    poses.push_back({a_from_b, agreement, score_of(agreement)});
  }
  return poses;
}

// Of poses that agree as well, that whose colours agree better comes first.
bool has_better_colors(const Judged& x, const Judged& y) {
  return x.agreement.has_color &&
         kColorRatio * x.agreement.color_difference + kColorMargin < y.agreement.color_difference;
}

void sort_best_first(std::vector<Judged>& poses) {
  std::stable_sort(poses.begin(), poses.end(),
                   [](const Judged& x, const Judged& y) { return x.score > y.score; });
  std::size_t best = 0;
  for (std::size_t i = 1; i < poses.size() && poses[i].score >= kAsGood * poses.front().score; ++i)
    if (has_better_colors(poses[i], poses[best])) best = i;
  std::rotate(poses.begin(), poses.begin() + static_cast<std::ptrdiff_t>(best),
              poses.begin() + static_cast<std::ptrdiff_t>(best) + 1);
}

std::vector<Judged> best_judged(const CoarseScan& a, const CoarseScan& b,
                                const CompareProgress& progress) {
  if (!goes_on(progress, 0)) return {};
  const bool with_color = a.scan().has_color() && b.scan().has_color();
  const double reach_m = kDescriptorReach * std::max(a.spacing_m(), b.spacing_m());
  const std::vector<SurfaceFeature> in_a = surface_features(a.samples(), reach_m, kMostFeatures,
                                                            with_color),
                                    in_b = surface_features(b.samples(), reach_m, kMostFeatures,
                                                            with_color);
  std::vector<Rigid3> candidates =
      poses_by_features(a, b, similar_features(in_a, in_b, kPartners), kByFeatures);
  const std::vector<Rigid3> by_planes = best_poses(a, b, poses_by_planes(a, b), kByPlanes);
  candidates.insert(candidates.end(), by_planes.begin(), by_planes.end());
  constexpr double kTurned = 0.9;  // of this step
  std::vector<Judged> poses =
      judged(a, b, candidates, part_of(progress, kDescribed / kJudged, kTurned));
  if (poses.empty()) return poses;
  sort_best_first(poses);
  const std::vector<Judged> turned =
      judged(a, b, turned_poses(poses.front().a_from_b, a), part_of(progress, kTurned, 1));
  poses.insert(poses.end(), turned.begin(), turned.end());
  sort_best_first(poses);
  return poses;
}

double least_overlap(const CoarseScan& a, const CoarseScan& b) {
  return a.sight().view_count() + b.sight().view_count() > 0 ? kLeastOverlap : kLeastOverlapUnseen;
}

double least_share(const CoarseAgreement& agreement) {
  return agreement.has_color && agreement.color_difference <= kSameColor ? kLeastShareByColor
                                                                         : kLeastShare;
}

bool is_enough(const CoarseAgreement& agreement, double overlap) {
  return agreement.share() >= least_share(agreement) && agreement.overlap() >= overlap;
}

std::string text_of(const CoarseAgreement& agreement) {
  return printf_text(
      "%.0f %% of what both saw agrees, and %.0f %% of the smaller scan lies in the other one",
      100 * agreement.share(), 100 * agreement.overlap());
}

ComparedScan mirrored(const ComparedScan& scan) {
  output::Cloud cloud = scan.surfels();
  for (output::CloudPoint& point : cloud) {
    point.position_m.x() = -point.position_m.x();
    point.normal.x() = -point.normal.x();
  }
  return or_throw(ComparedScan::create(std::move(cloud), {}, "mirrored"));
}

// Whether B's reflection agrees with A, and better than B itself.
bool is_mirrored(const CoarseScan& a, const CoarseScan& b, const CoarseAgreement& best,
                 const CompareProgress& progress) {
  if (best.overlap() >= kSurelyNotMirrored) return false;
  const ComparedScan reflection = mirrored(b.scan());
  const std::vector<Judged> poses = best_judged(a, CoarseScan(reflection, b.spacing_m()), progress);
  return !poses.empty() && is_enough(poses.front().agreement, least_overlap(a, b)) &&
         poses.front().agreement.overlap() > kMirrorRatio * best.overlap();
}

Registration of_mirrored(const CoarseAgreement& best) {
  Registration registration;
  registration.verdict = RegistrationVerdict::kMirrored;
  registration.message =
      "One of the scans is mirrored: they agree better if one is reflected. Correct its axes "
      "first.";
  registration.agreement = best;
  return registration;
}

Registration without_place(const CoarseScan& a, const CoarseScan& b, const CoarseAgreement& best) {
  Registration registration;
  registration.agreement = best;
  registration.message = fmt::format(
      "The two scans do not show the same place, or too little of it in common: in the best "
      "position found, {} (at least {:.0f} % and {:.0f} % are needed).",
      text_of(best), 100 * least_share(best), 100 * least_overlap(a, b));
  if (const double ratio = a.scan().extent_m() / b.scan().extent_m(); ratio > 3 || ratio < 1 / 3.0)
    registration.message +=
        printf_text(" The first extends over %.3g m, the second over %.3g m: are both in metres?",
                    a.scan().extent_m(), b.scan().extent_m());
  return registration;
}

Registration with_too_few_places(const CoarseAgreement& best, std::size_t place_count) {
  Registration registration;
  registration.verdict = RegistrationVerdict::kTooSparse;
  registration.agreement = best;
  registration.message = fmt::format(
      "The two scans cannot be aligned: in the best position found, {}, but at only {} places of "
      "at least {}. The scans are too small, or their points too far apart.",
      text_of(best), place_count, kLeastPlaces);
  return registration;
}

const Judged* rival_of(const std::vector<Judged>& poses, const CoarseScan& a, const CoarseScan& b) {
  const Judged& best = poses.front();
  for (std::size_t i = 1; i < poses.size(); ++i) {
    if (is_same_pose(poses[i].a_from_b, best.a_from_b, b) || poses[i].score < kAsGood * best.score)
      continue;
    if (!is_enough(poses[i].agreement, least_overlap(a, b)) || has_better_colors(best, poses[i]))
      continue;
    return &poses[i];
  }
  return nullptr;
}

}  // namespace

Registration register_scans(const CoarseScan& a, const CoarseScan& b,
                            const CompareProgress& progress) {
  const std::vector<Judged> poses = best_judged(a, b, part_of(progress, 0, kJudged));
  if (poses.empty()) return without_place(a, b, {});
  const Judged& best = poses.front();
  if (is_mirrored(a, b, best.agreement, part_of(progress, kJudged, kReflected)))
    return of_mirrored(best.agreement);
  if (!is_enough(best.agreement, least_overlap(a, b))) return without_place(a, b, best.agreement);
  if (!goes_on(progress, kReflected)) return {};
  Registration registration;
  registration.alignment =
      aligned_exactly(a, b, aligned_roughly(a, b, best.a_from_b, kFineSamples));
  if (registration.alignment.place_count < kLeastPlaces)
    return with_too_few_places(best.agreement, registration.alignment.place_count);
  registration.agreement = agreement_of(a, b, registration.alignment.a_from_b);
  if (const Judged* rival = rival_of(poses, a, b)) {
    const Rigid3 turn = inverse(best.a_from_b) * rival->a_from_b;
    registration.verdict = RegistrationVerdict::kAmbiguous;
    registration.message = printf_text(
        "The place looks alike from two sides: the second scan fits as well after a turn by %.0f "
        "degrees, "
        "and neither shapes nor colours tell which is right.",
        angle_rad(turn.rotation) * 180 / M_PI);
    return registration;
  }
  const ScanAlignment& alignment = registration.alignment;
  if (!(alignment.weakest_sigma_m <= kMostSigma_m)) {
    registration.verdict = RegistrationVerdict::kSliding;
    registration.message = printf_text(
        "The common surfaces do not hold the two scans along (%.2f, %.2f, %.2f): their position "
        "there is uncertain by %.0f mm.",
        alignment.weakest_direction.x(), alignment.weakest_direction.y(),
        alignment.weakest_direction.z(), 1000 * alignment.weakest_sigma_m);
    return registration;
  }
  registration.verdict = RegistrationVerdict::kSamePlace;
  registration.message =
      fmt::format("The two scans show the same place: {}.", text_of(registration.agreement));
  return registration;
}

const char* name_of(RegistrationVerdict verdict) {
  switch (verdict) {
    case RegistrationVerdict::kSamePlace: return "same_place";
    case RegistrationVerdict::kDifferentPlaces: return "different_places";
    case RegistrationVerdict::kAmbiguous: return "ambiguous";
    case RegistrationVerdict::kSliding: return "sliding";
    case RegistrationVerdict::kMirrored: return "mirrored";
    case RegistrationVerdict::kTooSparse: return "too_sparse";
  }
  return "";
}

}  // namespace hermite::compare
