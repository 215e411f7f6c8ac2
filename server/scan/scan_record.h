// What the first two records of a frame log hold: all that is needed, besides the frames, to go on with a scan after the death of its
// server. Pure functions.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "core/base/result.h"
#include "core/pipeline/options.h"
#include "proto/wire/messages.h"

namespace hermite {

struct ScanRecord {
  std::string resume_token_sha256;   // hex; empty: the camera cannot come back
  int gpu_memory_mb = 0;             // its share when it began: the next server may have another one
  std::uint32_t credit_window = 16;  // frames
  wire::StartScan request;
};

inline constexpr int kResumeTokenBytes = 16;

std::string format_terms(const ScanRecord& record);  // JSON
std::string format_start(const ScanRecord& record);  // a Hello without its token

// kCorruptData or what parse_client_message says.
Result<ScanRecord> parse_scan_record(const std::string& terms, const std::string& start);

// Whether that is the token whose hash the scan has. kUnauthorized, also where the camera cannot come back.
Status check_resume_token(const std::string& token, const std::string& resume_token_sha256);

// Settings and share of memory together. kInvalidArgument: a setting.
Result<Options> options_of(const ScanRecord& record);

}  // namespace hermite
