#include "server/routes/token_routes.h"

#include <string>
#include <utility>

#include "server/access/administration.h"

namespace hermite::server {

namespace {

HttpAnswer revoke(const HttpWorld& world, const Call& call, bool share) {
  Result<std::string> revoked = revoke_row(world.store, call.id, share, call.request.caller.now_ms);
  if (revoked.ok()) world.gate.forget_grants(call.id);
  return made(std::move(revoked));
}

}  // namespace

HttpAnswer list_all_shares(const HttpWorld& world, const Call& call) {
  return made(list_shares(world.store, "", call.request.caller.now_ms));
}

HttpAnswer list_scans_shares(const HttpWorld& world, const Call& call) {
  const Result<ScanRow> row = world.scans.rows().find(call.id);
  return row.ok() ? made(list_shares(world.store, call.id, call.request.caller.now_ms))
                  : refused(row.error());
}

HttpAnswer share_scan(const HttpWorld& world, const Call& call) {
  return made(create_share(world.store, call.id, call.request.body, call.request.caller.now_ms,
                           call.grant.token_id),
              201);
}

HttpAnswer list_all_tokens(const HttpWorld& world, const Call& call) {
  return made(list_tokens(world.store, call.request.caller.now_ms));
}

HttpAnswer make_token(const HttpWorld& world, const Call& call) {
  return made(
      create_token(world.store, call.request.body, call.request.caller.now_ms, call.grant.token_id),
      201);
}

HttpAnswer revoke_share(const HttpWorld& world, const Call& call) {
  return revoke(world, call, true);
}

HttpAnswer revoke_token(const HttpWorld& world, const Call& call) {
  return revoke(world, call, false);
}

}  // namespace hermite::server
