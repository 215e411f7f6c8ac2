// The parameters of a pass, read before any branch: after a branch or in a loop, software devices
// load a push constant lane by lane, with about forty instructions per word.
#define PARAMETERS(Type, name)                                 \
  layout(scalar, push_constant) uniform Push { Type pushed; }; \
  Type name = pushed
