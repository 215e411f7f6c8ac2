#include "core/disturb/key_values.h"

#include <fmt/core.h>

#include <algorithm>
#include <set>

#include "core/dataset/text_file.h"

namespace hermite::disturb {
namespace {

std::string keys_of(const std::vector<KeyValueRule>& rules) {
  std::string keys;
  for (const KeyValueRule& rule : rules) keys += (keys.empty() ? "" : ", ") + rule.key;
  return keys;
}

Status apply_one(std::string_view item, const std::vector<KeyValueRule>& rules,
                 std::set<std::string>& seen) {
  const std::size_t equals = item.find('=');
  if (equals == std::string_view::npos)
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("\"{}\" is not key=value (keys: {})", item, keys_of(rules))};
  const std::string key(item.substr(0, equals)), value(item.substr(equals + 1));
  const auto rule = std::find_if(rules.begin(), rules.end(), [&](const KeyValueRule& candidate) {
    return candidate.key == key;
  });
  if (rule == rules.end())
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("there is no option \"{}\" (there are: {})", key, keys_of(rules))};
  if (!seen.insert(key).second)
    return Error{ErrorCode::kInvalidArgument, fmt::format("option \"{}\" is given twice", key)};
  if (!rule->take(value))
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("option {} is \"{}\", allowed is {}", key, value, rule->allowed)};
  return Done{};
}

}  // namespace

Status apply_key_values(std::string_view text, const std::vector<KeyValueRule>& rules) {
  if (text.empty()) return Done{};
  std::set<std::string> seen;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    if (const Status status = apply_one(text.substr(begin, end - begin), rules, seen); !status.ok())
      return status;
    begin = end + 1;
  }
  return Done{};
}

KeyValueRule number_rule(const std::string& key, double low, double high, double& target) {
  return {key, fmt::format("a number from {:g} to {:g}", low, high),
          [=, &target](std::string_view text) {
            const auto value = dataset::parse_finite(text);
            if (!value || *value < low || *value > high) return false;
            target = *value;
            return true;
          }};
}

KeyValueRule whole_rule(const std::string& key, std::int64_t low, std::int64_t high,
                        const std::function<void(std::int64_t)>& take) {
  return {key, fmt::format("a whole number from {} to {}", low, high), [=](std::string_view text) {
            const auto value = dataset::parse_index(text);
            if (!value || *value < low || *value > high) return false;
            take(*value);
            return true;
          }};
}

KeyValueRule seed_rule(std::uint64_t& target) {
  return whole_rule("seed", 0, INT64_MAX,
                    [&target](std::int64_t value) { target = static_cast<std::uint64_t>(value); });
}

}  // namespace hermite::disturb
