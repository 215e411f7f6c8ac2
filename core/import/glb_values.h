// The numbers of an accessor of a glTF. Pure.
#pragma once

#include <cstdint>
#include <vector>

#include "core/import/glb_document.h"

namespace hermite {

struct GlbValues {
  int components = 0;          // of each element: 1 to 4
  std::vector<float> numbers;  // one element after the other; normalised integers are 0 to 1 or -1 to 1
  std::size_t count() const { return numbers.size() / static_cast<std::size_t>(components); }
};

// Strides, every component type and normalisation. kCorruptData, naming the field: it leaves its bufferView, other numbers of components
// than these; kTooLarge: more than `most` elements; kUnsupported: sparse, matrices.
Result<GlbValues> read_glb_values(const GlbDocument& document, std::uint64_t accessor, int least_components, int most_components,
                                  std::uint64_t most);

// Whole numbers below `end`. Errors as above.
Result<std::vector<std::uint32_t>> read_glb_indices(const GlbDocument& document, std::uint64_t accessor, std::uint64_t end,
                                                    std::uint64_t most);

// What an accessor says of how many elements it has, for one that has no bytes of its own. Errors as above.
Result<std::uint64_t> glb_element_count(const GlbDocument& document, std::uint64_t accessor, std::uint64_t most);

}  // namespace hermite
