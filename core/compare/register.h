// Finds the rigid transform between two scans of one place without a guess, or says why there is
// none. Pure function.
#pragma once

#include <string>

#include "core/compare/alignment.h"
#include "core/compare/compare_progress.h"

namespace hermite::compare {

enum class RegistrationVerdict : std::uint8_t {
  kSamePlace,
  kDifferentPlaces,  // no pose makes the surfaces agree
  kAmbiguous,        // another pose agrees as well, such as half a turn of a symmetric room
  // The common surfaces do not hold the scans in one direction, such as two parallel walls.
  kSliding,
  kMirrored,   // they agree if one is mirrored
  kTooSparse,  // they agree, at too few places to be aligned
};

struct Registration {
  RegistrationVerdict verdict = RegistrationVerdict::kDifferentPlaces;
  std::string message;        // one sentence or two, for people
  ScanAlignment alignment;    // valid if the verdict is kSamePlace, kAmbiguous or kSliding
  CoarseAgreement agreement;  // of the best pose
};

// Compares the candidates of start_poses.h, each aligned, by the share of what both scans saw and
// by colours. A verdict of kSamePlace needs: at least 75 % of what both saw agrees, or 60 % if the
// colours do, too; at least 15 % of the smaller scan is in the other one, or 60 % if no path of a
// camera tells what was seen; no other pose agrees nearly as well; and the transform is certain to
// 2 cm (one standard deviation, in the middle of the common surface). Deterministic; uses all
// processors for some seconds.
Registration register_scans(const CoarseScan& a, const CoarseScan& b,
                            const CompareProgress& progress = {});

const char* name_of(RegistrationVerdict verdict);  // "same_place", ...

}  // namespace hermite::compare
