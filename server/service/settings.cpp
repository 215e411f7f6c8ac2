#include "server/service/settings.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <set>
#include <string_view>
#include <variant>

namespace hermite::server {

namespace {

constexpr std::string_view kPrefix = "HERMITE_SERVE_";
constexpr std::string_view kConfigVariable = "HERMITE_SERVE_CONFIG";
constexpr std::size_t kMaxTextBytes = 4096;  // a path

using List = std::vector<std::string>;
using Field = std::variant<std::string ServiceOptions::*, int ServiceOptions::*,
                           bool ServiceOptions::*, List ServiceOptions::*>;

struct Row {
  const char* key;
  Field field;
  const char* description;
  int low = 0, high = 0;  // inclusive range of numbers
  const char* unit = "";
  List choices = {};  // of texts; empty: any
};

std::vector<Row> with(const std::vector<Row>& more, std::vector<Row> rows) {
  rows.insert(rows.end(), more.begin(), more.end());
  return rows;
}

// Where results are, if not in the folder of data.
std::vector<Row> rows_of_s3() {
  using O = ServiceOptions;
  return {
      {"database", &O::database,
       "where the rows of scans, tokens and jobs are: postgresql://USER@HOST/DATABASE, or empty: "
       "in the folder of data"},
      {"blobs", &O::blobs,
       "where the results of scans are: s3://BUCKET/PREFIX, or empty: in the folder of data"},
      {"s3-endpoint", &O::s3_endpoint, "https://HOST:PORT of S3; empty: Amazon's of the region"},
      {"s3-region", &O::s3_region, "region of the bucket"},
      {"s3-addressing",
       &O::s3_addressing,
       "path: https://HOST/BUCKET, as most servers have it; virtual-host: https://BUCKET.HOST",
       0,
       0,
       "",
       {"path", "virtual-host"}},
      {"s3-ca", &O::s3_ca, "certificates that S3 is checked with, PEM; empty: the system's"},
      {"s3-credentials", &O::s3_credentials,
       "file, mode 0600, with aws_access_key_id = ... and aws_secret_access_key = ...; empty: "
       "AWS_ACCESS_KEY_ID, ... of the environment"},
  };
}

const std::vector<Row>& rows() {
  using O = ServiceOptions;
  static const std::vector<Row> table = with(
      rows_of_s3(),
      {
          {"listen", &O::listen, "IP:PORT for cameras and browsers; port 0 takes any free one"},
          {"admin-listen", &O::admin_listen,
           "IP:PORT for /healthz, /readyz, /metrics and /debug/trace, without a token; off: none"},
          {"data", &O::data_folder, "folder for scans, database and token"},
          {"web-dir", &O::web_folder, "the viewer's files"},
          {"device", &O::device, "GPU: an index or a part of its name; empty: the best one"},
          {"gpu-memory", &O::gpu_memory_mb,
           "device memory for all scans together, an equal share each; 0: as much as there is", 0,
           1'000'000, "MB"},
          {"max-scans", &O::max_scans, "scans running at once", 1, 64, "scans"},
          {"live-rate", &O::live_rate_hz,
           "frames a second that a live scan gets at least: while it runs, others wait if it would "
           "get fewer; 0: do not ask",
           0, 60, "frames/s"},
          {"credit-window", &O::credit_window,
           "frames a camera may send ahead of the reconstruction", 1, 256, "frames"},
          {"resume-window", &O::resume_window_s,
           "how long a scan waits for its camera when the connection is lost", 0, 86'400, "s"},
          {"frame-patience", &O::frame_patience_s,
           "how long a camera that could send a frame may send none before it loses its place", 1,
           86'400, "s"},
          {"checkpoint-period", &O::checkpoint_period_ms,
           "how often a running scan is stored, so that a restart works through fewer frames "
           "again; 0: never",
           0, 3'600'000, "ms"},
          {"keep-logs", &O::keep_log_days,
           "how long the frames of an ended scan are kept; 0: for ever", 0, 36'500, "days"},
          {"allow-host", &O::allow_hosts, "other names that this server is reached by"},
          {"embed-in", &O::embed_in,
           "sites whose pages may show scans in a frame, as https://example.org or "
           "https://*.example.org; *: any; none: no page may"},
          {"tls-certificate", &O::tls_certificate,
           "certificate and its chain, PEM; read again on SIGHUP; empty: no TLS"},
          {"tls-key", &O::tls_key, "its private key, PEM"},
          {"trusted-proxy", &O::trusted_proxies,
           "addresses or networks (10.0.0.0/8) of proxies that end TLS; X-Forwarded-For and -Proto "
           "are believed from these alone"},
          {"insecure-i-know", &O::insecure_listen,
           "listen on other addresses than the loopback's without encryption"},
          {"drain", &O::drain_s,
           "how long running scans may go on after SIGTERM before they are left to the next server",
           0, 86'400, "s"},
          {"min-free-disk", &O::min_free_disk_mb,
           "room that stays free, beside that for results: else no scan begins, those that run "
           "end, and the server is not ready",
           0, 1'000'000'000, "MB"},
          {"max-connections", &O::max_connections, "connections open at once", 1, 10'000,
           "connections"},
          {"connections-per-address", &O::connections_per_address,
           "the same of one address; a trusted proxy's are not held to it", 1, 10'000,
           "connections"},
          {"connections-per-token", &O::connections_per_token,
           "cameras and viewers of one token without the scope admin", 1, 10'000, "connections"},
          {"requests-per-second", &O::requests_per_second,
           "HTTP requests of one address, and of one token without the scope admin; twice as many "
           "may come at once",
           1, 10'000, "requests"},
          {"failures-per-minute", &O::failures_per_minute,
           "wrong tokens of one address before it has to wait", 1, 1000, "tokens"},
          {"scans-per-token", &O::scans_per_token,
           "scans running at once of one token without the scope admin", 1, 64, "scans"},
          {"storage-gb", &O::storage_gb,
           "for the files of all scans and uploads; when it is used up none begins, and those that "
           "run end; 0: no limit",
           0, 1'000'000, "GB"},
          {"job-workers", &O::job_workers, "jobs at once; each needs one of max-scans", 1, 64,
           "jobs"},
          {"max-upload", &O::max_upload_gb, "one upload", 1, 1'000'000, "GB"},
          {"uploads-per-token", &O::uploads_per_token_gb,
           "all uploads of one token without the scope admin that wait for their job; 0: as much "
           "as there is",
           0, 1'000'000, "GB"},
          {"keep-uploads", &O::keep_upload_hours,
           "how long an upload waits to be gone on with, or for its failed job to be tried again",
           1, 720, "hours"},
          {"mesh-on-demand", &O::mesh_on_demand,
           "make the mesh of a scan when somebody looks at it, and not as soon as it has finished"},
          {"log-format",
           &O::log_format,
           "of the lines on stderr; auto: text on a terminal, else JSON",
           0,
           0,
           "",
           {"auto", "json", "text"}},
          {"log-level",
           &O::log_level,
           "lines below it are left out",
           0,
           0,
           "",
           {"debug", "info", "warn", "error"}},
      });
  return table;
}

const Row* find_row(std::string_view key) {
  const auto found =
      std::find_if(rows().begin(), rows().end(), [key](const Row& row) { return key == row.key; });
  return found == rows().end() ? nullptr : &*found;
}

Error invalid(const std::string& message) { return {ErrorCode::kInvalidArgument, message}; }

std::string as_text(const List& choices) {
  std::string text;
  for (std::size_t i = 0; i < choices.size(); ++i)
    text += (i == 0 ? "" : i + 1 == choices.size() ? " or " : ", ") + choices[i];
  return text;
}

std::string limits_of(const Row& row) {
  if (!row.choices.empty()) return as_text(row.choices);
  if (std::holds_alternative<bool ServiceOptions::*>(row.field)) return "true or false";
  if (!std::holds_alternative<int ServiceOptions::*>(row.field)) return {};
  return std::to_string(row.low) + " to " + std::to_string(row.high) + " " + row.unit;
}

std::string environment_of(const Row& row) {
  std::string name(kPrefix);
  for (const char* c = row.key; *c; ++c)
    name += *c == '-' ? '_' : *c >= 'a' && *c <= 'z' ? static_cast<char>(*c - 'a' + 'A') : *c;
  return name;
}

Error not_allowed(const Row& row, const std::string& value) {
  return invalid("setting " + std::string(row.key) + " is '" + value + "', allowed is " +
                 limits_of(row));
}

// Texts are written to the file in quotes and read back without escapes.
Status check_text(const Row& row, const std::string& text) {
  const auto bad = [](char c) {
    return c == '"' || static_cast<unsigned char>(c) < 0x20 || c == 0x7f;
  };
  if (std::any_of(text.begin(), text.end(), bad))
    return invalid("setting " + std::string(row.key) +
                   " has a quotation mark or a control character");
  if (text.size() > kMaxTextBytes)
    return invalid("setting " + std::string(row.key) + " is longer than " +
                   std::to_string(kMaxTextBytes) + " bytes");
  if (!row.choices.empty() &&
      std::find(row.choices.begin(), row.choices.end(), text) == row.choices.end())
    return not_allowed(row, text);
  return Done{};
}

Status check_list(const Row& row, const List& values) {
  if (values.size() > static_cast<std::size_t>(kMaxListEntries))
    return invalid("setting " + std::string(row.key) + " has " + std::to_string(values.size()) +
                   " values, allowed are " + std::to_string(kMaxListEntries));
  for (const std::string& value : values) {
    if (value.empty() || value.find(',') != std::string::npos)
      return invalid("setting " + std::string(row.key) + " has a value '" + value +
                     "': it may not be empty or have a comma");
    if (Status status = check_text(row, value); !status.ok()) return status;
  }
  return Done{};
}

Status check_number(const Row& row, int number) {
  if (number < row.low || number > row.high) return not_allowed(row, std::to_string(number));
  return Done{};
}

std::string quoted(const std::string& text) { return '"' + text + '"'; }

std::string value_of(const Row& row, const ServiceOptions& options) {
  if (const auto* text = std::get_if<std::string ServiceOptions::*>(&row.field))
    return quoted(options.**text);
  if (const auto* number = std::get_if<int ServiceOptions::*>(&row.field))
    return std::to_string(options.**number);
  if (const auto* flag = std::get_if<bool ServiceOptions::*>(&row.field))
    return options.**flag ? "true" : "false";
  std::string list;
  for (const std::string& entry : options.*std::get<List ServiceOptions::*>(row.field))
    list += (list.empty() ? "" : ", ") + quoted(entry);
  return '[' + list + ']';
}

std::string_view trimmed(std::string_view text) {
  const std::size_t from = text.find_first_not_of(" \t\r");
  if (from == std::string_view::npos) return {};
  return text.substr(from, text.find_last_not_of(" \t\r") - from + 1);
}

// Removes a string from the start of `rest` and returns it; std::nullopt if there is none.
std::optional<std::string> take_string(std::string_view& rest) {
  if (rest.empty() || rest.front() != '"') return std::nullopt;
  const std::size_t end = rest.find('"', 1);
  if (end == std::string_view::npos) return std::nullopt;
  const std::string text(rest.substr(1, end - 1));
  rest = trimmed(rest.substr(end + 1));
  return text;
}

bool is_end(std::string_view rest) { return rest.empty() || rest.front() == '#'; }

Result<List> parse_array(std::string_view rest) {
  List values;
  rest = trimmed(rest.substr(1));
  while (!rest.empty() && rest.front() != ']') {
    const std::optional<std::string> value = take_string(rest);
    if (!value) return invalid("an array has strings in \"quotes\", separated by commas");
    values.push_back(*value);
    if (!rest.empty() && rest.front() == ',')
      rest = trimmed(rest.substr(1));
    else if (rest.empty() || rest.front() != ']')
      break;
  }
  if (rest.empty() || rest.front() != ']') return invalid("the array has no ] on its line");
  if (!is_end(trimmed(rest.substr(1)))) return invalid("something follows the array");
  return values;
}

Result<List> parse_value(std::string_view rest) {
  if (!rest.empty() && rest.front() == '[') return parse_array(rest);
  if (!rest.empty() && rest.front() == '"') {
    const std::optional<std::string> text = take_string(rest);
    if (!text) return invalid("the string has no \" at its end");
    if (!is_end(rest)) return invalid("something follows the string");
    return List{*text};
  }
  const std::string_view word = trimmed(rest.substr(0, rest.find('#')));
  const bool plain =
      !word.empty() &&
      word.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-+") == std::string_view::npos;
  if (!plain)
    return invalid(
        "expected key = value, where the value is a \"string\", a whole number, true, false or "
        "[\"a\", \"b\"]");
  return List{std::string(word)};
}

Status apply_line(ServiceOptions& options, std::string_view line, std::set<std::string>& seen) {
  const std::size_t equals = line.find('=');
  if (line.front() == '[') return invalid("there are no sections in this file");
  if (equals == std::string_view::npos) return invalid("expected key = value");
  const std::string key(trimmed(line.substr(0, equals)));
  if (!seen.insert(key).second) return invalid("setting " + key + " is there twice");
  const Result<List> values = parse_value(trimmed(line.substr(equals + 1)));
  if (!values.ok()) return in_context("setting " + key, values.error());
  return apply_setting(options, key, *values);
}

}  // namespace

std::vector<ServiceSetting> list_settings(const ServiceOptions& options) {
  constexpr std::array<SettingKind, 4> kKinds{SettingKind::kText, SettingKind::kNumber,
                                              SettingKind::kFlag, SettingKind::kList};
  std::vector<ServiceSetting> settings;
  for (const Row& row : rows())
    settings.push_back({row.key, kKinds[row.field.index()], value_of(row, options), limits_of(row),
                        environment_of(row), row.description});
  return settings;
}

Status apply_setting(ServiceOptions& options, const std::string& key,
                     const std::vector<std::string>& values) {
  const Row* const row = find_row(key);
  if (!row)
    return Error{ErrorCode::kNotFound,
                 "there is no setting '" + key + "'; `hermite serve --print-config` lists them"};
  if (const auto* list = std::get_if<List ServiceOptions::*>(&row->field)) {
    if (Status status = check_list(*row, values); !status.ok()) return status;
    options.** list = values;
    return Done{};
  }
  if (values.size() != 1)
    return invalid("setting " + key + " takes one value, given are " +
                   std::to_string(values.size()));
  const std::string& value = values.front();
  if (const auto* text = std::get_if<std::string ServiceOptions::*>(&row->field)) {
    if (Status status = check_text(*row, value); !status.ok()) return status;
    options.** text = value;
  } else if (const auto* flag = std::get_if<bool ServiceOptions::*>(&row->field)) {
    if (value != "true" && value != "false") return not_allowed(*row, value);
    options.** flag = value == "true";
  } else {
    int number = 0;
    const auto [stop, error] = std::from_chars(value.data(), value.data() + value.size(), number);
    if (error != std::errc() || stop != value.data() + value.size())
      return not_allowed(*row, value);
    if (Status status = check_number(*row, number); !status.ok()) return not_allowed(*row, value);
    options.*std::get<int ServiceOptions::*>(row->field) = number;
  }
  return Done{};
}

Status apply_config(ServiceOptions& options, const std::string& text) {
  if (text.size() > kMaxConfigBytes)
    return invalid("the file is longer than " + std::to_string(kMaxConfigBytes) + " bytes");
  std::set<std::string> seen;
  int number = 0;
  for (std::size_t from = 0; from < text.size();) {
    const std::size_t end = std::min(text.find('\n', from), text.size());
    const std::string_view line = trimmed(std::string_view(text).substr(from, end - from));
    from = end + 1;
    ++number;
    if (is_end(line)) continue;
    if (Status status = apply_line(options, line, seen); !status.ok())
      return in_context("line " + std::to_string(number),
                        {ErrorCode::kInvalidArgument, status.error().message});
  }
  return Done{};
}

Status apply_environment(ServiceOptions& options, const char* const* variables) {
  for (; *variables; ++variables) {
    const std::string_view variable = *variables;
    const std::string_view name = variable.substr(0, variable.find('='));
    if (!name.starts_with(kPrefix) || name == kConfigVariable || name.size() == variable.size())
      continue;
    const std::string value(variable.substr(name.size() + 1));
    const auto row = std::find_if(rows().begin(), rows().end(), [name](const Row& candidate) {
      return name == environment_of(candidate);
    });
    if (row == rows().end())
      return invalid("the environment has " + std::string(name) +
                     ", which is no setting; `hermite serve --print-config` lists them");
    List values{value};
    if (std::holds_alternative<List ServiceOptions::*>(row->field)) {
      values.clear();
      for (std::size_t from = 0; from < value.size();) {
        const std::size_t end = std::min(value.find(',', from), value.size());
        values.emplace_back(trimmed(std::string_view(value).substr(from, end - from)));
        from = end + 1;
      }
    }
    if (Status status = apply_setting(options, row->key, values); !status.ok())
      return in_context(std::string(name), status.error());
  }
  return Done{};
}

std::string format_config(const ServiceOptions& options, const ServiceOptions& defaults) {
  std::string text =
      "# Settings of `hermite serve`, as they are now. A flag (--key VALUE) goes before the "
      "environment, the environment before the file\n"
      "# (--config FILE), the file before the default.\n";
  const std::vector<ServiceSetting> standard = list_settings(defaults);
  const std::vector<ServiceSetting> settings = list_settings(options);
  for (std::size_t i = 0; i < settings.size(); ++i) {
    const ServiceSetting& setting = settings[i];
    text += "\n# " + setting.description + "\n# default: " + standard[i].value;
    if (!setting.limits.empty()) text += "; allowed: " + setting.limits;
    text +=
        "; environment: " + setting.environment + "\n" + setting.key + " = " + setting.value + "\n";
  }
  return text;
}

Status check(const ServiceOptions& options) {
  for (const Row& row : rows()) {
    Status status = Done{};
    if (const auto* text = std::get_if<std::string ServiceOptions::*>(&row.field))
      status = check_text(row, options.**text);
    if (const auto* number = std::get_if<int ServiceOptions::*>(&row.field))
      status = check_number(row, options.**number);
    if (const auto* list = std::get_if<List ServiceOptions::*>(&row.field))
      status = check_list(row, options.**list);
    if (!status.ok()) return status;
  }
  if (options.tls_certificate.empty() != options.tls_key.empty())
    return invalid("settings tls-certificate and tls-key go together: one of them is empty");
  return Done{};
}

}  // namespace hermite::server
