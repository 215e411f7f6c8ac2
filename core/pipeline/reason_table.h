// Why frames were weak or lost, as text, each text once: frames keep its number. One thread at a
// time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "core/base/byte_stream.h"

namespace hermite::pipeline {

// The longest reason of today has 183: a calibration that does not fit, while the map is full.
inline constexpr std::size_t kMaxReasonBytes = 200;

// There are some thirty sentences with rounded numbers in them, so that even a scan of hours that
// goes badly has hundreds of reasons. A full table takes 6 MB, however many frames there are.
inline constexpr std::size_t kMaxReasons = 10'000;

inline constexpr std::uint16_t kNoReason = 0;

// Returns whether it is one line of 1 to kMaxReasonBytes bytes of UTF-8 without control characters.
bool is_reason(const std::string& text);

class ReasonTable {
 public:
  // Returns the number of this text, which is kNoReason for an empty one, and for a new one when
  // the table is full. What is no reason is made one: control characters become spaces, and what is
  // too long is cut.
  std::uint16_t number_of(const std::string& text);

  // Empty for kNoReason. `number` was returned by number_of().
  const std::string& text_of(std::uint16_t number) const;

  std::size_t size() const { return texts_.size(); }  // numbers are at most this

  void save(ByteWriter& bytes) const;
  void restore(ByteReader& bytes);

 private:
  std::vector<std::string> texts_;  // by number - 1
  std::map<std::string, std::uint16_t> numbers_;
};

}  // namespace hermite::pipeline
