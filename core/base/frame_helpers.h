// Runs the independent pieces of a frame's work on the caller's thread and on threads that wait for
// such work.
//
// A frame has about ten steps that are divided into pieces, each of some tenths of a millisecond.
// Starting and joining threads for every step, as in_parallel() does, would cost up to a third of
// that.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>

namespace hermite {

// Calls work(i) once for every i below `count`, in no particular order, on the caller's thread and
// on helpers of the process as far as these are idle, at most kMostFrameHelpers. `work` may only
// write data that belongs to i. If it throws, no further pieces are begun and the exception is
// rethrown when the running ones have ended; of several exceptions, the first one caught. Any
// number of threads may call it at once, also from within `work`. The helpers have the priority of
// the first caller: not for threads that have stepped back (core/base/step_back.h).
void in_parallel_of_frame(std::size_t count, const std::function<void(std::size_t)>& work);

// The same for the pixels of an image: calls work(first, last) for pieces of them.
template <class Work>
void for_pixels_of_frame(std::size_t pixel_count, const Work& work) {
  constexpr std::size_t kAtOnce = 32768;  // whose conversion takes a tenth of a millisecond
  in_parallel_of_frame((pixel_count + kAtOnce - 1) / kAtOnce, [&](std::size_t piece) {
    work(piece * kAtOnce, std::min((piece + 1) * kAtOnce, pixel_count));
  });
}

// More do not pay: the pieces of a frame are some milliseconds in total, and other scans have
// frames too.
inline constexpr std::size_t kMostFrameHelpers = 7;

}  // namespace hermite
