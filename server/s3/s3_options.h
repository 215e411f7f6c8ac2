// Where a bucket is and with which key it is opened. Pure functions, except for
// read_s3_credentials.
#pragma once

#include <chrono>
#include <string>

#include "core/base/result.h"

namespace hermite::server {

// Never logged, and never part of an error.
struct S3Credentials {
  std::string access_key, secret_key;
  std::string session_token;  // of temporary keys; may be empty
};

enum class S3Addressing {
  kPath,         // https://HOST/BUCKET/KEY
  kVirtualHost,  // https://BUCKET.HOST/KEY
};

// How long a request may take before it has failed. One request lasts at most `patience`, and the
// time of its last attempt.
struct S3Patience {
  std::chrono::milliseconds connect{5'000};
  std::chrono::seconds silence{20};  // with less than a kilobyte per second
  int attempts = 5;                  // in all
  // Doubled after each attempt, and up to half of it shorter, by chance.
  std::chrono::milliseconds first_pause{200};
  // No attempt begins later than this after the first one.
  std::chrono::milliseconds patience{30'000};
  // For so long after a failure, requests have a single attempt.
  std::chrono::milliseconds short_breath{10'000};
};

struct S3Options {
  std::string endpoint;  // "https://HOST" or "https://HOST:PORT", without a slash at the end
  std::string region = "us-east-1";
  std::string bucket;
  std::string prefix;  // of all keys: empty, or ends with a slash
  S3Addressing addressing = S3Addressing::kPath;
  std::string ca_file;  // PEM; empty: the system's certificates
  S3Credentials credentials;
  S3Patience patience = {};
  int keys_in_page = 1000;  // of a list; S3 gives no more at once
};

struct S3Location {
  std::string bucket, prefix;
};

// Parses "s3://BUCKET" or "s3://BUCKET/PREFIX". A bucket has 3 to 63 characters of [a-z0-9.-]; a
// prefix has at most 200, and its parts [A-Za-z0-9._-] without "." and "..". kInvalidArgument, with
// a message.
Result<S3Location> parse_s3_location(const std::string& text);
std::string text_of(const S3Location& location);  // as it is parsed, without a slash at the end

// Returns the endpoint, for an empty one that of Amazon in this region. Without TLS (http://)
// results and their names could be read on the way, so that is for loopback addresses, or with
// `allow_plain`. kInvalidArgument.
Result<std::string> checked_s3_endpoint(const std::string& endpoint, const std::string& region,
                                        bool allow_plain);

// Reads the key from a file, or without one from the environment: AWS_ACCESS_KEY_ID,
// AWS_SECRET_ACCESS_KEY and AWS_SESSION_TOKEN. The file has lines `aws_access_key_id = ...`,
// `aws_secret_access_key = ...` and `aws_session_token = ...`; others are ignored. It belongs to
// this user or to root, and nobody else may read it. kInvalidArgument, kNotFound, kIo, with a
// message that does not contain the key.
Result<S3Credentials> read_s3_credentials(const std::string& path);

}  // namespace hermite::server
