// Sums over all pixels without float atomics: every thread adds its own pixels, then each of the first `terms` threads adds one term over
// the workgroup in order; the host adds the workgroups. Needs kTerms and kGroupSize.
shared float group_terms[kTerms * kGroupSize];

void write_group_sums(float sums[kTerms]) {
  for (uint i = 0u; i < kTerms; ++i) group_terms[i * kGroupSize + gl_LocalInvocationID.x] = sums[i];
  barrier();
  uint term = gl_LocalInvocationID.x;
  if (term < kTerms) {
    float sum = 0.0;
    for (uint i = 0u; i < kGroupSize; ++i) sum += group_terms[term * kGroupSize + i];
    partial_sums[gl_WorkGroupID.x * kTerms + term] = sum;
  }
}
