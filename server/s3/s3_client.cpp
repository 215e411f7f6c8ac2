#include "server/s3/s3_client.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <ctime>
#include <memory>

#include "core/base/check.h"
#include "core/digest/sha256.h"
#include "server/s3/s3_xml.h"

namespace hermite::server {

namespace {

constexpr std::size_t kMaxIdle = 16;  // connections that are kept open
constexpr std::size_t kMaxErrorBytes = 64 * 1024;
constexpr long kLeastBytesPerSecond = 1024;  // see S3Patience::silence
// An attempt may take as long as its bytes take at this speed, and a minute.
constexpr std::uint64_t kSlowBytesPerSecond = 64 * 1024;

void start_libcurl_once() {
  static const bool started = [] {
    curl_global_init(CURL_GLOBAL_DEFAULT);
    return true;
  }();
  static_cast<void>(started);
}

std::string encoded(const std::string& text) {
  static constexpr std::string_view kPlain =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-._~";
  std::string out;
  std::array<char, 4> digits{};
  for (const char c : text) {
    if (kPlain.find(c) != std::string_view::npos) {
      out += c;
    } else {
      std::snprintf(digits.data(), digits.size(), "%%%02X",
                    static_cast<unsigned>(static_cast<unsigned char>(c)));
      out += digits.data();
    }
  }
  return out;
}

// What one attempt receives.
struct Receiver {
  S3Answer answer;
  std::size_t max_bytes = 0;
  bool too_long = false;
  const std::atomic<bool>* stopped = nullptr;
};

std::size_t take_body(char* bytes, std::size_t, std::size_t count, void* to) {
  auto& receiver = *static_cast<Receiver*>(to);
  receiver.too_long = count > receiver.max_bytes - receiver.answer.body.size();
  if (receiver.too_long) return 0;
  receiver.answer.body.append(bytes, count);
  return count;
}

std::size_t take_header(char* bytes, std::size_t, std::size_t count, void* to) {
  std::map<std::string, std::string>& headers = static_cast<Receiver*>(to)->answer.headers;
  const std::string_view line(bytes, count);
  if (line.rfind("HTTP/", 0) == 0) headers.clear();  // an answer behind "100 Continue"
  const std::size_t colon = line.find(':');
  if (colon == std::string_view::npos) return count;
  std::string name(line.substr(0, colon));
  std::transform(name.begin(), name.end(), name.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  const std::size_t from = std::min(line.find_first_not_of(" \t", colon + 1), line.size());
  const std::size_t end = line.find_last_not_of(" \t\r\n");
  headers[name] = end == std::string_view::npos || end < from
                      ? ""
                      : std::string(line.substr(from, end - from + 1));
  return count;
}

int watch_stop(void* receiver, curl_off_t, curl_off_t, curl_off_t, curl_off_t) {
  return *static_cast<Receiver*>(receiver)->stopped ? 1 : 0;
}

// A wrong certificate stays wrong; everything else on the way may pass.
bool may_pass(CURLcode code) {
  return code != CURLE_PEER_FAILED_VERIFICATION && code != CURLE_SSL_CACERT_BADFILE &&
         code != CURLE_URL_MALFORMAT && code != CURLE_UNSUPPORTED_PROTOCOL &&
         code != CURLE_ABORTED_BY_CALLBACK && code != CURLE_WRITE_ERROR &&
         code != CURLE_OUT_OF_MEMORY;
}

bool means_later(const S3Answer& answer) {
  for (const long status : {429L, 500L, 502L, 503L, 504L})
    if (answer.status == status) return true;
  return answer.status == 400 && parse_s3_error(answer.body).code == "RequestTimeout";
}

// Printable, and short enough for a line of a log.
std::string quoted(const std::string& text) {
  std::string message = text.substr(0, 200);
  std::replace_if(
      message.begin(), message.end(),
      [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }, ' ');
  return message;
}

std::string now_text() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  std::array<char, 64> text{};
  std::strftime(text.data(), text.size(), "%a, %d %b %Y %H:%M:%S GMT", &utc);
  return text.data();
}

using Headers = std::unique_ptr<curl_slist, void (*)(curl_slist*)>;

void add(Headers& headers, const std::string& line) {
  curl_slist* const longer = curl_slist_append(headers.get(), line.c_str());
  CHECK(longer, "libcurl has no memory for a header");
  static_cast<void>(headers.release());
  headers.reset(longer);
}

}  // namespace

S3Client::S3Client(S3Options options)
    : options_(std::move(options)), random_(std::random_device()()) {
  start_libcurl_once();
}

S3Client::~S3Client() {
  for (CURL* const handle : idle_) curl_easy_cleanup(handle);
}

void S3Client::stop() {
  stopped_ = true;
  changed_.notify_all();
}

CURL* S3Client::take_handle() {
  const std::lock_guard lock(mutex_);
  if (idle_.empty()) return curl_easy_init();
  CURL* const handle = idle_.back();
  idle_.pop_back();
  return handle;
}

void S3Client::give_back(CURL* handle) {
  curl_easy_reset(handle);  // keeps its connection
  const std::lock_guard lock(mutex_);
  if (idle_.size() < kMaxIdle)
    idle_.push_back(handle);
  else
    curl_easy_cleanup(handle);
}

std::string S3Client::url_of(const S3Request& request) const {
  const std::size_t host = options_.endpoint.find("//") + 2;
  std::string url = options_.addressing == S3Addressing::kPath
                        ? options_.endpoint + "/" + options_.bucket
                        : options_.endpoint.substr(0, host) + options_.bucket + "." +
                              options_.endpoint.substr(host);
  if (!request.key.empty()) url += "/" + options_.prefix + request.key;
  if (request.key.empty() && options_.addressing == S3Addressing::kVirtualHost) url += "/";
  char before = '?';
  for (const auto& [name, value] : request.query) {
    url += before + encoded(name) + "=" + encoded(value);
    before = '&';
  }
  return url;
}

S3Client::Attempt S3Client::attempt(const S3Request& request) {
  CURL* const curl = take_handle();
  CHECK(curl, "libcurl has no memory for a connection");
  Headers headers(nullptr, curl_slist_free_all);
  add(headers, "x-amz-content-sha256: " + digest::sha256_hex(request.body));
  add(headers, "Content-Type: application/octet-stream");
  for (const auto& [name, value] : request.headers) add(headers, name + ": " + value);
  if (!options_.credentials.session_token.empty())
    add(headers, "x-amz-security-token: " + options_.credentials.session_token);
  Attempt attempt = perform(curl, request, headers.get());
  give_back(curl);
  return attempt;
}

S3Client::Attempt S3Client::perform(CURL* curl, const S3Request& request, curl_slist* headers) {
  Receiver receiver;
  receiver.max_bytes = std::max(request.max_answer_bytes, kMaxErrorBytes);
  receiver.stopped = &stopped_;
  std::array<char, CURL_ERROR_SIZE> message{};
  const std::uint64_t bytes =
      std::max<std::uint64_t>(request.body.size(), request.max_answer_bytes);
  const std::string signing = fmt::format("aws:amz:{}:s3", options_.region);
  curl_easy_setopt(curl, CURLOPT_URL, url_of(request).c_str());
  curl_easy_setopt(curl, CURLOPT_PATH_AS_IS, 1L);
  curl_easy_setopt(curl, CURLOPT_PROTOCOLS_STR, "http,https");
  curl_easy_setopt(curl, CURLOPT_CUSTOMREQUEST, request.method.c_str());
  if (request.method == "HEAD") curl_easy_setopt(curl, CURLOPT_NOBODY, 1L);
  if (request.method == "PUT") {
    curl_easy_setopt(curl, CURLOPT_POSTFIELDSIZE_LARGE,
                     static_cast<curl_off_t>(request.body.size()));
    curl_easy_setopt(curl, CURLOPT_POSTFIELDS, request.body.data() ? request.body.data() : "");
  }
  curl_easy_setopt(curl, CURLOPT_HTTPHEADER, headers);
  curl_easy_setopt(curl, CURLOPT_AWS_SIGV4, signing.c_str());
  curl_easy_setopt(curl, CURLOPT_USERNAME, options_.credentials.access_key.c_str());
  curl_easy_setopt(curl, CURLOPT_PASSWORD, options_.credentials.secret_key.c_str());
  if (!options_.ca_file.empty()) curl_easy_setopt(curl, CURLOPT_CAINFO, options_.ca_file.c_str());
  curl_easy_setopt(curl, CURLOPT_NOSIGNAL, 1L);
  curl_easy_setopt(curl, CURLOPT_CONNECTTIMEOUT_MS,
                   static_cast<long>(options_.patience.connect.count()));
  curl_easy_setopt(curl, CURLOPT_LOW_SPEED_LIMIT, kLeastBytesPerSecond);
  curl_easy_setopt(curl, CURLOPT_LOW_SPEED_TIME,
                   static_cast<long>(options_.patience.silence.count()));
  curl_easy_setopt(curl, CURLOPT_TIMEOUT, static_cast<long>(60 + bytes / kSlowBytesPerSecond));
  curl_easy_setopt(curl, CURLOPT_WRITEFUNCTION, take_body);
  curl_easy_setopt(curl, CURLOPT_WRITEDATA, &receiver);
  curl_easy_setopt(curl, CURLOPT_HEADERFUNCTION, take_header);
  curl_easy_setopt(curl, CURLOPT_HEADERDATA, &receiver);
  curl_easy_setopt(curl, CURLOPT_XFERINFOFUNCTION, watch_stop);
  curl_easy_setopt(curl, CURLOPT_XFERINFODATA, &receiver);
  curl_easy_setopt(curl, CURLOPT_NOPROGRESS, 0L);
  curl_easy_setopt(curl, CURLOPT_ERRORBUFFER, message.data());
  const CURLcode code = curl_easy_perform(curl);
  if (code != CURLE_OK) {
    const std::string why = receiver.too_long ? "it sends more than was asked for"
                            : message[0]      ? message.data()
                                              : curl_easy_strerror(code);
    return {Error{ErrorCode::kIo, fmt::format("S3 at {}: {}", options_.endpoint, quoted(why))},
            may_pass(code)};
  }
  curl_off_t announced_bytes = 0;
  curl_easy_getinfo(curl, CURLINFO_RESPONSE_CODE, &receiver.answer.status);
  curl_easy_getinfo(curl, CURLINFO_CONTENT_LENGTH_DOWNLOAD_T, &announced_bytes);
  receiver.answer.announced_bytes =
      announced_bytes < 0 ? 0 : static_cast<std::uint64_t>(announced_bytes);
  if (means_later(receiver.answer)) return {explain(receiver.answer, "a request"), true};
  return {std::move(receiver.answer), false};
}

// Returns false if there is no time to wait.
bool S3Client::pause(int attempt) {
  std::unique_lock lock(mutex_);
  const auto longest = options_.patience.first_pause * (1 << std::min(attempt, 10));
  std::uniform_int_distribution<std::int64_t> some(longest.count() / 2, longest.count());
  changed_.wait_for(lock, std::chrono::milliseconds(some(random_)),
                    [this] { return stopped_.load(); });
  return !stopped_;
}

void S3Client::note(const Status& status) {
  const std::lock_guard lock(mutex_);
  last_ = status;
  if (!status.ok()) failed_at_ = Clock::now();
}

Status S3Client::availability() const {
  const std::lock_guard lock(mutex_);
  return last_;
}

Result<S3Answer> S3Client::send(const S3Request& request) {
  const Clock::time_point start = Clock::now();
  int attempts = options_.patience.attempts;
  {
    const std::lock_guard lock(mutex_);
    if (!last_.ok() && start - failed_at_ < options_.patience.short_breath) attempts = 1;
  }
  for (int i = 1;; ++i) {
    Attempt one = attempt(request);
    const bool later = !one.answer.ok() && one.again && i < attempts &&
                       Clock::now() - start < options_.patience.patience;
    if (!later || !pause(i - 1)) {
      note(one.answer.ok() ? Status(Done{}) : Status(one.answer.error()));
      return std::move(one.answer);
    }
  }
}

Error S3Client::explain(const S3Answer& answer, const std::string& what) const {
  const S3ErrorBody body = parse_s3_error(answer.body);
  const std::string context =
      fmt::format("{} at S3 ({}, bucket {}): ", what, options_.endpoint, options_.bucket);
  const auto date = answer.headers.find("date");
  std::string message;
  if (body.code == "NoSuchBucket")
    message = "there is no such bucket";
  else if (body.code == "InvalidAccessKeyId")
    message = "it does not know this access key";
  else if (body.code == "SignatureDoesNotMatch")
    message =
        "the secret key does not belong to the access key, or the region is not " + options_.region;
  else if (body.code == "RequestTimeTooSkewed")
    message = fmt::format("the clocks differ too much: here it is {}, there {}", now_text(),
                          date == answer.headers.end() ? "unknown" : quoted(date->second));
  else if (body.code == "AccessDenied")
    message = "the key may not do this";
  else if (body.code == "AuthorizationHeaderMalformed" || body.code == "PermanentRedirect" ||
           answer.status == 301)
    message = "region or address are not those of the bucket: " + quoted(body.message);
  else if (body.code.empty())
    message = fmt::format("HTTP status {}", answer.status);
  else
    message = fmt::format("HTTP status {}, {}: {}", answer.status, quoted(body.code),
                          quoted(body.message));
  return {ErrorCode::kIo, context + message};
}

}  // namespace hermite::server
