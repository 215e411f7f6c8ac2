// All limits of the server in one place: what tokens share, how much of it one token may take and how much stays for administrators, and
// what bounds single requests, messages and files. SECURITY.md has this table as it is printed here, and a test fills every share. Pure
// functions.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "server/service/service.h"
#include "server/store/shares.h"

namespace hermite {

// Everything that one token could take away from the others.
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
inline constexpr Shared kAllShared[] = {Shared::kTokens,  Shared::kShareLinks,   Shared::kUploads,        Shared::kUploadBytes,
                                        Shared::kJobs,    Shared::kRunningScans, Shared::kWaitingCameras, Shared::kStorage,
                                        Shared::kViewers, Shared::kConnections,  Shared::kRequests,       Shared::kExports};

// A number of 0 in `share` stands for what is not limited, or not kept, in that way.
struct SharedLimit {
  Shared which = Shared::kTokens;
  std::string what;
  Share share;
  std::string unit;    // behind a number: "", "GB"
  std::string answer;  // to who meets it
};
std::vector<SharedLimit> shared_limits(const ServiceOptions& options);

struct Bound {
  std::string what, value, answer;
};
std::vector<Bound> bounds(const ServiceOptions& options);

// Both as tables of Markdown.
std::string limits_text(const ServiceOptions& options);

// WebSockets. A sixteenth is for administrators.
Share connection_share(const ServiceOptions& options);

}  // namespace hermite
