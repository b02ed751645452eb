#include "collision/broad.h"
#include "kernels/math/vec3.h"
#include "kernels/narrow_phase/pairs/manifold.h"
