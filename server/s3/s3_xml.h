// The answers of S3 that are XML: errors, and lists of objects. Pure functions; they take bytes of
// a foreign server, of any length.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/result.h"

namespace hermite::server {

struct S3ErrorBody {
  std::string code, message;
};

// Returns what an error says; nothing if it is none.
S3ErrorBody parse_s3_error(const std::string& xml);

struct S3Object {
  std::string key;  // with its prefix
  std::uint64_t size_bytes = 0;
  std::string etag;  // without quotes
};

struct S3Page {
  std::vector<S3Object> objects;
  std::string next;  // the token of the next page; empty: this is the last one
};

// Parses an answer to ListObjectsV2. kCorruptData, with a message.
Result<S3Page> parse_s3_page(const std::string& xml);

// Returns an entity tag without its quotes.
std::string unquoted_etag(const std::string& etag);

}  // namespace hermite::server
