// A token or a share link as a row of the store. Plain values.
#pragma once

#include <cstdint>
#include <string>

namespace hermite::server {

// What a token allows.
enum class Scope {
  kView,   // view scans and download their files
  kScan,   // stream frames, which creates scans
  kAdmin,  // delete scans and manage tokens; includes the other scopes
};
inline constexpr Scope kAllScopes[] = {Scope::kView, Scope::kScan, Scope::kAdmin};
const char* name_of(Scope scope);  // "view", "scan", "admin"

struct Scopes {
  bool view = false, scan = false, admin = false;
  bool operator==(const Scopes&) const = default;
};
bool includes(const Scopes& scopes, Scope scope);

struct TokenRow {
  std::string id;             // public: identifies it in lists and logs
  std::string secret_sha256;  // 32 bytes
  std::string name;           // display name
  Scopes scopes;
  // Of a share link, the only scan that it allows to view. Empty for a token.
  std::string scan_id;
  // Id of the token that created it; empty: the owner of the data folder.
  std::string made_by;
  std::int64_t created_at_ms = 0;  // Unix time, here and below
  std::int64_t expires_at_ms = 0;  // 0: never
  std::int64_t used_at_ms = 0;     // accurate to about a minute; 0: never
  std::int64_t revoked_at_ms = 0;  // 0: not revoked
};

// The token in the file `token` of the data folder: created at the first start, with all scopes.
inline constexpr const char* kFirstTokenId = "first";

}  // namespace hermite::server
