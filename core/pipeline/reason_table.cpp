#include "core/pipeline/reason_table.h"

#include <algorithm>

#include "core/base/check.h"
#include "core/base/utf8.h"

namespace hermite::pipeline {

namespace {

std::string made_a_reason(const std::string& text) {
  std::string reason = readable_utf8(text);
  std::ranges::replace_if(reason, is_control, ' ');
  if (reason.size() <= kMaxReasonBytes) return reason;
  std::size_t end = 0;
  while (end + utf8_length(reason, end) <= kMaxReasonBytes) end += utf8_length(reason, end);
  return reason.substr(0, end);
}

}  // namespace

bool is_reason(const std::string& text) {
  if (text.empty() || text.size() > kMaxReasonBytes || std::ranges::any_of(text, is_control))
    return false;
  for (std::size_t at = 0, length = 0; at < text.size(); at += length)
    if ((length = utf8_length(text, at)) == 0) return false;
  return true;
}

std::uint16_t ReasonTable::number_of(const std::string& text) {
  if (text.empty()) return kNoReason;
  const std::string reason = is_reason(text) ? text : made_a_reason(text);
  if (const auto known = numbers_.find(reason); known != numbers_.end()) return known->second;
  if (texts_.size() == kMaxReasons) return kNoReason;
  texts_.push_back(reason);
  return numbers_[reason] = static_cast<std::uint16_t>(texts_.size());
}

const std::string& ReasonTable::text_of(std::uint16_t number) const {
  static const std::string none;
  CHECK(number <= texts_.size(), "the number is of another table");
  return number == kNoReason ? none : texts_[number - 1u];
}

void ReasonTable::save(ByteWriter& bytes) const {
  bytes.list(texts_, [](ByteWriter& to, const std::string& text) { to.text(text); });
}

void ReasonTable::restore(ByteReader& bytes) {
  std::vector<std::string> texts;
  bytes.list(texts, [](ByteReader& from, std::string& text) { from.text(text); });
  bytes.require(texts.size() <= kMaxReasons, "there are too many reasons");
  *this = {};
  for (std::size_t i = 0; i < texts.size() && bytes.ok(); ++i)
    bytes.require(is_reason(texts[i]) && number_of(texts[i]) == i + 1,
                  "a reason is invalid, or is there twice");
}

}  // namespace hermite::pipeline
