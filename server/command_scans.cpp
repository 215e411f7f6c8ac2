// hermite-client list, show, rename, tag, stop, delete and share
#include <fmt/core.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iomanip>
#include <iostream>
#include <memory>

#include "server/client/printable.h"
#include "server/client/scans.h"
#include "server/client_commands.h"

namespace hermite::commands {

namespace {

using client::printable;

constexpr std::size_t kDefaultListed = 1000;

struct ScansArguments {
  ServerArguments server;
  std::string scan, title, state, name, revoke;
  std::vector<std::string> tags;
  std::size_t count = kDefaultListed;
  int days = 0;
  bool json = false, yes = false, list = false;
};

// Turns "2024-05-01T12:00:00.123Z" into "2024-05-01 12:00 UTC".
std::string minute_of(const std::string& utc) {
  return utc.size() < 16 ? "-" : fmt::format("{} {} UTC", utc.substr(0, 10), utc.substr(11, 5));
}

bool contains(const std::string& text, const std::string& part) {
  const auto same = [](unsigned char a, unsigned char b) {
    return std::tolower(a) == std::tolower(b);
  };
  return std::search(text.begin(), text.end(), part.begin(), part.end(), same) != text.end();
}

bool is_asked_for(const client::ScanSummary& scan, const ScansArguments& arguments) {
  const auto has = [&scan](const std::string& tag) {
    return std::find(scan.tags.begin(), scan.tags.end(), tag) != scan.tags.end();
  };
  return (arguments.state.empty() || scan.state == arguments.state) &&
         contains(scan.title, arguments.title) &&
         std::all_of(arguments.tags.begin(), arguments.tags.end(), has);
}

// "  [a, b]"; nothing without tags.
std::string tags_text(const std::vector<std::string>& tags) {
  std::string list;
  for (const std::string& tag : tags) list += (list.empty() ? "" : ", ") + printable(tag);
  return list.empty() ? "" : fmt::format("  [{}]", list);
}

int run_list(const client::ApiTarget& target, const ScansArguments& arguments) {
  // One more, to find out whether these are all.
  Result<std::vector<client::ScanSummary>> scans = client::list_scans(target, arguments.count + 1);
  if (!scans.ok()) return fail(status_of_answer(scans.error()), scans.error().message);
  const bool are_all = scans->size() <= arguments.count;
  if (!are_all) scans->pop_back();
  std::size_t shown = 0;
  for (const client::ScanSummary& scan : *scans) {
    if (!is_asked_for(scan, arguments)) continue;
    ++shown;
    if (arguments.json)
      std::cout << scan.json << '\n';
    else
      std::cout << scan.id << "  " << minute_of(scan.created_at) << "  " << std::left
                << std::setw(11) << scan.state << "  " << std::right << std::setw(6)
                << scan.frames_processed << " frames  " << printable(scan.title)
                << tags_text(scan.tags) << '\n';
  }
  if (!arguments.json && shown == 0)
    std::cerr << "no scan matches, of " << scans->size() << " looked at\n";
  if (!are_all)
    std::cerr << "only the newest " << arguments.count << " were looked at: --count has more\n";
  return 0;
}

void print(const client::ScanSummary& scan) {
  std::cout << "id        " << scan.id << "\ntitle     " << printable(scan.title)
            << tags_text(scan.tags) << "\nstate     " << printable(scan.state);
  if (!scan.message.empty()) std::cout << ": " << printable(scan.message);
  std::cout << "\nbegun     " << minute_of(scan.created_at) << "\nended     "
            << minute_of(scan.finished_at) << "\nimages    " << scan.width_px << "x"
            << scan.height_px << "\nframes    " << scan.frames_processed << " of "
            << scan.frames_received << " received";
  if (scan.frames_dropped > 0) std::cout << ", " << scan.frames_dropped << " dropped";
  std::cout << '\n';
}

int print_scan(const Result<client::ScanSummary>& scan, bool json) {
  if (!scan.ok()) return fail(status_of_answer(scan.error()), scan.error().message);
  if (json)
    std::cout << scan->json << '\n';
  else
    print(*scan);
  return 0;
}

int print_done(const Status& done, const std::string& message) {
  if (!done.ok()) return fail(status_of_answer(done.error()), done.error().message);
  std::cerr << message << '\n';
  return 0;
}

// Deletion includes the frames, so a user at a terminal is asked to confirm, and a script needs
// --yes.
int run_delete(const client::ApiTarget& target, const ScansArguments& arguments) {
  const Result<client::ScanSummary> scan = client::show_scan(target, arguments.scan);
  if (!scan.ok()) return fail(status_of_answer(scan.error()), scan.error().message);
  if (!arguments.yes) {
    if (isatty(STDIN_FILENO) == 0)
      return fail(kUsage, "nothing was deleted: without a terminal to ask on, say --yes");
    std::cerr << "Delete \"" << printable(scan->title) << "\" (" << scan->frames_processed
              << " frames) with all of its files? [y/N] ";
    std::string answer;
    std::getline(std::cin, answer);
    if (answer != "y" && answer != "Y" && answer != "yes")
      return fail(kUsage, "nothing was deleted");
  }
  return print_done(client::delete_scan(target, arguments.scan),
                    fmt::format("deleted \"{}\"", printable(scan->title)));
}

int print_shares(const Result<std::vector<client::ShareSummary>>& shares, bool json) {
  if (!shares.ok()) return fail(status_of_answer(shares.error()), shares.error().message);
  for (const client::ShareSummary& share : *shares)
    if (json)
      std::cout << share.json << '\n';
    else
      std::cout << share.id << "  " << share.scan << "  " << std::left << std::setw(7)
                << share.state << "  until " << minute_of(share.expires_at) << "  "
                << printable(share.name) << '\n';
  if (!json && shares->empty()) std::cerr << "there are no share links\n";
  return 0;
}

int run_share(const client::ApiTarget& target, const ScansArguments& arguments) {
  if (!arguments.revoke.empty())
    return print_done(client::revoke_share(target, arguments.revoke),
                      "revoked " + arguments.revoke);
  if (arguments.list)
    return print_shares(client::list_shares(target, arguments.scan), arguments.json);
  if (arguments.scan.empty()) return fail(kUsage, "share needs SCAN, --list or --revoke ID");
  const Result<std::string> link =
      client::share_scan(target, arguments.scan, arguments.name, arguments.days);
  if (!link.ok()) return fail(status_of_answer(link.error()), link.error().message);
  std::cout << *link << '\n';
  return 0;
}

using Run = int (*)(const client::ApiTarget&, const ScansArguments&);

// A command with the options common to all of these.
struct ScansCommand {
  CLI::App* app;
  std::shared_ptr<ScansArguments> arguments;
};

ScansCommand add_command(CLI::App& app, const char* name, const char* description) {
  ScansCommand command{app.add_subcommand(name, description), std::make_shared<ScansArguments>()};
  add_server_options(*command.app, command.arguments->server)->required();
  return command;
}

// Ids are used in paths without escaping.
CLI::Validator is_id() {
  return CLI::Validator(
      [](std::string& text) {
        const bool well =
            text.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789") == std::string::npos &&
            !text.empty();
        return well ? std::string() : "an id has only a-z and 0-9";
      },
      "");
}

CLI::Option* add_scan(const ScansCommand& command) {
  return command.app
      ->add_option("SCAN", command.arguments->scan,
                   "Id of the scan, as list and the viewer's address have it")
      ->check(is_id());
}

void add_json(const ScansCommand& command) {
  command.app->add_flag("--json", command.arguments->json, "One JSON object on a line");
}

Command finish(const ScansCommand& command, Run run) {
  return {command.app, [arguments = command.arguments, run] {
            const Result<client::ApiTarget> target = api_target_of(arguments->server);
            return target.ok() ? run(*target, *arguments) : fail(kUsage, target.error().message);
          }};
}

}  // namespace

Command add_list_command(CLI::App& app) {
  const ScansCommand list =
      add_command(app, "list", "List the scans of a server, the newest first");
  list.app->add_option("--title", list.arguments->title,
                       "Only those whose title contains this, in upper or lower case");
  list.app->add_option("--tag", list.arguments->tags,
                       "Only those with this tag, as it is written; may be repeated");
  list.app->add_option("--state", list.arguments->state, "Only those in this state")
      ->check(CLI::IsMember({"running", "finished", "failed", "interrupted"}));
  list.app->add_option("--count", list.arguments->count, "Look at so many scans at most")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  add_json(list);
  return finish(list, run_list);
}

Command add_show_command(CLI::App& app) {
  const ScansCommand show = add_command(app, "show", "Say what a scan is and how it went");
  add_scan(show)->required();
  add_json(show);
  return finish(show, [](const client::ApiTarget& target, const ScansArguments& arguments) {
    return print_scan(client::show_scan(target, arguments.scan), arguments.json);
  });
}

Command add_tag_command(CLI::App& app) {
  const ScansCommand tag =
      add_command(app, "tag", "Give a scan these tags instead of those that it has");
  add_scan(tag)->required();
  tag.app->add_option("TAG", tag.arguments->tags,
                      "Up to 20, of up to 50 bytes; none: it has no tags afterwards");
  add_json(tag);
  return finish(tag, [](const client::ApiTarget& target, const ScansArguments& arguments) {
    return print_scan(client::tag_scan(target, arguments.scan, arguments.tags), arguments.json);
  });
}

Command add_rename_command(CLI::App& app) {
  const ScansCommand rename = add_command(app, "rename", "Give a scan another title");
  add_scan(rename)->required();
  rename.app->add_option("TITLE", rename.arguments->title, "The new title")->required();
  add_json(rename);
  return finish(rename, [](const client::ApiTarget& target, const ScansArguments& arguments) {
    return print_scan(client::rename_scan(target, arguments.scan, arguments.title), arguments.json);
  });
}

Command add_stop_command(CLI::App& app) {
  const ScansCommand stop = add_command(app, "stop", "End a scan that runs; it keeps what it has");
  add_scan(stop)->required();
  return finish(stop, [](const client::ApiTarget& target, const ScansArguments& arguments) {
    return print_done(client::stop_scan(target, arguments.scan),
                      "the scan ends: its results are written now");
  });
}

Command add_pause_command(CLI::App& app) {
  const ScansCommand pause =
      add_command(app, "pause", "Ask the camera of a scan that runs to pause");
  add_scan(pause)->required();
  return finish(pause, [](const client::ApiTarget& target, const ScansArguments& arguments) {
    return print_done(client::pause_scan(target, arguments.scan, true),
                      "the camera is asked to pause");
  });
}

Command add_unpause_command(CLI::App& app) {
  const ScansCommand unpause =
      add_command(app, "unpause", "Ask the camera of a paused scan to go on");
  add_scan(unpause)->required();
  return finish(unpause, [](const client::ApiTarget& target, const ScansArguments& arguments) {
    return print_done(client::pause_scan(target, arguments.scan, false),
                      "the camera is asked to go on");
  });
}

Command add_delete_command(CLI::App& app) {
  const ScansCommand remove = add_command(
      app, "delete", "Delete a scan with all of its files; needs a token of scope admin");
  add_scan(remove)->required();
  remove.app->add_flag("--yes", remove.arguments->yes, "Do not ask");
  return finish(remove, run_delete);
}

Command add_share_command(CLI::App& app) {
  const ScansCommand share = add_command(
      app, "share", "Print a link with which anybody may look at a scan; list links or revoke one");
  add_scan(share);
  share.app->add_option("--name", share.arguments->name, "For whom the link is, at most 100 bytes");
  share.app->add_option("--days", share.arguments->days, "Until it expires (default 7)")
      ->check(CLI::Range(1, 365));
  share.app->add_flag("--list", share.arguments->list, "List the links of SCAN, or of all scans");
  share.app
      ->add_option("--revoke", share.arguments->revoke,
                   "Revoke the link of this id, which --list has")
      ->check(is_id());
  add_json(share);
  return finish(share, run_share);
}

}  // namespace hermite::commands
