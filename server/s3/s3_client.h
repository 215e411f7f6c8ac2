// Sends requests of the S3 protocol, by libcurl: it signs them (AWS Signature Version 4), keeps
// connections open and checks certificates.
//
// libcurl rather than a client of its own protocol: it is maintained, in every distribution, and
// Hermite needs five kinds of request; Debian 12 has neither Amazon's SDK for C++ nor MinIO's, and
// its libs3 signs by the old version 2 only. Its release 7.88 signs x-amz-content-sha256 as it is
// given (curl pull request 9995, without which it signs "UNSIGNED-PAYLOAD"), so it is given. It
// does not sort or encode a query before it signs it, so queries are passed sorted and encoded.
//
// Credentials: see S3Credentials; roles of cloud machines (metadata services) are not asked.
#pragma once

#include <curl/curl.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <map>
#include <mutex>
#include <random>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/result.h"
#include "server/s3/s3_options.h"

namespace hermite::server {

struct S3Request {
  std::string method;  // GET, HEAD, PUT or DELETE
  // Without the prefix; empty: the bucket itself.
  std::string key;
  // Sorted by name; values are encoded here.
  std::vector<std::pair<std::string, std::string>> query = {};
  std::vector<std::pair<std::string, std::string>> headers = {};  // names in lower case
  std::string_view body = {};                                     // of PUT; outlives the call
  std::size_t max_answer_bytes = 64 * 1024;                       // more is an error
};

struct S3Answer {
  long status = 0;
  std::map<std::string, std::string> headers;  // names in lower case
  std::string body;
  std::uint64_t announced_bytes = 0;  // Content-Length, also of HEAD
};

// Thread-safe.
class S3Client {
 public:
  explicit S3Client(S3Options options);
  ~S3Client();  // no call may be running
  S3Client(const S3Client&) = delete;
  S3Client& operator=(const S3Client&) = delete;

  // Returns the answer, whatever its status, except for those that mean "later" (429, 500, 502,
  // 503, 504). These and lost connections are tried again, with pauses (S3Patience). kIo: it did
  // not answer, with a message.
  Result<S3Answer> send(const S3Request& request);

  // Returns what an answer that is an error means, as a message for the operator: no such bucket, a
  // wrong key, clocks that differ. kIo.
  Error explain(const S3Answer& answer, const std::string& what) const;

  // Done if the last request was answered; kIo with the reason otherwise. Does not ask again.
  Status availability() const;

  const S3Options& options() const { return options_; }

  // Running and later requests fail soon.
  void stop();

 private:
  using Clock = std::chrono::steady_clock;
  struct Attempt {
    Result<S3Answer> answer;
    bool again = false;  // worth another attempt
  };
  std::string url_of(const S3Request& request) const;
  Attempt attempt(const S3Request& request);
  Attempt perform(CURL* curl, const S3Request& request, curl_slist* headers);
  CURL* take_handle();
  void give_back(CURL* handle);
  bool pause(int attempt);
  void note(const Status& status);

  const S3Options options_;
  std::atomic<bool> stopped_ = false;
  mutable std::mutex mutex_;  // guards everything below
  std::condition_variable changed_;
  std::vector<CURL*> idle_;
  std::mt19937 random_;
  Status last_ = Done{};
  Clock::time_point failed_at_;
};

}  // namespace hermite::server
