#include "core/base/step_back.h"

#include <unistd.h>

namespace hermite {

// Linux has priorities by thread, whatever POSIX says; ten steps of 1.25 each.
void step_back() { [[maybe_unused]] const int refused = nice(10); }

}  // namespace hermite
