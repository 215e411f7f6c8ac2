// Sums over all pixels without float atomics: every thread adds its own pixels, then each thread
// adds one term over the workgroup in order; the host adds the workgroups. Needs kTerms, kGroupSize
// and partial_sums. The order of the terms is declared in shaders/shared/track.h.
shared float group_terms[kTerms * kGroupSize];
uint next_term;

void put_from(uint term) { next_term = term; }
void put_term(float value) {
  group_terms[next_term * kGroupSize + gl_LocalInvocationID.x] = value;
  next_term += 1u;
}

void put_at(uint term, float value) {
  put_from(term);
  put_term(value);
}

// Writes after the sums of `first_group` workgroups.
void write_group_sums(uint first_group) {
  barrier();
  for (uint term = gl_LocalInvocationID.x; term < kTerms; term += kGroupSize) {
    float sum = 0.0;
    for (uint i = 0u; i < kGroupSize; ++i) sum += group_terms[term * kGroupSize + i];
    partial_sums[(first_group + gl_WorkGroupID.x) * kTerms + term] = sum;
  }
}
