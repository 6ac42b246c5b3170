#ifdef ALPHA_MASK
#include "alpha_mask.glsl"
void main() { discard_masked(); }
#else
void main() {}
#endif
