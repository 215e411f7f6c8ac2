#include "server/client/json_call.h"

#include <utility>

namespace hermite::client {

Result<nlohmann::ordered_json> json_call(const ServerUrl& server, const server::TlsContext& tls,
                                         HttpCall call) {
  const Result<std::string> body = accepted_body(server, tls, true, std::move(call));
  if (!body.ok()) return body.error();
  nlohmann::ordered_json json = nlohmann::ordered_json::parse(*body, nullptr, false);
  if (!json.is_object()) return Error{ErrorCode::kIo, "the server's answer is no JSON object"};
  return json;
}

std::string text_member(const nlohmann::ordered_json& object, const char* name) {
  const auto found = object.find(name);
  return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

std::int64_t integer_member(const nlohmann::ordered_json& object, const char* name) {
  const auto found = object.find(name);
  return found != object.end() && found->is_number_integer() ? found->get<std::int64_t>() : 0;
}

}  // namespace hermite::client
