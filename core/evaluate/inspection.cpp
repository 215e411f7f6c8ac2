#include "core/evaluate/inspection.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "core/dataset/associate.h"
#include "core/evaluate/depth_doubts.h"

namespace hermite::evaluate {
namespace {

constexpr double kGap = 1.5;  // in median steps; longer ones mean a missing frame
constexpr std::size_t kMaxGapsNamed = 5;
constexpr double kRateTolerance = 0.2;      // as a share of the stated rate
constexpr double kFastestHand_m_per_s = 5;  // a faster pose is wrong
constexpr std::size_t kMaxFilesCounted = 1'000'000;

std::uint64_t bytes_below(const std::string& path) {
  std::error_code failure;
  if (std::filesystem::is_regular_file(path, failure))
    return std::filesystem::file_size(path, failure);
  std::uint64_t bytes = 0;
  std::size_t files = 0;
  for (std::filesystem::recursive_directory_iterator entries(path, failure), end;
       !failure && entries != end && files < kMaxFilesCounted;
       entries.increment(failure), ++files) {
    std::error_code ignored;
    if (entries->is_regular_file(ignored)) bytes += entries->file_size(ignored);
  }
  return bytes;
}

void survey_times(const dataset::Sequence& sequence, Inspection& found) {
  std::vector<double> steps_s;
  for (std::int64_t i = 1; i < sequence.frame_count(); ++i)
    steps_s.push_back(sequence.timestamp_s(i) - sequence.timestamp_s(i - 1));
  if (steps_s.empty()) {
    found.doubts.push_back("there is one frame only");
    return;
  }
  found.duration_s = sequence.timestamp_s(sequence.frame_count() - 1) - sequence.timestamp_s(0);
  std::vector<double> sorted = steps_s;
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2),
                   sorted.end());
  const double median_s = sorted[sorted.size() / 2];
  found.measured_rate_hz = 1 / median_s;
  std::vector<TimeGap> gaps;
  for (std::size_t i = 0; i < steps_s.size(); ++i)
    if (steps_s[i] > kGap * median_s) gaps.push_back({static_cast<std::int64_t>(i), steps_s[i]});
  found.gap_count = static_cast<std::int64_t>(gaps.size());
  std::stable_sort(gaps.begin(), gaps.end(),
                   [](const TimeGap& a, const TimeGap& b) { return a.length_s > b.length_s; });
  gaps.resize(std::min(gaps.size(), kMaxGapsNamed));
  found.longest_gaps = std::move(gaps);
  if (found.gap_count > 0)
    found.doubts.push_back(fmt::format("{} gaps in time, the longest of {:.3g} s after frame {}",
                                       found.gap_count, found.longest_gaps.front().length_s,
                                       found.longest_gaps.front().after_frame));
  if (std::abs(found.measured_rate_hz / found.stated_rate_hz - 1) > kRateTolerance)
    found.doubts.push_back(fmt::format("the times say {:.3g} frames a second, stated are {:.3g}",
                                       found.measured_rate_hz, found.stated_rate_hz));
}

void survey_images(const dataset::Sequence& sequence, std::int64_t max_frames, Inspection& found) {
  const std::int64_t count = std::min(sequence.frame_count(), max_frames);
  DepthValues values;
  RegistrationCheck registration;
  std::string first_problem;
  for (std::int64_t i = 0; i < count; ++i) {
    // The middle of each part, because the first frames of a recording often show a hand.
    auto recorded = sequence.read((2 * i + 1) * sequence.frame_count() / (2 * count));
    const Result<frame::RgbdFrame> frame = recorded.ok()
                                               ? dataset::decode_frame(*std::move(recorded))
                                               : Result<frame::RgbdFrame>(recorded.error());
    ++found.frames_looked_at;
    if (!frame.ok()) {
      if (found.unreadable_count++ == 0) first_problem = frame.error().message;
      continue;
    }
    values.add(frame->depth);
    if (!found.camera.color) registration.add(*frame, found.camera.depth_units_per_metre);
  }
  found.depth = values.survey();
  found.registration = registration.fit();
  if (found.unreadable_count > 0)
    found.doubts.push_back(fmt::format("{} of {} frames looked at cannot be read: {}",
                                       found.unreadable_count, count, first_problem));
}

void judge_depth(Inspection& found) {
  found.unit = guess_depth_unit(found.depth, found.camera.depth_units_per_metre);
  if (found.frames_looked_at == found.unreadable_count) return;
  for (std::string& doubt : depth_doubts(
           {found.depth, found.unit, found.registration, found.camera.depth_units_per_metre}))
    found.doubts.push_back(std::move(doubt));
}

void survey_truth(const dataset::Sequence& sequence, Inspection& found) {
  const dataset::Trajectory& truth = sequence.groundtruth();
  found.truth.pose_count = static_cast<std::int64_t>(truth.size());
  if (truth.empty()) return;
  for (std::size_t i = 1; i < truth.size(); ++i) {
    const double way_m =
        (truth[i].world_from_camera.translation - truth[i - 1].world_from_camera.translation)
            .norm();
    found.truth.path_m += way_m;
    const double step_s = truth[i].timestamp_s - truth[i - 1].timestamp_s;
    if (step_s > 0)
      found.truth.fastest_m_per_s = std::max(found.truth.fastest_m_per_s, way_m / step_s);
  }
  for (std::int64_t i = 0; i < sequence.frame_count(); ++i)
    found.truth.frames_with_pose +=
        dataset::pose_at(truth, sequence.timestamp_s(i), dataset::kMaxAssociationGap_s) ? 1 : 0;
  if (found.truth.frames_with_pose < sequence.frame_count())
    found.doubts.push_back(fmt::format("{} of {} frames have no true pose within 20 ms",
                                       sequence.frame_count() - found.truth.frames_with_pose,
                                       sequence.frame_count()));
  if (found.truth.fastest_m_per_s > kFastestHand_m_per_s)
    found.doubts.push_back(fmt::format("the ground truth jumps: up to {:.1f} m/s between two poses",
                                       found.truth.fastest_m_per_s));
}

}  // namespace

Inspection inspect(const dataset::Recording& recording, const std::string& path,
                   std::int64_t max_frames) {
  CHECK(max_frames >= 1, "nothing to look at");
  const dataset::Sequence& sequence = *recording.sequence;
  Inspection found;
  found.name = sequence.name();
  found.format = sequence.format();
  found.format_reason = recording.format_reason;
  found.frame_count = sequence.frame_count();
  found.stated_rate_hz = sequence.frame_rate_hz();
  found.size_bytes = bytes_below(path);
  found.camera = sequence.camera();
  found.camera_source = recording.camera_source;
  found.doubts = recording.doubts;
  survey_times(sequence, found);
  survey_images(sequence, max_frames, found);
  judge_depth(found);
  survey_truth(sequence, found);
  return found;
}

}  // namespace hermite::evaluate
