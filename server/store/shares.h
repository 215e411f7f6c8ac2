// What all tokens share that a store counts, and how much of it one token may take. A token that may administer is held to the limit for
// all alone, and a part is kept for such tokens: who fills everything else cannot keep an administrator from ending that. What has ended
// counts for nothing. server/service/limits.h has these and all other limits in one table. Pure functions.
#pragma once

#include <cstdint>
#include <string>

#include "core/base/result.h"

namespace hermite {

struct Share {
  std::int64_t in_all = 0;
  std::int64_t per_token = 0;   // of a token that may not administer
  std::int64_t for_admins = 0;  // of in_all: out of reach for all others
};

// How much is taken, by all and by the token that asks.
struct Taken {
  std::int64_t in_all = 0;
  std::int64_t own = 0;
};

// Whether `more` are there for a token. kBusy, in words: "this token may have at most 100 uploads".
Status check_share(const Share& share, const Taken& taken, bool is_admin, const std::string& things, std::int64_t more = 1);

// Links are read one by one by people: two hundred is more than anybody looks through, and ten tokens have room for theirs.
inline constexpr Share kShareLinkShare{2000, 200, 200};
// Made by administrators alone.
inline constexpr Share kTokenShare{1000, 0, 1000};
// A folder of recordings is sent in one go: a hundred at once. The rest is for eight more that do the same.
inline constexpr Share kUploadShare{1000, 100, 100};
inline constexpr Share kJobShare{1000, 100, 100};  // that wait or run

// Of what has ended these stay in lists, the newest of each token: else making and ending would fill the disk.
inline constexpr int kMaxEndedLinksPerToken = 200;
inline constexpr int kMaxEndedJobsPerToken = 1000;

}  // namespace hermite
