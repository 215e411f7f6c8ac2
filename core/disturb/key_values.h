// "key=value,key=value": the syntax of options that users append to a source. Pure functions.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"

namespace hermite::disturb {

// One option: its key, the allowed values as text, and a function that takes a value and returns
// false if it is out of range.
struct KeyValueRule {
  std::string key;
  std::string allowed;
  std::function<bool(std::string_view value)> take;
};

// Applies the rules for all keys in `text`. kInvalidArgument for an unknown key (naming the known
// ones), a repeated key, a value that its rule rejects (naming what is allowed), and text that is
// no list of key=value. Empty text is allowed.
Status apply_key_values(std::string_view text, const std::vector<KeyValueRule>& rules);

// Rules for numbers; the range is inclusive and is used for the rule's text.
KeyValueRule number_rule(const std::string& key, double low, double high, double& target);
KeyValueRule whole_rule(const std::string& key, std::int64_t low, std::int64_t high,
                        const std::function<void(std::int64_t)>& take);
// A rule for "seed", any whole number from 0.
KeyValueRule seed_rule(std::uint64_t& target);

}  // namespace hermite::disturb
