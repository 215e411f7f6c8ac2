#include "server/client/load_machine.h"

#include <fmt/core.h>
#include <sys/resource.h>
#include <time.h>

#include <algorithm>
#include <string>
#include <utility>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>

namespace hermite::client {

namespace {

double cpu_s(clockid_t clock) {
  timespec time{};
  clock_gettime(clock, &time);
  return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_nsec) * 1e-9;
}

}  // namespace

double process_cpu_s() { return cpu_s(CLOCK_PROCESS_CPUTIME_ID); }

double thread_cpu_s() { return cpu_s(CLOCK_THREAD_CPUTIME_ID); }

// A connected UDP socket has sent nothing yet, but has the address from which it would.
bool is_this_machine(const ServerUrl& server) {
  using boost::asio::ip::udp;
  boost::asio::io_context io;
  boost::system::error_code error;
  udp::resolver resolver(io);
  const auto found = resolver.resolve(server.host, std::to_string(server.port), error);
  if (error) return false;
  return std::any_of(found.begin(), found.end(), [&io](const auto& entry) {
    boost::system::error_code failure;
    udp::socket socket(io);
    socket.connect(entry.endpoint(), failure);
    if (failure) return false;
    const udp::endpoint own = socket.local_endpoint(failure);
    return !failure && own.address() == entry.endpoint().address();
  });
}

Status allow_open_files(std::uint64_t count) {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur >= count) return Done{};
  if (limit.rlim_max < count)
    return Error{
        ErrorCode::kTooLarge,
        fmt::format("this needs {} open files, and the system allows this process {} (ulimit -n)",
                    count, limit.rlim_max)};
  limit.rlim_cur = count;
  if (setrlimit(RLIMIT_NOFILE, &limit) != 0)
    return Error{ErrorCode::kIo, "the limit of open files cannot be raised"};
  return Done{};
}

}  // namespace hermite::client
