// All limits of the server in one place: the resources that tokens share, with the share of one
// token and the part reserved for administrators, and the bounds on single requests, messages and
// files. SECURITY.md has this table as printed here, and a test uses up every share. Pure
// functions.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "server/service/service.h"
#include "server/store/shares.h"

namespace hermite::server {

// Everything that one token could use up at the expense of others.
enum class Shared {
  kTokens,
  kShareLinks,
  kUploads,
  kUploadBytes,
  kJobs,
  kRunningScans,
  kWaitingCameras,
  kStorage,
  kViewers,
  kConnections,
  kRequests,
  kExports,
};
inline constexpr Shared kAllShared[] = {
    Shared::kTokens,  Shared::kShareLinks,   Shared::kUploads,        Shared::kUploadBytes,
    Shared::kJobs,    Shared::kRunningScans, Shared::kWaitingCameras, Shared::kStorage,
    Shared::kViewers, Shared::kConnections,  Shared::kRequests,       Shared::kExports};

// In `share`, 0 means that there is no such limit, or no reserved part.
struct SharedLimit {
  Shared which = Shared::kTokens;
  std::string what;
  Share share;
  std::string unit;    // follows a number: "", "GB"
  std::string answer;  // to a client that exceeds the limit
};
std::vector<SharedLimit> shared_limits(const ServiceOptions& options);

struct Bound {
  std::string what, value, answer;
};
std::vector<Bound> bounds(const ServiceOptions& options);

// Returns both as Markdown tables.
std::string limits_text(const ServiceOptions& options);

// For WebSockets. A sixteenth is reserved for administrators.
Share connection_share(const ServiceOptions& options);

}  // namespace hermite::server
