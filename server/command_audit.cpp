// hermite audit
#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>

#include "server/access/audit.h"
#include "server/commands.h"

namespace hermite::commands {

namespace {

struct AuditArguments {
  std::string data = default_data_folder();
  bool check_only = false;
};

int run_audit(const AuditArguments& arguments) {
  const server::AuditCheck check = or_throw(
      server::check_audit(arguments.data + "/audit", [&arguments](const std::string& line) {
        if (!arguments.check_only) std::cout << line << '\n';
      }));
  std::cout << std::flush;
  for (const std::string& remark : check.remarks) std::cerr << remark << '\n';
  if (!check.broken.empty()) {
    std::cerr << "the chain is broken: " << check.broken << '\n';
    return kFailed;
  }
  std::cerr << check.entry_count << " entries, the last one is " << check.head
            << ": the chain holds\n";
  return 0;
}

}  // namespace

Command add_audit_command(CLI::App& app) {
  auto arguments = std::make_shared<AuditArguments>();
  CLI::App& audit = *app.add_subcommand(
      "audit", "Print who did what to which scan or token, and check that nothing was changed");
  audit.add_option("--data", arguments->data, "The server's data folder")->capture_default_str();
  audit.add_flag("--check", arguments->check_only,
                 "Print nothing but whether the chain of hashes holds");
  return {&audit, [arguments] { return run_audit(*arguments); }};
}

}  // namespace hermite::commands
