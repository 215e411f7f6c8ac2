// The first two records of a frame log: all that is needed, besides the frames, to continue a scan
// after its server died. Pure functions.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "core/base/result.h"
#include "core/pipeline/options.h"
#include "proto/wire/messages.h"

namespace hermite::server {

struct ScanRecord {
  std::string resume_token_sha256;   // hex; empty: the camera cannot reconnect
  int gpu_memory_mb = 0;             // its share when it started; the next server may have another
  std::uint32_t credit_window = 16;  // frames
  wire::StartScan request;
};

inline constexpr int kResumeTokenBytes = 16;

std::string format_terms(const ScanRecord& record);  // JSON
std::string format_start(const ScanRecord& record);  // a Hello message without its token

// kCorruptData, or the errors of parse_client_message.
Result<ScanRecord> parse_scan_record(const std::string& terms, const std::string& start);

// Checks a resume token against the stored hash. kUnauthorized: another token, or the camera cannot
// reconnect.
Status check_resume_token(const std::string& token, const std::string& resume_token_sha256);

// The pipeline options from the settings and the memory share. kInvalidArgument: a setting.
Result<pipeline::Options> options_of(const ScanRecord& record);

}  // namespace hermite::server
