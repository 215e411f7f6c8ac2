#include "server/scan/scan_end.h"

#include <fmt/core.h>
#include <spdlog/spdlog.h>

namespace hermite::server {

ScanEnd failed_scan(const Error& error) {
  return {wire::ScanPhase::kFailed, error, {}, error.message};
}

ScanEnd not_stored(Blobs& blobs, const std::string& scan_id, const std::optional<Error>& reason,
                   const Error& why) {
  if (const Status removed = blobs.remove(scan_id); !removed.ok())
    spdlog::warn("scan {}: {}", scan_id, removed.error().message);
  // Where the store is, is nothing for cameras.
  const bool away = !blobs.availability().ok();
  if (away) spdlog::warn("scan {}: its results cannot be stored: {}", scan_id, why.message);
  const Error error =
      in_context("its results cannot be stored",
                 away ? Error{why.code, "the store of results does not answer"} : why);
  const std::string later = away ? "once it answers" : "when there is room";
  const std::string message = fmt::format(
      "{}{}; they are made again {}", reason ? reason->message + "; " : "", error.message, later);
  return {wire::ScanPhase::kInterrupted, reason.value_or(error), {}, message, false, true};
}

}  // namespace hermite::server
