// The first token of a server, in a file of its data folder: 64 hex digits and a line end, mode
// 0600. Thread-safe.
#pragma once

#include <string>

#include "server/store/owned_descriptor.h"

namespace hermite::server {

// Returns the token in that file, which becomes private again if it is not, or of a new file, which
// survives a power failure. Throws SetupError: kIo; kCorruptData for a file without a token.
std::string read_or_create_first_token(const std::string& path);

// Returns the token in an open file; empty: it holds none.
std::string first_token_in(const OwnedDescriptor& file);

}  // namespace hermite::server
