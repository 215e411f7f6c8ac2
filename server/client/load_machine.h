// What a load test has to know of the machine that it runs on.
#pragma once

#include <cstdint>

#include "core/base/result.h"
#include "server/client/server_url.h"

namespace hermite::client {

double process_cpu_s();  // used by all threads of this process so far
double thread_cpu_s();   // used by the calling thread so far

// Is that address one of this machine, such as the loopback, which may also be the end of a tunnel?
// false if the name cannot be resolved. Sends nothing to the server.
bool is_this_machine(const ServerUrl& server);

// Lets this process have so many open files, within what the system allows it. kTooLarge, naming
// that limit.
Status allow_open_files(std::uint64_t count);

}  // namespace hermite::client
