// hermite doctor
#include <fmt/core.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <memory>

#include "core/pipeline/doctor.h"
#include "server/commands.h"
#include "server/store/disk_space.h"

namespace hermite::commands {

namespace {

constexpr std::uint64_t kEnoughDisk_bytes = 5ull << 30;  // results of a few hundred large scans

struct DoctorArguments {
  std::string device;
  std::string data_folder;
};

// Returns the folder itself, or its nearest existing parent.
std::filesystem::path existing_folder(const std::string& folder) {
  std::error_code error;
  std::filesystem::path path = std::filesystem::absolute(folder, error);
  while (!std::filesystem::is_directory(path, error) && path.has_parent_path() &&
         path != path.parent_path())
    path = path.parent_path();
  return path;
}

pipeline::DeviceReport examine_disk(const std::string& data_folder) {
  pipeline::DeviceReport report;
  const std::string folder = existing_folder(data_folder).string();
  if (access(folder.c_str(), W_OK | X_OK) != 0)
    report.problems.push_back(fmt::format("the data folder {} cannot be written: {}: {}",
                                          data_folder, folder, std::strerror(errno)));
  const Result<std::uint64_t> free = server::free_bytes(folder);
  if (!free.ok()) {
    report.problems.push_back(free.error().message);
    return report;
  }
  const std::string text =
      fmt::format("{} MiB free for the data folder {}", *free >> 20, data_folder);
  (*free < kEnoughDisk_bytes ? report.problems : report.facts)
      .push_back(text + (*free < kEnoughDisk_bytes ? ": less than 5 GiB" : ""));
  return report;
}

void print(const pipeline::DeviceReport& report) {
  for (const std::string& fact : report.facts) std::cout << "  " << fact << '\n';
  for (const std::string& problem : report.problems) std::cout << "  PROBLEM: " << problem << '\n';
}

int run_doctor(const DoctorArguments& arguments) {
  std::cout << "GPU" << std::endl;
  const pipeline::DeviceReport gpu = pipeline::examine_device(arguments.device);
  print(gpu);
  std::cout << "Disk" << std::endl;
  const pipeline::DeviceReport disk = examine_disk(arguments.data_folder);
  print(disk);
  const std::size_t problem_count = gpu.problems.size() + disk.problems.size();
  if (problem_count == 0) {
    std::cout << "All well: scans can run here.\n";
    return 0;
  }
  std::cout << problem_count << (problem_count == 1 ? " problem.\n" : " problems.\n");
  return kFailed;
}

}  // namespace

Command add_doctor_command(CLI::App& app) {
  auto arguments = std::make_shared<DoctorArguments>();
  arguments->data_folder = default_data_folder();
  CLI::App& doctor =
      *app.add_subcommand("doctor", "Check GPU, shaders and disk, and say in words what is wrong");
  doctor.add_option("--device", arguments->device,
                    "GPU: an index or a part of its name (default: the best one)");
  doctor.add_option("--data", arguments->data_folder, "Folder that the server would use")
      ->capture_default_str();
  return {&doctor, [arguments] { return run_doctor(*arguments); }};
}

}  // namespace hermite::commands
