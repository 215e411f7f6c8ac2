// Counts of the back end, and the name of each in reports.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace hermite::adjust {

struct MappingCounts {
  // Present numbers:
  std::int64_t submaps = 0, keyframes = 0, landmarks = 0;
  std::int64_t components = 0;  // of submaps whose poses are known relative to each other
  // Since the first frame:
  std::int64_t local_adjustments = 0, global_adjustments = 0, failed_adjustments = 0;
  std::int64_t loops_by_appearance = 0, loops_by_nearness = 0;  // closed loops
  std::int64_t joined_components = 0;
  std::int64_t relocalisations = 0;
  // Rejected candidates and loops: beyond the possible drift, like more than one place, never
  // verified again, contradicting other links.
  std::int64_t impossible_places = 0, ambiguous_places = 0, impossible_loops = 0,
               unrepeated_loops = 0, contradicting_loops = 0;

  std::int64_t loops() const { return loops_by_appearance + loops_by_nearness; }
  bool operator==(const MappingCounts&) const = default;
};

struct MappingCountName {
  std::string_view name;
  std::int64_t MappingCounts::*count;
};

inline constexpr std::array kMappingCountNames{
    MappingCountName{"submaps", &MappingCounts::submaps},
    MappingCountName{"parts", &MappingCounts::components},
    MappingCountName{"keyframes", &MappingCounts::keyframes},
    MappingCountName{"landmarks", &MappingCounts::landmarks},
    MappingCountName{"local adjustments", &MappingCounts::local_adjustments},
    MappingCountName{"global adjustments", &MappingCounts::global_adjustments},
    MappingCountName{"failed adjustments", &MappingCounts::failed_adjustments},
    MappingCountName{"loops by appearance", &MappingCounts::loops_by_appearance},
    MappingCountName{"loops by nearness", &MappingCounts::loops_by_nearness},
    MappingCountName{"joined parts", &MappingCounts::joined_components},
    MappingCountName{"found again", &MappingCounts::relocalisations},
    MappingCountName{"impossible places", &MappingCounts::impossible_places},
    MappingCountName{"ambiguous places", &MappingCounts::ambiguous_places},
    MappingCountName{"impossible loops", &MappingCounts::impossible_loops},
    MappingCountName{"unrepeated loops", &MappingCounts::unrepeated_loops},
    MappingCountName{"contradicting loops", &MappingCounts::contradicting_loops},
};

}  // namespace hermite::adjust
