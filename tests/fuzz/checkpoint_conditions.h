// What the head of a checkpoint has to say here: the real conditions name the program, which is
// another one for seeds and target.
#pragma once

#include "core/pipeline/checkpoint.h"

namespace hermite::fuzz {

inline const pipeline::Conditions kConditions{
    {"device", "llvmpipe"}, {"program", "0123456789abcdef"}, {"map.stable_confidence", "10"}};

}  // namespace hermite::fuzz
