#include "server/store/shares.h"

#include <fmt/core.h>

namespace hermite::server {

Status check_share(const Share& share, const Taken& taken, bool is_admin, const std::string& things,
                   std::int64_t more) {
  const auto full = [&things](std::int64_t count, const std::string& whose) {
    return Error{ErrorCode::kBusy, fmt::format("{}{} {}", whose, count, things)};
  };
  if (!is_admin && taken.own + more > share.per_token)
    return full(share.per_token, "this token may have at most ");
  if (taken.in_all + more > share.in_all)
    return full(share.in_all, "this server may have at most ");
  if (!is_admin && taken.in_all + more > share.in_all - share.for_admins)
    return full(share.in_all - share.for_admins,
                "beside what is kept for administrators this server may have at most ");
  return Done{};
}

}  // namespace hermite::server
