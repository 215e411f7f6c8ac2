// What a load test says at its end. Pure functions.
#pragma once

#include <string>
#include <vector>

#include "server/client/load_statistics.h"

namespace hermite::client {

// Returns what has to be known to read the numbers, in whole sentences: by what they are limited or
// what they leave out.
std::vector<std::string> load_notes(const LoadResult& result);

// Returns the result for people: a table with a row for each camera (of more than kMaxLoadRows
// those whose answers took longest) and lines below it.
std::string format_load_report(const LoadResult& result);
inline constexpr std::size_t kMaxLoadRows = 16;

// Returns one JSON object on one line, with everything.
std::string load_report_json(const LoadResult& result);

}  // namespace hermite::client
