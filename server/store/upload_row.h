// An upload as a row of the store; its bytes are in a file (data_directory.h), whose length says
// how much was received. Plain values.
#pragma once

#include <cstdint>
#include <string>

namespace hermite::server {

struct UploadRow {
  std::string id;
  std::string token_id;            // of the sender
  std::int64_t length_bytes = -1;  // total; -1: not known yet
  std::string metadata;            // as received (tus.h)
  // Offset from which on the file has a piece whose checksum has not been checked; -1: none.
  std::int64_t unchecked_from = -1;
  std::int64_t created_at_ms = 0;  // Unix time
  std::int64_t expires_at_ms = 0;  // when it is removed, unless it is used before then
};

}  // namespace hermite::server
