// For threads whose work is wanted later: beside a device that is a processor they would hold up what is waited for now.
#pragma once

namespace hermite {

// The calling thread gets a tenth of the processor time of others that want it, and all that these leave. Without effect where the system
// has no priorities of threads.
void step_back();

}  // namespace hermite
