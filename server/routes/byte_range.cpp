#include "server/routes/byte_range.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <utility>

namespace hermite::server {

namespace {

// Returns the only header of that name; a repeated header is not reliable and counts as none.
std::optional<std::string> only_header(const HttpRequest& request, std::string_view name) {
  const auto same = [](char a, char b) { return (a >= 'A' && a <= 'Z' ? a - 'A' + 'a' : a) == b; };
  std::optional<std::string> found;
  for (const auto& [given, value] : request.headers) {
    if (!std::equal(given.begin(), given.end(), name.begin(), name.end(), same)) continue;
    if (found) return std::nullopt;
    found = value;
  }
  return found;
}

std::optional<std::uint64_t> number_of(std::string_view digits) {
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  return error == std::errc() && end == digits.data() + digits.size() ? std::optional(number)
                                                                      : std::nullopt;
}

struct ByteRange {
  std::uint64_t first = 0, size_bytes = 0;  // size 0: the file has nothing of the range
};

// Returns std::nullopt if the header is malformed or has more than one range.
std::optional<ByteRange> parse_range(std::string_view text, std::uint64_t size_bytes) {
  constexpr std::string_view kUnit = "bytes=";
  if (!text.starts_with(kUnit)) return std::nullopt;
  text.remove_prefix(kUnit.size());
  const std::size_t dash = text.find('-');
  if (dash == std::string_view::npos) return std::nullopt;
  const std::string_view from = text.substr(0, dash), to = text.substr(dash + 1);
  const std::optional<std::uint64_t> first = number_of(from), last = number_of(to);
  if ((!from.empty() && !first) || (!to.empty() && !last) || (from.empty() && to.empty()))
    return std::nullopt;
  if (!first) {  // the last bytes, as many as given
    const std::uint64_t count = std::min(*last, size_bytes);
    return ByteRange{size_bytes - count, count};
  }
  if (last && *last < *first) return std::nullopt;
  if (*first >= size_bytes) return ByteRange{};
  return ByteRange{*first, std::min(last.value_or(size_bytes - 1), size_bytes - 1) - *first + 1};
}

}  // namespace

HttpAnswer as_asked(HttpAnswer answer, const std::string& entity_tag, const HttpRequest& request) {
  if (!answer.stored) return answer;
  const std::string quoted = fmt::format("\"{}\"", entity_tag);
  answer.headers.emplace_back("Accept-Ranges", "bytes");
  answer.headers.emplace_back("ETag", quoted);
  const std::optional<std::string> wanted = only_header(request, "range");
  if (!wanted || request.method != "GET") return answer;
  // A date or a weak tag never matches.
  if (const std::optional<std::string> condition = only_header(request, "if-range");
      condition && *condition != quoted)
    return answer;
  const std::uint64_t size_bytes = answer.stored->size_bytes;
  const std::optional<ByteRange> range = parse_range(*wanted, size_bytes);
  if (!range) return answer;
  if (range->size_bytes == 0) {
    HttpAnswer none = error_answer(
        416, {ErrorCode::kInvalidArgument,
              fmt::format("the file has {} bytes, none of them is in the range", size_bytes)});
    none.headers.emplace_back("Content-Range", fmt::format("bytes */{}", size_bytes));
    return none;
  }
  answer.status = 206;
  answer.headers.emplace_back("Content-Range",
                              fmt::format("bytes {}-{}/{}", range->first,
                                          range->first + range->size_bytes - 1, size_bytes));
  answer.stored->first_byte = range->first;
  answer.stored->size_bytes = range->size_bytes;
  return answer;
}

}  // namespace hermite::server
