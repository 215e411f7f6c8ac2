// How many rows of each kind the store accepts in all, and how many of one token. Tokens of
// administrators are limited only by the total, of which a part is reserved for them, so that
// nobody can lock an administrator out by using up the rest. Rows that have ended do not count.
// server/service/limits.h lists these and all other limits in one table. Pure functions.
#pragma once

#include <cstdint>
#include <string>

#include "core/base/result.h"

namespace hermite::server {

struct Share {
  std::int64_t in_all = 0;
  std::int64_t per_token = 0;   // for a token without the scope admin
  std::int64_t for_admins = 0;  // the part of in_all that is reserved for administrators
};

// How much is in use, in all and by the token that asks.
struct Taken {
  std::int64_t in_all = 0;
  std::int64_t own = 0;
};

// Checks whether a token may have `more` things. kBusy, with a message: "this token may have at
// most 100 uploads".
Status check_share(const Share& share, const Taken& taken, bool is_admin, const std::string& things,
                   std::int64_t more = 1);

// People read links one by one: two hundred is more than anybody looks through, and ten tokens have
// room for theirs.
inline constexpr Share kShareLinkShare{2000, 200, 200};
// Only administrators create tokens.
inline constexpr Share kTokenShare{1000, 0, 1000};
// A folder of recordings is uploaded in one go, a hundred at once. The rest is for eight more users
// who do the same.
inline constexpr Share kUploadShare{1000, 100, 100};
inline constexpr Share kJobShare{1000, 100, 100};  // queued and running jobs

// How many ended rows lists keep, the newest of each token; otherwise creating and ending them
// would fill the disk.
inline constexpr int kMaxEndedLinksPerToken = 200;
inline constexpr int kMaxEndedJobsPerToken = 1000;

}  // namespace hermite::server
