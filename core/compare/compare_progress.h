// How far a comparison is. Pure.
#pragma once

#include <functional>

namespace hermite::compare {

// Called from time to time with the fraction that is done, by any thread, also by several at once.
// Returns false to stop: what is returned then is meaningless. Empty: nobody wants to know.
using CompareProgress = std::function<bool(double done)>;

inline bool goes_on(const CompareProgress& progress, double done) {
  return !progress || progress(done);
}

// Maps the progress of one step to its range of the whole work. Refers to `progress`.
inline CompareProgress part_of(const CompareProgress& progress, double from, double to) {
  if (!progress) return {};
  return [&progress, from, to](double done) { return progress(from + (to - from) * done); };
}

}  // namespace hermite::compare
