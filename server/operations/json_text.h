// JSON as sent by this server. Header only.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace hermite::server {

// Returns one line. Invalid UTF-8, which may come from clients, becomes replacement characters.
inline std::string json_text(const nlohmann::ordered_json& json) {
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace hermite::server
