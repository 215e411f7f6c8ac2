// Marks the pixels of a workgroup's tile that become new surfels, with one bit each.
const uint kNewWords = 8u;
shared uint new_bits[kNewWords];

// Called by all threads; afterwards the bits of all are known.
void share_new(bool is_new) {
  uint lane = gl_LocalInvocationID.x;
  if (lane < kNewWords) new_bits[lane] = 0u;
  barrier();
  if (is_new) atomicOr(new_bits[lane / 32u], 1u << (lane % 32u));
  barrier();
}

// Counts new pixels in the whole words before, and in the lane's own word.
uint new_before(uint lane) {
  uint count = bitCount(new_bits[lane / 32u] & ((1u << (lane % 32u)) - 1u));
  for (uint word = 0u; word < lane / 32u; ++word) count += bitCount(new_bits[word]);
  return count;
}
uint new_in_tile() {
  uint count = 0u;
  for (uint word = 0u; word < kNewWords; ++word) count += bitCount(new_bits[word]);
  return count;
}
