#include "core/frame/repeated_rows.h"

#include <algorithm>
#include <functional>
#include <string_view>

namespace hermite::frame {

namespace {

// A row with fewer measurements is not told from others: noise of a Kinect leaves about a third of
// the pixels of a camera at rest as they were, so 16 are equal once in 10^8 rows.
constexpr std::ptrdiff_t kLeastMeasured = 16;

// Fewer repeated rows are left in: they change no pose.
constexpr int kLeastRows = 4;

// A frame is torn if at most this share of the rows above repeats as well.
constexpr double kMostAbove = 0.1;

struct RowCounts {
  int known = 0, repeated = 0;
};

}  // namespace

RowDigests digest_rows(const DepthImage& depth) {
  RowDigests rows(static_cast<std::size_t>(depth.height));
  const auto width = static_cast<std::size_t>(depth.width);
  for (std::size_t y = 0; y < rows.size(); ++y) {
    const std::uint16_t* const row = depth.pixels.data() + y * width;
    if (std::count(row, row + width, 0) > depth.width - kLeastMeasured) continue;
    const std::string_view bytes(reinterpret_cast<const char*>(row), width * sizeof(*row));
    rows[y] = std::max<std::uint64_t>(std::hash<std::string_view>()(bytes), 1);
  }
  return rows;
}

int repeated_row_count(const RowDigests& before, const RowDigests& now) {
  if (before.size() != now.size()) return 0;
  // From the bottom row up to the first that is new, and above that row.
  RowCounts below, above;
  std::size_t first = now.size();
  for (std::size_t y = now.size(); y-- > 0;) {
    if (before[y] == 0 && now[y] == 0) continue;
    const bool is_repeated = before[y] == now[y];
    RowCounts& counts = is_repeated && above.known == 0 ? below : above;
    ++counts.known;
    counts.repeated += is_repeated ? 1 : 0;
    if (&counts == &below) first = y;
  }
  const bool is_torn =
      below.known >= kLeastRows && above.known > 0 && above.repeated <= kMostAbove * above.known;
  return is_torn ? static_cast<int>(now.size() - first) : 0;
}

void remove_last_rows(RgbdFrame& frame, int row_count) {
  const int first = std::max(1, frame.depth.height - row_count);
  for (int y = first; y < frame.depth.height; ++y)
    for (int x = 0; x < frame.depth.width; ++x) {
      frame.depth.at(x, y) = 0;
      frame.color.at(x, y) = frame.color.at(x, first - 1);
    }
}

int TornFrames::next(const RowDigests& rows) {
  const int row_count = repeated_row_count(before_, rows);
  before_ = rows;
  count_ += row_count > 0 ? 1 : 0;
  return row_count;
}

void TornFrames::save(ByteWriter& bytes) const {
  bytes.numbers(before_);
  bytes.number(count_);
}

void TornFrames::restore(ByteReader& bytes) {
  bytes.numbers(before_);
  bytes.number(count_);
  bytes.require(count_ >= 0, "the number of torn frames is negative");
}

}  // namespace hermite::frame
