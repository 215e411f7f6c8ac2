#include "server/database/postgres_connection.h"

#include <fmt/core.h>
#include <libpq-fe.h>
#include <poll.h>

#include <array>
#include <charconv>
#include <string_view>

#include "core/base/utf8.h"
#include "core/digest/sha256.h"

namespace hermite::server {

namespace {

using Kind = DatabaseFailure::Kind;

// How long a server may be silent before the connection counts as lost: longer than packets of a
// good network are lost in a row, and as long as cameras' frames fit into the queues that wait
// meanwhile.
constexpr const char *kConnectSeconds = "3", *kSilentMilliseconds = "5000", *kIdleSeconds = "10",
                     *kProbeSeconds = "3", *kProbeCount = "3";
constexpr const char* kLockMilliseconds = "5000";  // as for SQLite

// After its time the server ends a statement itself, and says so; a server that hangs does not.
constexpr std::chrono::milliseconds kMargin(1000);

// The first line of a message, without "ERROR:  " and the like.
std::string line_of(const char* message) {
  std::string text = message ? message : "";
  text = text.substr(0, text.find('\n'));
  for (const char* start : {"ERROR:  ", "FATAL:  "})
    if (text.rfind(start, 0) == 0) text = text.substr(8);
  return text.empty() ? "no message" : text;
}

// Returns the kind by SQLSTATE (PostgreSQL manual, appendix A): class 22 is a value that is not
// allowed, 23 a violated constraint, 57P0x a server that shuts down, XX00x damaged data.
Kind kind_of(std::string_view state, bool is_lost) {
  if (is_lost || state.substr(0, 4) == "57P0" || state.substr(0, 2) == "08")
    return Kind::kDisconnected;
  if (state.substr(0, 2) == "22" || state.substr(0, 2) == "23") return Kind::kConstraint;
  return state == "XX001" || state == "XX002" ? Kind::kDamaged : Kind::kOther;
}

void check_result(const PGresult* result, PGconn* connection) {
  const ExecStatusType status = PQresultStatus(result);
  if (status == PGRES_TUPLES_OK || status == PGRES_COMMAND_OK) return;
  const char* state = PQresultErrorField(result, PG_DIAG_SQLSTATE);
  const std::string message = result ? PQresultErrorMessage(result) : "";
  throw DatabaseFailure(kind_of(state ? state : "", PQstatus(connection) != CONNECTION_OK),
                        line_of(message.empty() ? PQerrorMessage(connection) : message.c_str()));
}

// Parameters are sent as text.
std::string text_of(const SqlValue& value) {
  if (const auto* integer = std::get_if<std::int64_t>(&value)) return std::to_string(*integer);
  if (const auto* text = std::get_if<std::string>(&value)) return readable_utf8(*text);
  if (const auto* bytes = std::get_if<SqlBytes>(&value)) return "\\x" + digest::hex(bytes->bytes);
  std::array<char, 32> digits = {};  // the shortest digits that are read as the same number
  const std::to_chars_result end =
      std::to_chars(digits.data(), digits.data() + digits.size(), std::get<double>(value));
  return {digits.data(), end.ptr};
}

template <class Number>
SqlValue number_of(const char* text, int length) {
  Number number = 0;
  std::from_chars(text, text + length, number);
  return number;
}

SqlBytes bytes_of(const char* text) {
  std::size_t size = 0;
  const std::unique_ptr<unsigned char, decltype(&PQfreemem)> bytes(
      PQunescapeBytea(reinterpret_cast<const unsigned char*>(text), &size), &PQfreemem);
  return {std::string(reinterpret_cast<const char*>(bytes.get()), size)};
}

// Types by their object ids (pg_type.dat), which never change.
SqlValue value_of(const PGresult* result, int row, int column) {
  constexpr Oid kBytes = 17, kInt8 = 20, kInt2 = 21, kInt4 = 23, kFloat4 = 700, kFloat8 = 701;
  if (PQgetisnull(result, row, column)) return std::monostate();
  const char* text = PQgetvalue(result, row, column);
  const int length = PQgetlength(result, row, column);
  switch (PQftype(result, column)) {
    case kInt2:
    case kInt4:
    case kInt8: return number_of<std::int64_t>(text, length);
    case kFloat4:
    case kFloat8: return number_of<double>(text, length);
    case kBytes: return bytes_of(text);
    default: return std::string(text, static_cast<std::size_t>(length));
  }
}

struct OptionsCloser {
  void operator()(PQconninfoOption* options) const { PQconninfoFree(options); }
};
using AnyOptions = std::unique_ptr<PQconninfoOption, OptionsCloser>;

std::string option(const AnyOptions& options, std::string_view keyword) {
  for (const PQconninfoOption* one = options.get(); one && one->keyword; ++one)
    if (one->keyword == keyword && one->val) return one->val;
  return "";
}

bool is_here(const std::string& host) {
  return host.empty() || host.front() == '/' || host.front() == '@' || host == "localhost" ||
         host == "::1" || host.rfind("127.", 0) == 0;
}

bool are_here(std::string hosts) {
  for (std::size_t end = 0; end != std::string::npos;
       hosts = end == std::string::npos ? "" : hosts.substr(end + 1)) {
    end = hosts.find(',');
    if (!is_here(hosts.substr(0, end))) return false;
  }
  return true;
}

}  // namespace

Status check_postgres_url(const std::string& url, bool allow_plain) {
  char* why = nullptr;
  const bool is_url = url.rfind("postgresql://", 0) == 0 || url.rfind("postgres://", 0) == 0;
  const AnyOptions given(is_url ? PQconninfoParse(url.c_str(), &why) : nullptr);
  const std::string reason = is_url ? line_of(why) : "it does not begin with postgresql://";
  PQfreemem(why);
  // Without the value, which may have a password in it.
  if (!given)
    return Error{ErrorCode::kInvalidArgument,
                 "it is no address postgresql://USER@HOST:PORT/DATABASE: " + reason};
  if (!option(given, "password").empty())
    return Error{ErrorCode::kInvalidArgument,
                 "it has a password, which everybody on the machine could read: write it into a "
                 "file of mode 0600 with the line "
                 "HOST:PORT:DATABASE:USER:PASSWORD, and add ?passfile=FILE"};
  // What the address leaves open, the environment may say.
  const AnyOptions standard(PQconndefaults());
  const auto setting = [&](const char* keyword) {
    const std::string value = option(given, keyword);
    return value.empty() ? option(standard, keyword) : value;
  };
  const std::string mode = setting("sslmode");
  if (allow_plain || mode == "verify-full" || mode == "verify-ca" ||
      (are_here(setting("host")) && are_here(setting("hostaddr"))))
    return Done{};
  return Error{ErrorCode::kInvalidArgument,
               "the database is on another machine, and its certificate would not be checked: add "
               "?sslmode=verify-full, and "
               "sslrootcert=FILE for an authority of your own, or give --insecure-i-know"};
}

void PostgresConnection::Closer::operator()(pg_conn* connection) const { PQfinish(connection); }
void PostgresConnection::Closer::operator()(pg_result* result) const { PQclear(result); }

PostgresConnection::PostgresConnection(const std::string& url,
                                       std::chrono::milliseconds statement_time)
    : statement_time_(statement_time) {
  // Later ones win: the address may say otherwise for all but the encoding.
  const std::array<const char*, 9> keywords = {"connect_timeout",
                                               "tcp_user_timeout",
                                               "keepalives_idle",
                                               "keepalives_interval",
                                               "keepalives_count",
                                               "application_name",
                                               "dbname",
                                               "client_encoding",
                                               nullptr};
  const std::array<const char*, 9> values = {
      kConnectSeconds, kSilentMilliseconds, kIdleSeconds, kProbeSeconds, kProbeCount,
      "hermite",       url.c_str(),         "UTF8",       nullptr};
  connection_.reset(PQconnectdbParams(keywords.data(), values.data(), 1));
  if (!connection_ || PQstatus(connection_.get()) != CONNECTION_OK)
    throw DatabaseFailure(Kind::kDisconnected, connection_
                                                   ? line_of(PQerrorMessage(connection_.get()))
                                                   : "out of memory");
  PQsetNoticeProcessor(
      connection_.get(), [](void*, const char*) {}, nullptr);
  run_script(
      fmt::format("SET search_path = hermite; SET statement_timeout = {}; SET lock_timeout = {}",
                  statement_time.count(), kLockMilliseconds));
  // A commit is on the server's disk, whatever is usual there.
  run("SELECT set_config('synchronous_commit', 'on', false) WHERE "
      "current_setting('synchronous_commit') = 'off'");
}

SqlResult PostgresConnection::run(const std::string& sql, const std::vector<SqlValue>& values) {
  if (!connection_) throw DatabaseFailure(Kind::kDisconnected, "the connection was lost");
  std::vector<std::string> texts;
  std::vector<const char*> pointers;
  for (const SqlValue& value : values)
    texts.push_back(std::holds_alternative<std::monostate>(value) ? "" : text_of(value));
  for (std::size_t i = 0; i < values.size(); ++i)
    pointers.push_back(std::holds_alternative<std::monostate>(values[i]) ? nullptr
                                                                         : texts[i].c_str());
  PQsendQueryParams(connection_.get(), sql.c_str(), static_cast<int>(values.size()), nullptr,
                    pointers.data(), nullptr, nullptr, 0);
  const AnyResult given = answer();
  SqlResult result;
  for (int column = 0; column < PQnfields(given.get()); ++column)
    result.columns.emplace_back(PQfname(given.get(), column));
  for (int i = 0; i < PQntuples(given.get()); ++i) {
    SqlRow row;
    for (int column = 0; column < PQnfields(given.get()); ++column)
      row.push_back(value_of(given.get(), i, column));
    result.rows.push_back(std::move(row));
  }
  const std::string_view changed = PQcmdTuples(given.get());
  std::from_chars(changed.data(), changed.data() + changed.size(), result.changed_count);
  return result;
}

void PostgresConnection::run_script(const std::string& sql) {
  if (!connection_) throw DatabaseFailure(Kind::kDisconnected, "the connection was lost");
  PQsendQuery(connection_.get(), sql.c_str());
  answer();
}

PostgresConnection::AnyResult PostgresConnection::answer() {
  const bool is_bounded = statement_time_.count() > 0;
  const auto end = std::chrono::steady_clock::now() + statement_time_ + kMargin;
  AnyResult last;
  for (;;) {
    while (PQisBusy(connection_.get())) {
      const auto left =
          std::chrono::ceil<std::chrono::milliseconds>(end - std::chrono::steady_clock::now());
      pollfd socket{PQsocket(connection_.get()), POLLIN, 0};
      const int ready = is_bounded && left.count() <= 0
                            ? 0
                            : poll(&socket, 1, is_bounded ? static_cast<int>(left.count()) : -1);
      if (ready == 0) {
        connection_.reset();
        throw DatabaseFailure(Kind::kDisconnected, "the server does not answer");
      }
      if (ready > 0 && !PQconsumeInput(connection_.get())) break;  // the result says what happened
    }
    AnyResult next(PQgetResult(connection_.get()));
    if (!next) break;
    check_result(next.get(), connection_.get());
    last = std::move(next);
  }
  if (!last) check_result(nullptr, connection_.get());  // it could not be sent
  return last;
}

}  // namespace hermite::server
