#include "server/slurm/process.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <memory>
#include <utility>

#include "server/store/errno_error.h"
#include "server/store/owned_descriptor.h"

namespace hermite::server {

namespace {

using ProcessClock = std::chrono::steady_clock;

struct OutputPipe {
  std::unique_ptr<OwnedDescriptor> near, far;
};

Result<OutputPipe> open_pipe() {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) return errno_error("making a pipe");
  return OutputPipe{std::make_unique<OwnedDescriptor>(ends[0]),
                    std::make_unique<OwnedDescriptor>(ends[1])};
}

// Its own group, so that all of it can be killed.
Result<pid_t> spawn(const std::vector<std::string>& arguments, const OutputPipe& output,
                    const OutputPipe& errors) {
  posix_spawn_file_actions_t actions;
  posix_spawnattr_t attributes;
  posix_spawn_file_actions_init(&actions);
  posix_spawnattr_init(&attributes);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, output.far->descriptor, STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, errors.far->descriptor, STDERR_FILENO);
  posix_spawn_file_actions_addclosefrom_np(&actions, STDERR_FILENO + 1);
  posix_spawnattr_setpgroup(&attributes, 0);
  sigset_t none;
  sigemptyset(&none);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK);
  std::vector<char*> words;
  for (const std::string& word : arguments) words.push_back(const_cast<char*>(word.c_str()));
  words.push_back(nullptr);
  pid_t child = -1;
  const int failure =
      posix_spawnp(&child, words.front(), &actions, &attributes, words.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (failure == ENOENT)
    return Error{ErrorCode::kNotFound, arguments.front() + " is not installed here"};
  if (failure != 0)
    return Error{ErrorCode::kIo,
                 fmt::format("starting {}: {}", arguments.front(), std::strerror(failure))};
  return child;
}

// Reads what there is; false at the end of the stream.
bool take_some(int from, std::string& text) {
  std::array<char, 65536> bytes;
  const ssize_t count = ::read(from, bytes.data(), bytes.size());
  if (count < 0) return errno == EINTR || errno == EAGAIN;
  text.append(bytes.data(), static_cast<std::size_t>(count));
  return count > 0;
}

// Until both streams have ended.
Status read_streams(const std::string& program, const OutputPipe& output, const OutputPipe& errors,
                    const ProcessLimits& limits, ProcessResult& result) {
  const ProcessClock::time_point deadline = ProcessClock::now() + limits.patience;
  std::array<pollfd, 2> streams{pollfd{output.near->descriptor, POLLIN, 0},
                                pollfd{errors.near->descriptor, POLLIN, 0}};
  std::array<std::string*, 2> texts{&result.output, &result.errors};
  while (streams[0].fd >= 0 || streams[1].fd >= 0) {
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(deadline - ProcessClock::now());
    if (left.count() <= 0)
      return Error{ErrorCode::kUnavailable, fmt::format("{} did not answer within {} s", program,
                                                        limits.patience.count() / 1000)};
    if (poll(streams.data(), streams.size(), static_cast<int>(left.count()) + 1) < 0) {
      if (errno == EINTR) continue;
      return errno_error("waiting for " + program);
    }
    for (std::size_t i = 0; i < streams.size(); ++i) {
      if (streams[i].fd < 0 || streams[i].revents == 0) continue;
      if (!take_some(streams[i].fd, *texts[i])) streams[i].fd = -1;
      if (texts[i]->size() > limits.max_bytes)
        return Error{ErrorCode::kTooLarge,
                     fmt::format("{} printed more than {} bytes", program, limits.max_bytes)};
    }
  }
  return Done{};
}

int wait_for(pid_t child) {
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace

Result<ProcessResult> run_process(const std::vector<std::string>& arguments,
                                  const ProcessLimits& limits) {
  Result<OutputPipe> output = open_pipe(), errors = open_pipe();
  if (!output.ok()) return output.error();
  if (!errors.ok()) return errors.error();
  const Result<pid_t> child = spawn(arguments, *output, *errors);
  if (!child.ok()) return child.error();
  output->far.reset();
  errors->far.reset();
  ProcessResult result;
  const Status read = read_streams(arguments.front(), *output, *errors, limits, result);
  if (!read.ok()) kill(-*child, SIGKILL);
  result.exit_status = wait_for(*child);
  if (!read.ok()) return read.error();
  return result;
}

}  // namespace hermite::server
