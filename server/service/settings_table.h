// The table of the settings of `hermite serve`, with a row for each field of ServiceOptions that is
// one: its name, its limits and what --help and the file say of it. settings.h reads and writes
// values by it. A new setting needs one field and one row.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "server/service/service.h"

namespace hermite::server {

using SettingField =
    std::variant<std::string ServiceOptions::*, int ServiceOptions::*, bool ServiceOptions::*,
                 std::vector<std::string> ServiceOptions::*>;

struct SettingRow {
  const char* key;  // "max-scans"
  SettingField field;
  const char* description;  // one line
  int low = 0, high = 0;    // inclusive range of numbers
  const char* unit = "";
  std::vector<std::string> choices = {};  // of texts; empty: any
};

// Returns all rows, in the order in which they are listed to users. Thread-safe.
const std::vector<SettingRow>& setting_rows();

}  // namespace hermite::server
