// Time as HTTP has it.
#pragma once

#include <cstdint>
#include <string>

namespace hermite::server {

// Returns for example "Wed, 25 Jun 2014 16:00:00 GMT" (RFC 9110, 5.6.7), whatever the locale is.
std::string http_date(std::int64_t unix_ms);

}  // namespace hermite::server
