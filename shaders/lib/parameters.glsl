// The parameters of a pass, read before anything branches: behind a branch or in a loop, software devices load a push constant lane by
// lane, with some forty instructions a word.
#define PARAMETERS(Type, name)                                 \
  layout(scalar, push_constant) uniform Push { Type pushed; }; \
  Type name = pushed
