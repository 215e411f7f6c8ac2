#include "core/base/step_back.h"

#include <unistd.h>

namespace hermite {

// Linux has priorities per thread, unlike POSIX. Each of the ten steps is a factor of 1.25.
void step_back() { [[maybe_unused]] const int refused = nice(10); }

}  // namespace hermite
