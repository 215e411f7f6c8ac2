#include "server/s3/s3_options.h"

#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string_view>

namespace hermite::server {

namespace {

constexpr std::string_view kScheme = "s3://";
constexpr std::string_view kSmall = "abcdefghijklmnopqrstuvwxyz0123456789";
constexpr std::size_t kMaxPrefix = 200;
constexpr off_t kMaxCredentials_bytes = 64 * 1024;

Error invalid(const std::string& message) { return {ErrorCode::kInvalidArgument, message}; }

bool consists_of(std::string_view text, std::string_view others) {
  return std::all_of(text.begin(), text.end(), [&](char c) {
    return kSmall.find(c) != std::string_view::npos || others.find(c) != std::string_view::npos;
  });
}

bool is_bucket(std::string_view name) {
  return name.size() >= 3 && name.size() <= 63 && consists_of(name, ".-") &&
         name.find("..") == std::string_view::npos &&
         kSmall.find(name.front()) != std::string_view::npos &&
         kSmall.find(name.back()) != std::string_view::npos;
}

bool is_prefix(std::string_view prefix) {
  if (prefix.size() > kMaxPrefix) return false;
  for (std::size_t from = 0; from < prefix.size();) {
    const std::size_t end = std::min(prefix.find('/', from), prefix.size());
    const std::string_view part = prefix.substr(from, end - from);
    if (part.empty() || part == "." || part == ".." ||
        !consists_of(part, "ABCDEFGHIJKLMNOPQRSTUVWXYZ._-"))
      return false;
    from = end + 1;
  }
  return true;
}

std::string trimmed(const std::string& text) {
  const std::size_t from = text.find_first_not_of(" \t\r");
  return from == std::string::npos ? ""
                                   : text.substr(from, text.find_last_not_of(" \t\r") - from + 1);
}

// A key becomes part of a header.
bool is_key(const std::string& key) {
  return !key.empty() && key.size() <= 4096 &&
         std::all_of(key.begin(), key.end(), [](char c) { return c > 0x20 && c < 0x7f; });
}

Result<S3Credentials> checked(S3Credentials credentials, const std::string& source) {
  if (!is_key(credentials.access_key))
    return invalid(fmt::format(
        "the access key (aws_access_key_id) of {} is missing or has odd characters", source));
  if (!is_key(credentials.secret_key))
    return invalid(fmt::format(
        "the secret key (aws_secret_access_key) of {} is missing or has odd characters", source));
  if (!credentials.session_token.empty() && !is_key(credentials.session_token))
    return invalid(
        fmt::format("the session token (aws_session_token) of {} has odd characters", source));
  return credentials;
}

std::string from_environment(const char* name) {
  const char* const value = std::getenv(name);
  return value ? value : "";
}

Status check_is_private(const std::string& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0)
    return Error{errno == ENOENT ? ErrorCode::kNotFound : ErrorCode::kIo,
                 fmt::format("the file with the S3 key, {}: {}", path, std::strerror(errno))};
  if (!S_ISREG(status.st_mode))
    return invalid(fmt::format("the file with the S3 key, {}, is no file", path));
  if ((status.st_mode & 077) != 0)
    return invalid("others may read the file with the S3 key: chmod 600 " + path);
  if (status.st_uid != geteuid() && status.st_uid != 0)
    return invalid(fmt::format("the file with the S3 key, {}, belongs to somebody else", path));
  if (status.st_size > kMaxCredentials_bytes)
    return invalid(fmt::format("the file with the S3 key, {}, is longer than {} bytes", path,
                               kMaxCredentials_bytes));
  return Done{};
}

}  // namespace

Result<S3Location> parse_s3_location(const std::string& text) {
  const Error wrong =
      invalid(fmt::format("'{}' is no place in S3: expected s3://BUCKET or s3://BUCKET/PREFIX, "
                          "with a bucket of 3 to 63 characters a-z, 0-9, . and -, and a prefix of "
                          "at most 200 characters A-Z, a-z, 0-9, ., _ and - between slashes",
                          text));
  if (text.rfind(kScheme, 0) != 0) return wrong;
  const std::string rest = text.substr(kScheme.size());
  const std::size_t slash = std::min(rest.find('/'), rest.size());
  S3Location location{rest.substr(0, slash), rest.substr(std::min(slash + 1, rest.size()))};
  if (location.prefix.ends_with('/')) location.prefix.pop_back();
  if (!is_bucket(location.bucket) || !is_prefix(location.prefix)) return wrong;
  if (!location.prefix.empty()) location.prefix += '/';
  return location;
}

std::string text_of(const S3Location& location) {
  std::string text = std::string(kScheme) + location.bucket + "/" + location.prefix;
  text.pop_back();
  return text;
}

Result<std::string> checked_s3_endpoint(const std::string& endpoint, const std::string& region,
                                        bool allow_plain) {
  if (region.empty() || region.size() > 64 || !consists_of(region, "-_"))
    return invalid(fmt::format("'{}' is no region of S3, such as eu-central-1", region));
  if (endpoint.empty()) return fmt::format("https://s3.{}.amazonaws.com", region);
  const bool plain = endpoint.rfind("http://", 0) == 0;
  if (!plain && endpoint.rfind("https://", 0) != 0)
    return invalid(fmt::format(
        "the address of S3 is '{}', expected https://HOST or https://HOST:PORT", endpoint));
  const std::string host = endpoint.substr(plain ? 7 : 8);
  if (host.empty() || !consists_of(host, "ABCDEFGHIJKLMNOPQRSTUVWXYZ.-:[]"))
    return invalid(
        fmt::format("the address of S3 is '{}', expected https://HOST or https://HOST:PORT and "
                    "nothing behind it",
                    endpoint));
  const bool here = host.rfind("127.", 0) == 0 || host == "localhost" ||
                    host.rfind("localhost:", 0) == 0 || host.rfind("[::1]", 0) == 0;
  if (plain && !here && !allow_plain)
    return invalid(
        fmt::format("the address of S3, {}, is not encrypted, and results would be readable on the "
                    "way: take https://, or add --insecure-i-know",
                    endpoint));
  return endpoint;
}

Result<S3Credentials> read_s3_credentials(const std::string& path) {
  if (path.empty())
    return checked(
        {from_environment("AWS_ACCESS_KEY_ID"), from_environment("AWS_SECRET_ACCESS_KEY"),
         from_environment("AWS_SESSION_TOKEN")},
        "the environment (AWS_ACCESS_KEY_ID, AWS_SECRET_ACCESS_KEY)");
  if (Status status = check_is_private(path); !status.ok()) return status.error();
  std::ifstream file(path);
  if (!file)
    return Error{ErrorCode::kIo, fmt::format("the file with the S3 key, {}, cannot be read", path)};
  S3Credentials credentials;
  for (std::string line; std::getline(file, line);) {
    const std::size_t equals = line.find('=');
    if (equals == std::string::npos) continue;
    const std::string key = trimmed(line.substr(0, equals)),
                      value = trimmed(line.substr(equals + 1));
    if (key == "aws_access_key_id") credentials.access_key = value;
    if (key == "aws_secret_access_key") credentials.secret_key = value;
    if (key == "aws_session_token") credentials.session_token = value;
  }
  return checked(std::move(credentials), path);
}

}  // namespace hermite::server
