// hermite token, hermite share: manage who may use a server. For a data folder that no server uses,
// they change its database; if a server is running, they send it requests, because only one program
// may have the database open.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <iomanip>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <system_error>

#include "server/access/administration.h"
#include "server/access/audit.h"
#include "server/access/gate.h"
#include "server/client/api_request.h"
#include "server/commands.h"
#include "server/service/service.h"
#include "server/store/data_directory.h"
#include "server/store/folder_lock.h"
#include "server/store/rows_place.h"
#include "server/store/store.h"
#include "server/store/unix_time.h"

namespace hermite::commands {

namespace {

using Json = nlohmann::ordered_json;

struct TokenOptions {
  std::string data_folder;
  bool json = false;
  std::string name;
  std::vector<std::string> scopes = {"view", "scan"};
  int days = server::kDefaultTokenDays;
  std::string id;       // of a token, share link or scan
  std::string address;  // of the server, for links
};

// Manages tokens through a running server, or in the store.
class Office {
 public:
  // Throws SetupError if neither is available.
  explicit Office(const std::string& data_folder) {
    std::error_code error;
    if (!std::filesystem::is_directory(data_folder, error))
      throw SetupError({ErrorCode::kInvalidArgument,
                        fmt::format("there is no data folder {} (see --data)", data_folder)});
    try {
      data_.emplace(data_folder);
      store_.emplace(server::open_rows(data_folder, ""));
      server::Gate(*store_, server::ServiceOptions().failures_per_minute)
          .install_first_token(data_->token(), server::unix_now_ms());
    } catch (const SetupError& failure) {
      if (failure.error().code != ErrorCode::kBusy) throw;
      server_ = running_server(data_folder);
    }
  }

  Result<std::string> create_token(const std::string& request) {
    return server_ ? ask("POST", "/api/v1/tokens", request)
                   : noted("POST tokens", "",
                           server::create_token(*store_, request, server::unix_now_ms()));
  }
  Result<std::string> list_tokens() {
    return server_ ? ask("GET", "/api/v1/tokens", "")
                   : server::list_tokens(*store_, server::unix_now_ms());
  }
  Result<std::string> create_share(const std::string& scan_id, const std::string& request) {
    return server_ ? ask("POST", fmt::format("/api/v1/scans/{}/shares", scan_id), request)
                   : noted("POST shares", scan_id,
                           server::create_share(*store_, scan_id, request, server::unix_now_ms()));
  }
  Result<std::string> list_shares() {
    return server_ ? ask("GET", "/api/v1/shares", "")
                   : server::list_shares(*store_, "", server::unix_now_ms());
  }
  Result<std::string> revoke(const std::string& kind, const std::string& id) {
    if (server_) return ask("DELETE", fmt::format("/api/v1/{}s/{}", kind, id), "");
    return noted("DELETE " + kind, id,
                 server::revoke_row(*store_, id, kind == "share", server::unix_now_ms()));
  }
  std::string address() const {
    return server_ ? (server_->tls ? "https://" : "http://") + server_->host_and_port()
                   : "http://127.0.0.1:8080";
  }

 private:
  // Writes to the audit log, as a server does.
  Result<std::string> noted(const std::string& did, const std::string& to,
                            Result<std::string> done) const {
    server::Audit(data_->audit_folder(), server::unix_now_ms())
        .note({server::unix_now_ms(), "", "the owner of the data folder", did, to,
               done.ok() ? "done" : name_of(done.error().code)});
    return done;
  }

  static client::ServerUrl running_server(const std::string& data_folder) {
    const Result<server::PublishedServer> published = server::published_server(data_folder);
    if (!published.ok()) throw SetupError(published.error());
    Result<client::ServerUrl> url = client::parse_server_url(published->url);
    if (!url.ok())
      throw SetupError(in_context("asking the server that uses " + data_folder, url.error()));
    url->token = published->token;
    return *std::move(url);
  }

  Result<std::string> ask(const std::string& method, const std::string& path,
                          const std::string& body) const {
    Result<std::string> answer = client::api_request(*server_, method, path, body);
    if (answer.ok() || answer.error().code != ErrorCode::kUnauthorized) return answer;
    return Error{
        ErrorCode::kUnauthorized,
        fmt::format("the running server was asked with its first token and said: {}; stop the "
                    "server to manage tokens here, or use its HTTP API with a token of scope admin",
                    answer.error().message)};
  }

  std::optional<server::DataDirectory> data_;
  std::optional<server::Store> store_;
  std::optional<client::ServerUrl> server_;
};

std::string text_or(const Json& value, const std::string& otherwise) {
  return value.is_string() ? value.get<std::string>() : otherwise;
}

// Returns what a row allows: the scopes of a token, the scan of a share link.
std::string purpose_of(const Json& row) {
  if (row.contains("scan")) return row["scan"];
  std::string scopes;
  for (const Json& scope : row["scopes"])
    scopes += (scopes.empty() ? "" : ",") + scope.get<std::string>();
  return scopes;
}

void print_rows(const Json& rows, const char* purpose) {
  const auto line = [](const auto& id, const auto& state, const auto& what, const auto& expires,
                       const auto& used, const auto& name) {
    std::cout << std::left << std::setw(14) << id << std::setw(9) << state << std::setw(28) << what
              << std::setw(12) << expires << std::setw(18) << used << name << '\n';
  };
  line("ID", "STATE", purpose, "EXPIRES", "LAST USE (UTC)", "NAME");
  for (const Json& row : rows)
    line(text_or(row["id"], ""), text_or(row["state"], ""), purpose_of(row),
         text_or(row["expires_at"], "never").substr(0, 10),
         text_or(row["used_at"], "not yet").substr(0, 16), text_or(row["name"], ""));
}

// Returns the exit status; `print` prints the answer for people.
template <class Print>
int report(const Result<std::string>& answer, bool json, Print print) {
  if (!answer.ok()) {
    std::cerr << "hermite: " << answer.error().message << '\n';
    return answer.error().code == ErrorCode::kInvalidArgument ? kUsage : kFailed;
  }
  if (json)
    std::cout << *answer;
  else
    print(Json::parse(*answer));
  return 0;
}

int create_token_now(const TokenOptions& options) {
  const Json request = {{"name", options.name}, {"scopes", options.scopes}, {"days", options.days}};
  return report(Office(options.data_folder).create_token(request.dump()), options.json,
                [](const Json& made) {
                  std::cout << text_or(made["secret"], "") << std::endl;
                  std::cerr << "Token " << text_or(made["token"]["id"], "") << " for "
                            << purpose_of(made["token"]) << ", expires "
                            << text_or(made["token"]["expires_at"], "never").substr(0, 10)
                            << ". It is shown this once.\n";
                });
}

int create_share_now(const TokenOptions& options) {
  const Json request = {{"name", options.name}, {"days", options.days}};
  Office office(options.data_folder);
  const std::string address = options.address.empty() ? office.address() : options.address;
  return report(office.create_share(options.id, request.dump()), options.json,
                [&address](const Json& made) {
                  std::cout << address << text_or(made["path"], "") << std::endl;
                  std::cerr << "Share link " << text_or(made["share"]["id"], "") << ", expires "
                            << text_or(made["share"]["expires_at"], "never").substr(0, 10)
                            << ". It is shown this once.\n";
                });
}

// The three subcommands of `what`; the one that was given sets `run`.
struct Group {
  CLI::App* app;
  std::shared_ptr<TokenOptions> options = std::make_shared<TokenOptions>();
  std::shared_ptr<std::function<int()>> run = std::make_shared<std::function<int()>>();

  Group(CLI::App& parent, const char* name, const char* description)
      : app(parent.add_subcommand(name, description)) {
    app->require_subcommand(1);
    options->data_folder = default_data_folder();
  }
  CLI::App& add(const char* name, const char* description, int (*command)(const TokenOptions&)) {
    CLI::App& added = *app->add_subcommand(name, description);
    added.add_option("--data", options->data_folder, "The server's folder")->capture_default_str();
    added.add_flag("--json", options->json, "Prints the whole answer");
    added.callback([own_run = run, own_options = options, command] {
      *own_run = [own_options, command] { return command(*own_options); };
    });
    return added;
  }
  Command command() const {
    return {app, [own_run = run] { return (*own_run)(); }};
  }
};

}  // namespace

Command add_token_command(CLI::App& app) {
  Group group(app, "token", "Who may use the server");
  CLI::App& create =
      group.add("create", "Prints a new token, which is never shown again", create_token_now);
  create.add_option("--name", group.options->name, "What it is for");
  create
      .add_option("--scope", group.options->scopes,
                  "view, scan (stream frames), admin (delete and manage); may be repeated")
      ->capture_default_str()
      ->check(CLI::IsMember({"view", "scan", "admin"}));
  create.add_option("--days", group.options->days, "Until it expires; 0: never")
      ->capture_default_str();
  group.add("list", "Shows all tokens", [](const TokenOptions& options) {
    return report(Office(options.data_folder).list_tokens(), options.json,
                  [](const Json& list) { print_rows(list["tokens"], "SCOPES"); });
  });
  CLI::App& revoke = group.add(
      "revoke", "Ends a token and what was opened with it", [](const TokenOptions& options) {
        return report(Office(options.data_folder).revoke("token", options.id), options.json,
                      [](const Json&) {});
      });
  revoke.add_option("ID", group.options->id, "As `hermite token list` shows it")->required();
  return group.command();
}

Command add_share_command(CLI::App& app) {
  Group group(app, "share", "Links that show one scan, to look at only");
  group.options->days = server::kDefaultShareDays;
  CLI::App& create =
      group.add("create", "Prints a new link, which is never shown again", create_share_now);
  create.add_option("SCAN", group.options->id, "The scan's id")->required();
  create.add_option("--name", group.options->name, "Who it is for");
  create.add_option("--days", group.options->days, "Until it expires")->capture_default_str();
  create.add_option("--address", group.options->address,
                    "What the link begins with, for a server behind a proxy: https://NAME");
  group.add("list", "Shows all share links", [](const TokenOptions& options) {
    return report(Office(options.data_folder).list_shares(), options.json,
                  [](const Json& list) { print_rows(list["shares"], "SCAN"); });
  });
  CLI::App& revoke =
      group.add("revoke", "Ends a share link, also for those who are looking",
                [](const TokenOptions& options) {
                  return report(Office(options.data_folder).revoke("share", options.id),
                                options.json, [](const Json&) {});
                });
  revoke.add_option("ID", group.options->id, "As `hermite share list` shows it")->required();
  return group.command();
}

}  // namespace hermite::commands
