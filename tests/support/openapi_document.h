// server/openapi.json, for tests that compare it with the routes of the server. Header only.
#pragma once

#include <cctype>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/source_root/source_root.h"

namespace hermite::test {

inline constexpr const char* kOpenApiFile = "server/openapi.json";

// Throws nlohmann's parse_error for text that is not JSON.
inline nlohmann::json openapi_document() {
  std::ifstream file(source_root() / kOpenApiFile);
  return nlohmann::json::parse(file);
}

// Every operation, by "GET /api/v1/scans/{id}".
inline std::map<std::string, nlohmann::json> described_operations(const nlohmann::json& document) {
  std::map<std::string, nlohmann::json> operations;
  for (const auto& [path, item] : document.at("paths").items())
    for (const auto& [field, value] : item.items()) {
      if (field == "parameters" || field == "servers") continue;
      std::string method;
      for (const char c : field)
        method += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
      operations[method + " " + path] = value;
    }
  return operations;
}

}  // namespace hermite::test
