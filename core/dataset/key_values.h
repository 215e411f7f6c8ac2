// "key=value,key=value": how users write options behind a source. Pure functions.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"

namespace hermite {

// One option: its key, what is allowed in words, and what takes a value (false when it is out of range).
struct KeyValueRule {
  std::string key;
  std::string allowed;
  std::function<bool(std::string_view value)> take;
};

// Applies every rule that `text` names, once each. kInvalidArgument: an unknown key (naming the known ones), a repeated key,
// a value its rule does not take (naming what is allowed), text that is no key=value list. Empty text is fine.
Status apply_key_values(std::string_view text, const std::vector<KeyValueRule>& rules);

// Rules for numbers; the range is inclusive and becomes the rule's words.
KeyValueRule number_rule(const std::string& key, double low, double high, double& target);
KeyValueRule whole_rule(const std::string& key, std::int64_t low, std::int64_t high, const std::function<void(std::int64_t)>& take);
// "seed", any whole number from 0.
KeyValueRule seed_rule(std::uint64_t& target);

}  // namespace hermite
