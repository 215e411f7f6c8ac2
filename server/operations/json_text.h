// JSON as this server sends it. Header only.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace hermite {

// One line. Whatever of a client's texts is no UTF-8 becomes a replacement character.
inline std::string json_text(const nlohmann::ordered_json& json) {
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace hermite
