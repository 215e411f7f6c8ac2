#include "server/store/http_date.h"

#include <fmt/chrono.h>

#include <ctime>

namespace hermite::server {

std::string http_date(std::int64_t unix_ms) {
  return fmt::format("{:%a, %d %b %Y %H:%M:%S} GMT",
                     fmt::gmtime(static_cast<std::time_t>(unix_ms / 1000)));
}

}  // namespace hermite::server
