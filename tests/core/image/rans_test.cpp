#include "core/image/rans.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numeric>
#include <random>

namespace hermite::image {
namespace {

using Bytes = std::vector<std::uint8_t>;
using Counts = std::vector<std::uint32_t>;
using Frequencies = std::vector<std::uint16_t>;

TEST(Rans, FrequenciesKeepTheirSumAndLoseNoSymbol) {
  EXPECT_EQ(scale_frequencies(Counts{7}), (Frequencies{kFrequencySum}));
  EXPECT_EQ(scale_frequencies(Counts{1, 0, 3}),
            (Frequencies{kFrequencySum / 4, 0, kFrequencySum * 3 / 4}));
  EXPECT_EQ(scale_frequencies(Counts{1, 4'000'000'000}), (Frequencies{1, kFrequencySum - 1}));
  std::mt19937 random(5);
  for (int trial = 0; trial < 2000; ++trial) {
    Counts counts(1 + random() % kMaxRansSymbols);
    for (std::uint32_t& count : counts)
      count = random() % 3 == 0 ? 0 : static_cast<std::uint32_t>(random() >> (8 + random() % 24));
    counts[random() % counts.size()] += 1;
    const Frequencies frequencies = scale_frequencies(counts);
    EXPECT_EQ(std::accumulate(frequencies.begin(), frequencies.end(), 0u), kFrequencySum);
    for (std::size_t i = 0; i < counts.size(); ++i) EXPECT_EQ(counts[i] == 0, frequencies[i] == 0);
  }
}

// A symbol, and maybe bits behind it.
struct Item {
  int lane;
  std::uint32_t symbol;
  std::uint32_t bits;
  int bit_count;
};

struct Code {
  std::vector<RansShare> shares;
  std::unique_ptr<RansSlots> slots = std::make_unique<RansSlots>();
  explicit Code(const Frequencies& frequencies) : shares(frequencies.size()) {
    fill_shares(frequencies, shares);
    fill_slots(frequencies, *slots);
  }
};

Bytes encode(const std::vector<Item>& items, const Code& code, Bytes header = {}) {
  RansEncoder encoder;
  for (auto item = items.rbegin(); item != items.rend(); ++item) {
    encoder.put_bits(item->lane, item->bits, item->bit_count);
    encoder.put(item->lane, code.shares[item->symbol]);
  }
  std::move(encoder).finish(header);
  return header;
}

std::vector<Item> some_items(std::size_t count, std::discrete_distribution<std::uint32_t> symbols) {
  std::mt19937 random(9);
  std::vector<Item> items(count);
  for (Item& item : items) {
    const int bit_count = random() % 4 == 0 ? static_cast<int>(random() % 16) : 0;
    item = {static_cast<int>(random() % kRansLanes), symbols(random),
            static_cast<std::uint32_t>(random() & ((1u << bit_count) - 1)), bit_count};
  }
  return items;
}

TEST(Rans, DecodesWhatWasEncodedBehindAnyHeader) {
  for (const Counts& counts : {Counts{1000, 1, 20, 300}, Counts{5}, Counts{1, 1, 1},
                               Counts(kMaxRansSymbols, 1), Counts{0, 0, 1, 1'000'000}}) {
    const Code code(scale_frequencies(counts));
    const std::vector<Item> items = some_items(20000, {counts.begin(), counts.end()});
    const Bytes bytes = encode(items, code, {1, 2, 3});
    RansDecoder decoder({bytes.data() + 3, bytes.size() - 3});
    for (const Item& item : items) {
      ASSERT_EQ(decoder.get(item.lane, *code.slots), item.symbol);
      ASSERT_EQ(decoder.get_bits(item.lane, item.bit_count), item.bits);
    }
    EXPECT_TRUE(decoder.at_end());
  }
}

TEST(Rans, SlotsThatWereNeverFilledHaveNoSymbol) {
  const auto slots = std::make_unique<RansSlots>();
  const Bytes bytes(100, 0x5a);
  RansDecoder decoder(bytes);
  EXPECT_EQ(decoder.get(0, *slots), kNoRansSymbol);
  EXPECT_EQ(decoder.get(1, *slots), kNoRansSymbol);
}

TEST(Rans, TakesLittleMoreThanTheEntropy) {
  const Counts counts{9000, 700, 250, 50};
  const Code code(scale_frequencies(counts));
  std::vector<Item> items = some_items(100000, {counts.begin(), counts.end()});
  double entropy_bits = 0;
  for (Item& item : items) {
    item.bits = 0;
    item.bit_count = 0;
    entropy_bits -= std::log2(counts[item.symbol] / 10000.0);
  }
  EXPECT_LT(8.0 * static_cast<double>(encode(items, code).size()), entropy_bits * 1.002 + 64);
}

TEST(Rans, MissingAndSuperfluousWordsAreSeen) {
  const Code code(scale_frequencies(Counts{5, 3, 1}));
  const std::vector<Item> items = some_items(500, {5, 3, 1});
  const Bytes whole = encode(items, code);
  const auto ends_well = [&](const Bytes& bytes) {
    RansDecoder decoder(bytes);
    for (const Item& item : items) {
      decoder.get(item.lane, *code.slots);
      decoder.get_bits(item.lane, item.bit_count);
    }
    return decoder.at_end();
  };
  EXPECT_TRUE(ends_well(whole));
  for (std::size_t length = 0; length < whole.size(); ++length) {
    EXPECT_FALSE(ends_well({whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length)}))
        << "without the end, " << length;
    EXPECT_FALSE(ends_well({whole.end() - static_cast<std::ptrdiff_t>(length), whole.end()}))
        << "without the beginning, " << length;
  }
  Bytes longer = whole;
  longer.insert(longer.begin(), 2, 0);
  EXPECT_FALSE(ends_well(longer));
}

}  // namespace
}  // namespace hermite::image
