#include "server/scan/scan_record.h"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>
#include <variant>

#include "core/digest/sha256.h"
#include "proto/wire/client_message.h"
#include "server/access/access.h"

namespace hermite::server {

namespace {

Error corrupt(const std::string& message) {
  return {ErrorCode::kCorruptData, "the record of the scan: " + message};
}

}  // namespace

std::string format_terms(const ScanRecord& record) {
  const nlohmann::json terms = {{"resume_token_sha256", record.resume_token_sha256},
                                {"gpu_memory_mb", record.gpu_memory_mb},
                                {"credit_window", record.credit_window}};
  return terms.dump();
}

std::string format_start(const ScanRecord& record) {
  return wire::format_client_message(wire::Hello{wire::kProtocolMinor, "", "", record.request});
}

Result<ScanRecord> parse_scan_record(const std::string& terms, const std::string& start) {
  ScanRecord record;
  const nlohmann::json json = nlohmann::json::parse(terms, nullptr, false);
  const auto number = [&json](const char* name, int low, int high) -> std::optional<int> {
    const auto found = json.is_object() ? json.find(name) : json.end();
    if (found == json.end() || !found->is_number_integer() || *found < low || *found > high)
      return std::nullopt;
    return found->get<int>();
  };
  const std::optional<int> memory_mb = number("gpu_memory_mb", 0, 1'000'000),
                           window = number("credit_window", 1, 256);
  if (!memory_mb || !window || !json.contains("resume_token_sha256") ||
      !json["resume_token_sha256"].is_string())
    return corrupt("the terms are not what this program writes");
  record.gpu_memory_mb = *memory_mb;
  record.credit_window = static_cast<std::uint32_t>(*window);
  record.resume_token_sha256 = json["resume_token_sha256"];
  Result<wire::ClientMessage> message =
      wire::parse_client_message(start, wire::kMaxBytesBeforeWelcome);
  if (!message.ok()) return in_context("the record of the scan", message.error());
  wire::Hello* const hello = std::get_if<wire::Hello>(&*message);
  if (!hello || !std::holds_alternative<wire::StartScan>(hello->role))
    return corrupt("the first record is not the Hello message of a camera");
  record.request = std::get<wire::StartScan>(std::move(hello->role));
  return record;
}

Status check_resume_token(const std::string& token, const std::string& resume_token_sha256) {
  if (!resume_token_sha256.empty() && tokens_equal(digest::sha256_hex(token), resume_token_sha256))
    return Done{};
  return Error{ErrorCode::kUnauthorized, "resume_scan.resume_token is not the one of this scan"};
}

Result<pipeline::Options> options_of(const ScanRecord& record) {
  pipeline::Options options;
  for (const auto& [key, value] : record.request.settings)
    if (Status status = pipeline::apply_setting(options, key, value); !status.ok())
      return in_context("start_scan.settings", status.error());
  int& wanted_mb = options.map.gpu_memory_mb;
  if (record.gpu_memory_mb > 0)
    wanted_mb = wanted_mb == 0 ? record.gpu_memory_mb : std::min(wanted_mb, record.gpu_memory_mb);
  return options;
}

}  // namespace hermite::server
