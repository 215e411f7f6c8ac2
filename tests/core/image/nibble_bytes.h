// Depth compressed as OpenNI's recorder does it, for fixtures: see core/image/nibble_depth.h.
// Header only.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <map>
#include <vector>

#include "core/base/check.h"
#include "core/base/image.h"

namespace hermite::test {

// Values below 32768: others cannot be told from differences.
inline std::vector<std::uint8_t> nibble_bytes(const std::vector<std::uint16_t>& values) {
  const auto byte = [](int value) { return static_cast<std::uint8_t>(value); };
  std::vector<std::uint8_t> bytes{byte(values[0] & 0xff), byte(values[0] >> 8)};
  int half = -1, pairs_of_zero = 0;  // half: a difference that waits for its neighbour
  const auto end_run = [&] {
    if (pairs_of_zero > 0) bytes.push_back(byte(0xe0 + pairs_of_zero));
    pairs_of_zero = 0;
  };
  for (std::size_t i = 1; i < values.size(); ++i) {
    const int difference = values[i - 1] - values[i];
    if (std::abs(difference) <= 6) {
      const int nibble = difference + 6;
      if (half < 0) {
        half = nibble;
        continue;
      }
      if (half == 6 && nibble == 6) {
        if (++pairs_of_zero == 15) end_run();
      } else {
        end_run();
        bytes.push_back(byte(half << 4 | nibble));
      }
      half = -1;
      continue;
    }
    end_run();
    bytes.push_back(byte(half < 0 ? 0xff : half << 4 | 0x0f));
    half = -1;
    if (std::abs(difference) <= 63) {
      bytes.push_back(byte(difference + 192));
    } else {
      CHECK(values[i] < 0x8000, "a value that this coding cannot hold");
      bytes.push_back(byte(values[i] >> 8));
      bytes.push_back(byte(values[i] & 0xff));
    }
  }
  end_run();
  if (half >= 0) bytes.push_back(byte(half << 4 | 0x0d));
  return bytes;
}

inline std::vector<std::uint8_t> nibble_bytes_with_table(const std::vector<std::uint16_t>& values) {
  std::map<std::uint16_t, std::uint16_t> places;
  for (const std::uint16_t value : values) places[value] = 0;
  std::vector<std::uint8_t> bytes{static_cast<std::uint8_t>(places.size()),
                                  static_cast<std::uint8_t>(places.size() >> 8)};
  std::uint16_t next = 0;
  for (auto& [value, place] : places) {
    place = next++;
    bytes.push_back(static_cast<std::uint8_t>(value));
    bytes.push_back(static_cast<std::uint8_t>(value >> 8));
  }
  std::vector<std::uint16_t> coded;
  for (const std::uint16_t value : values) coded.push_back(places[value]);
  const std::vector<std::uint8_t> rest = nibble_bytes(coded);
  bytes.insert(bytes.end(), rest.begin(), rest.end());
  return bytes;
}

}  // namespace hermite::test
