#include "core/dataset/associate.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <tuple>

namespace hermite::dataset {
namespace {

// A double resolves 0.24 us of today's Unix time in seconds; two stamps exactly a gap apart must
// not fail because of that.
constexpr double kClockResolution_s = 1e-6;
constexpr std::size_t kMaxCandidatesPerEntry = 256;

struct Candidate {
  double gap_s;
  IndexPair pair;
};

}  // namespace

Result<std::vector<IndexPair>> associate_by_time(const std::vector<double>& first_times_s,
                                                 const std::vector<double>& second_times_s,
                                                 double max_gap_s) {
  const double reach_s = max_gap_s + kClockResolution_s;
  const std::size_t max_candidate_count =
      kMaxCandidatesPerEntry * (first_times_s.size() + second_times_s.size());
  std::vector<Candidate> candidates;
  for (std::size_t i = 0; i < first_times_s.size(); ++i) {
    const double time_s = first_times_s[i];
    auto near = std::lower_bound(second_times_s.begin(), second_times_s.end(), time_s - reach_s);
    for (; near != second_times_s.end() && *near <= time_s + reach_s; ++near) {
      if (candidates.size() == max_candidate_count)
        return Error{ErrorCode::kTooLarge,
                     fmt::format("more than {} entries lie within {:f} s of each other: these are "
                                 "no time stamps of frames",
                                 kMaxCandidatesPerEntry, max_gap_s)};
      candidates.push_back(
          {std::abs(*near - time_s), {i, static_cast<std::size_t>(near - second_times_s.begin())}});
    }
  }
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return std::tie(a.gap_s, a.pair.first, a.pair.second) <
           std::tie(b.gap_s, b.pair.first, b.pair.second);
  });

  std::vector<bool> first_used(first_times_s.size()), second_used(second_times_s.size());
  std::vector<IndexPair> pairs;
  for (const Candidate& candidate : candidates) {
    if (first_used[candidate.pair.first] || second_used[candidate.pair.second]) continue;
    first_used[candidate.pair.first] = second_used[candidate.pair.second] = true;
    pairs.push_back(candidate.pair);
  }
  std::sort(pairs.begin(), pairs.end(),
            [](const IndexPair& a, const IndexPair& b) { return a.first < b.first; });
  return pairs;
}

}  // namespace hermite::dataset
