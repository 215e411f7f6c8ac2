// Lowers the priority of threads whose work is needed later: if the device is a processor, they
// would otherwise delay work that is needed now.
#pragma once

namespace hermite {

// The calling thread gets a tenth of the processor time of other busy threads, and all time that
// these leave idle. Has no effect if the system has no priorities per thread.
void step_back();

}  // namespace hermite
