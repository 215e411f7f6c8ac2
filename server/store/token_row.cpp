#include "server/store/token_row.h"

namespace hermite::server {

const char* name_of(Scope scope) {
  switch (scope) {
    case Scope::kView: return "view";
    case Scope::kScan: return "scan";
    case Scope::kAdmin: return "admin";
  }
  return "unknown";
}

bool includes(const Scopes& scopes, Scope scope) {
  switch (scope) {
    case Scope::kView: return scopes.view || scopes.admin;
    case Scope::kScan: return scopes.scan || scopes.admin;
    case Scope::kAdmin: return scopes.admin;
  }
  return false;
}

}  // namespace hermite::server
