#include "core/image/depth_ranks.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>

#include "core/image/bit_stream.h"
#include "core/image/corrupt_depth.h"
#include "core/image/rank_dictionary.h"
#include "core/image/rans.h"

namespace hermite::image {
namespace {

constexpr std::size_t kChecksumBytes = 4;

// Symbols: invalid; the small zigzag numbers; four for each highest bit of the others, which have
// up to 17 bits. More small ones would be faster on noise and cost a structured light sensor, whose
// rare large errors would each need a frequency of their own.
constexpr std::uint32_t kInvalidSymbol = 0;
constexpr int kSmallBits = 5;
constexpr std::uint32_t kSmallNumbers = 1u << kSmallBits;
constexpr std::uint32_t kFirstLargeSymbol = 1 + kSmallNumbers;
constexpr std::size_t kSymbolCount = kFirstLargeSymbol + 4 * (17 - kSmallBits);
static_assert(kSymbolCount <= kMaxRansSymbols);

// Contexts: which of the neighbours are valid when not all are (15); their three differences when
// these are 0 or 1 either way (27); else how large they are, by powers of two.
constexpr std::uint32_t kFirstFlatContext = 15;
constexpr std::uint32_t kFirstSteepContext = kFirstFlatContext + 27;
constexpr std::uint32_t kSteepContexts = 13;
constexpr std::size_t kContextCount = kFirstSteepContext + kSteepContexts;

// The ranks of a band, with a frame of invalid ones above and beside it, so that every pixel has
// its four neighbours.
class Band {
 public:
  Band(int width, int height)
      : width_(width),
        height_(height),
        stride_(width + 2),
        ranks_(static_cast<std::size_t>(stride_) * static_cast<std::size_t>(height + 1)) {}
  std::uint16_t* row(int y) {
    return ranks_.data() + static_cast<std::size_t>(stride_) * static_cast<std::size_t>(y + 1) + 1;
  }
  int width() const { return width_; }
  int height() const { return height_; }
  int stride() const { return stride_; }

 private:
  int width_, height_, stride_;
  std::vector<std::uint16_t> ranks_;
};

// ---- model

struct Prediction {
  int rank;
  std::uint32_t context;
};

// Median edge detection (Weinberger et al. 1996): the plane through three neighbours, kept between
// the two nearest.
int median_edge(int west, int north, int north_west) {
  const int low = std::min(west, north), high = std::max(west, north);
  return std::clamp(west + north - north_west, low, high);
}

// `before` is the last valid rank of the band, for a pixel with invalid neighbours only.
// Called once a pixel from three loops: g++ leaves it out of line, which takes a quarter of the
// time.
[[gnu::always_inline]] inline Prediction predict(const std::uint16_t* pixel, int stride,
                                                 int before) {
  const int west = pixel[-1], north_west = pixel[-stride - 1], north = pixel[-stride],
            north_east = pixel[-stride + 1];
  if (west != 0 && north_west != 0 && north != 0 && north_east != 0) [[likely]] {
    const int a = west - north_west, b = north - north_west, c = north_east - north;
    const int rank = median_edge(west, north, north_west);
    if (static_cast<unsigned>(a + 1) <= 2 && static_cast<unsigned>(b + 1) <= 2 &&
        static_cast<unsigned>(c + 1) <= 2)
      return {rank, kFirstFlatContext + static_cast<std::uint32_t>(9 * a + 3 * b + c + 13)};
    // At least 2.
    const auto size = static_cast<std::uint32_t>(std::abs(a) + std::abs(b) + std::abs(c));
    return {rank,
            kFirstSteepContext +
                std::min(static_cast<std::uint32_t>(std::bit_width(size)) - 2, kSteepContexts - 1)};
  }
  const std::uint32_t context = (west != 0 ? 1u : 0u) | (north != 0 ? 2u : 0u) |
                                (north_west != 0 ? 4u : 0u) | (north_east != 0 ? 8u : 0u);
  if (west != 0 && north != 0 && north_west != 0)
    return {median_edge(west, north, north_west), context};
  return {west != 0         ? west
          : north != 0      ? north
          : north_west != 0 ? north_west
          : north_east != 0 ? north_east
                            : before,
          context};
}

// Of the symbols above the small numbers: the bits that follow.
constexpr int extra_bits(std::uint32_t symbol) {
  return kSmallBits - 2 + static_cast<int>((symbol - kFirstLargeSymbol) / 4);
}

struct Token {
  std::uint8_t context;
  std::uint8_t symbol;
  std::uint16_t extra;  // the bits behind the symbol
};

[[gnu::always_inline]] inline Token token_of(int rank, const Prediction& prediction) {
  const auto context = static_cast<std::uint8_t>(prediction.context);
  if (rank == 0) return {context, kInvalidSymbol, 0};
  const int difference = rank - prediction.rank;
  const std::uint32_t number =
      (static_cast<std::uint32_t>(difference) << 1) ^ static_cast<std::uint32_t>(difference >> 31);
  if (number < kSmallNumbers) [[likely]]
    return {context, static_cast<std::uint8_t>(1 + number), 0};
  const int extra_count = static_cast<int>(std::bit_width(number)) - 3;
  const std::uint32_t symbol = kFirstLargeSymbol +
                               4 * static_cast<std::uint32_t>(extra_count - (kSmallBits - 2)) +
                               ((number >> extra_count) & 3u);
  return {context, static_cast<std::uint8_t>(symbol),
          static_cast<std::uint16_t>(number & ((1u << extra_count) - 1))};
}

// ---- frequencies

using Counts = std::array<std::array<std::uint32_t, kSymbolCount>, kContextCount>;
// Empty for a context that is not used.
using Frequencies = std::array<std::vector<std::uint16_t>, kContextCount>;

Frequencies frequencies_of(const Counts& counts) {
  Frequencies frequencies;
  for (std::size_t context = 0; context < kContextCount; ++context) {
    std::size_t used = kSymbolCount;
    while (used > 0 && counts[context][used - 1] == 0) --used;
    if (used > 0) frequencies[context] = scale_frequencies({counts[context].data(), used});
  }
  return frequencies;
}

void write_frequencies(const Frequencies& frequencies, BitWriter& header) {
  for (const std::vector<std::uint16_t>& context : frequencies) {
    header.put(context.empty() ? 0 : 1, 1);
    std::uint32_t zeros_and_one = 1;
    for (const std::uint16_t frequency : context) {
      if (frequency == 0) {
        ++zeros_and_one;
        continue;
      }
      header.put_gamma(zeros_and_one);
      header.put_gamma(frequency);
      zeros_and_one = 1;
    }
  }
}

Result<std::vector<std::uint16_t>> read_frequencies(BitReader& header) {
  std::vector<std::uint16_t> frequencies;
  if (header.get(1) == 0) return frequencies;
  for (std::uint32_t left = kFrequencySum; left > 0;) {
    const std::uint32_t zeros_and_one = header.get_gamma();
    if (zeros_and_one == 0 || zeros_and_one > kSymbolCount - frequencies.size())
      return corrupt_depth("frequencies of more symbols than there are");
    const std::uint32_t frequency = header.get_gamma();
    if (frequency == 0 || frequency > left) return corrupt_depth("frequencies beyond their sum");
    frequencies.resize(frequencies.size() + zeros_and_one - 1);
    frequencies.push_back(static_cast<std::uint16_t>(frequency));
    left -= frequency;
  }
  return frequencies;
}

Result<Frequencies> read_all_frequencies(BitReader& header) {
  Frequencies frequencies;
  for (std::size_t context = 0; context < kContextCount; ++context) {
    auto read = read_frequencies(header);
    if (!read.ok()) return in_context("context " + std::to_string(context), read.error());
    frequencies[context] = *std::move(read);
  }
  return frequencies;
}

// ---- checksum

// Four pixels at a time; finds damage, resists no intent.
std::uint32_t checksum_of(std::span<const std::uint16_t> pixels) {
  constexpr std::uint64_t kOdd = 0x9e3779b97f4a7c15;
  std::uint64_t sum = pixels.size();
  const auto add = [&sum](std::span<const std::uint16_t> some) {
    std::uint64_t four = 0;
    std::memcpy(&four, some.data(), some.size_bytes());
    sum = (sum ^ four) * kOdd;
    sum ^= sum >> 32;
  };
  const std::size_t whole = pixels.size() / 4 * 4;
  for (std::size_t at = 0; at < whole; at += 4) add(pixels.subspan(at, 4));
  if (whole < pixels.size()) add(pixels.subspan(whole));
  return static_cast<std::uint32_t>(sum);
}

// ---- the image

constexpr int upper_rows(int height) { return (height + 1) / 2; }

std::array<Band, kRansLanes> make_bands(int width, int height) {
  return {Band(width, upper_rows(height)), Band(width, height / 2)};
}

// Where the rows of a band begin in the image.
std::size_t first_pixel(int lane, int width, int height) {
  return lane == 0 ? 0
                   : static_cast<std::size_t>(upper_rows(height)) * static_cast<std::size_t>(width);
}

void fill_band(Band& band, const std::uint16_t* pixels, const std::vector<std::uint16_t>& rank_of) {
  for (int y = 0; y < band.height(); ++y) {
    std::uint16_t* row = band.row(y);
    for (int x = 0; x < band.width(); ++x) row[x] = rank_of[*pixels++];
  }
}

std::vector<Token> tokens_of(Band& band, Counts& counts) {
  std::vector<Token> tokens(static_cast<std::size_t>(band.width()) *
                            static_cast<std::size_t>(band.height()));
  Token* next = tokens.data();
  int before = 1;
  for (int y = 0; y < band.height(); ++y) {
    const std::uint16_t* row = band.row(y);
    for (int x = 0; x < band.width(); ++x) {
      const Token token = token_of(row[x], predict(row + x, band.stride(), before));
      if (row[x] != 0) before = row[x];
      ++counts[token.context][token.symbol];
      *next++ = token;
    }
  }
  return tokens;
}

using Shares = std::array<std::array<RansShare, kSymbolCount>, kContextCount>;

// What the decoder reads first comes last.
inline void put_token(RansEncoder& encoder, int lane, const Token& token, const Shares& shares) {
  if (token.symbol >= kFirstLargeSymbol)
    encoder.put_bits(lane, token.extra, extra_bits(token.symbol));
  encoder.put(lane, shares[token.context][token.symbol]);
}

class PixelDecoder {
 public:
  PixelDecoder(std::span<const std::uint8_t> words, const Frequencies& frequencies, int highest)
      : decoder_(words), slots_(kContextCount), highest_(highest) {
    for (std::size_t context = 0; context < kContextCount; ++context)
      if (!frequencies[context].empty()) fill_slots(frequencies[context], slots_[context]);
  }

  // False when no such rank exists.
  [[gnu::always_inline]] bool decode(int lane, std::uint16_t* pixel, int stride) {
    int& before = before_[static_cast<std::size_t>(lane)];
    const Prediction prediction = predict(pixel, stride, before);
    const std::uint32_t symbol = decoder_.get(lane, slots_[prediction.context]);
    if (symbol == kInvalidSymbol) {
      *pixel = 0;
      return true;
    }
    std::uint32_t number = symbol - 1;
    if (symbol >= kFirstLargeSymbol) {
      if (symbol == kNoRansSymbol) return false;  // a context that is not used
      const int extra_count = extra_bits(symbol);
      number = ((4u | ((symbol - kFirstLargeSymbol) & 3u)) << extra_count) |
               decoder_.get_bits(lane, extra_count);
    }
    const int rank =
        prediction.rank + (static_cast<int>(number >> 1) ^ -static_cast<int>(number & 1u));
    *pixel = static_cast<std::uint16_t>(rank);
    before = *pixel;
    return rank >= 1 && rank <= highest_;
  }
  bool at_end() const { return decoder_.at_end(); }

 private:
  RansDecoder decoder_;
  std::vector<RansSlots> slots_;  // by context
  std::array<int, kRansLanes> before_{1, 1};
  int highest_;
};

Status decode_bands(PixelDecoder& decoder, std::array<Band, kRansLanes>& bands) {
  for (int y = 0; y < bands[0].height(); ++y) {
    std::uint16_t* upper = bands[0].row(y);
    std::uint16_t* lower = y < bands[1].height() ? bands[1].row(y) : nullptr;
    bool valid = true;
    for (int x = 0; x < bands[0].width(); ++x) {
      valid &= decoder.decode(0, upper + x, bands[0].stride());
      if (lower != nullptr) valid &= decoder.decode(1, lower + x, bands[1].stride());
    }
    if (!valid)
      return corrupt_depth(
          fmt::format("a rank that the dictionary has not, in row {} of a band", y));
  }
  if (!decoder.at_end()) return corrupt_depth("the words do not end with the last pixel");
  return Done{};
}

void fill_pixels(Band& band, std::uint16_t* pixels, const RankDictionary& dictionary) {
  for (int y = 0; y < band.height(); ++y) {
    const std::uint16_t* row = band.row(y);
    for (int x = 0; x < band.width(); ++x)
      *pixels++ = dictionary.empty() ? row[x] : dictionary[row[x]];
  }
}

}  // namespace

std::vector<std::uint8_t> encode_depth_ranks(const DepthImage& depth) {
  CHECK(check_image_size({depth.width, depth.height}).ok(),
        "depth image to encode has no valid size");
  CHECK(depth.pixels.size() ==
            static_cast<std::size_t>(depth.width) * static_cast<std::size_t>(depth.height),
        "depth image has other pixels than its size");
  const RankDictionary dictionary = find_rank_dictionary(depth.pixels);
  const std::vector<std::uint16_t> rank_of = ranks_by_value(dictionary);
  std::array<Band, kRansLanes> bands = make_bands(depth.width, depth.height);
  std::array<std::vector<Token>, kRansLanes> tokens;
  const auto counts = std::make_unique<Counts>();
  for (int lane = 0; lane < kRansLanes; ++lane) {
    Band& band = bands[static_cast<std::size_t>(lane)];
    fill_band(band, depth.pixels.data() + first_pixel(lane, depth.width, depth.height), rank_of);
    tokens[static_cast<std::size_t>(lane)] = tokens_of(band, *counts);
  }

  const Frequencies frequencies = frequencies_of(*counts);
  BitWriter header;
  header.put(checksum_of(depth.pixels), 8 * kChecksumBytes);
  write_rank_dictionary(dictionary, header);
  write_frequencies(frequencies, header);
  std::vector<std::uint8_t> bytes = std::move(header).finish();

  const auto shares = std::make_unique<Shares>();
  for (std::size_t context = 0; context < kContextCount; ++context)
    if (!frequencies[context].empty()) fill_shares(frequencies[context], (*shares)[context]);
  RansEncoder encoder;
  for (std::size_t at = tokens[0].size(); at-- > 0;) {
    if (at < tokens[1].size()) put_token(encoder, 1, tokens[1][at], *shares);
    put_token(encoder, 0, tokens[0][at], *shares);
  }
  std::move(encoder).finish(bytes);
  return bytes;
}

Result<DepthImage> decode_depth_ranks(std::span<const std::uint8_t> bytes, ImageSize expected) {
  if (const Status valid = check_image_size(expected); !valid.ok()) return valid.error();
  const std::size_t max_bytes = max_depth_ranks_bytes(static_cast<std::size_t>(expected.width) *
                                                      static_cast<std::size_t>(expected.height));
  if (bytes.size() > max_bytes) {
    return Error{
        ErrorCode::kTooLarge,
        fmt::format("depth: {} bytes, the limit for this image is {}", bytes.size(), max_bytes)};
  }
  BitReader header(bytes);
  const std::uint32_t checksum = header.get(8 * kChecksumBytes);
  const Result<RankDictionary> dictionary = read_rank_dictionary(header);
  if (!dictionary.ok()) return dictionary.error();
  const Result<Frequencies> frequencies = read_all_frequencies(header);
  if (!frequencies.ok()) return frequencies.error();
  if (header.cut() || !header.padding_is_zero())
    return corrupt_depth("the header is cut or damaged");

  PixelDecoder decoder(header.rest(), *frequencies, highest_rank(*dictionary));
  std::array<Band, kRansLanes> bands = make_bands(expected.width, expected.height);
  if (const Status decoded = decode_bands(decoder, bands); !decoded.ok()) return decoded.error();
  DepthImage depth(expected.width, expected.height);
  for (int lane = 0; lane < kRansLanes; ++lane)
    fill_pixels(bands[static_cast<std::size_t>(lane)],
                depth.pixels.data() + first_pixel(lane, expected.width, expected.height),
                *dictionary);
  if (checksum_of(depth.pixels) != checksum)
    return corrupt_depth("the pixels have another checksum");
  return depth;
}

}  // namespace hermite::image
