// Built in place of draw_cairo.cpp where Cairo was not found.
#include "host/error.h"
#include "host/plot/draw.h"

namespace scree {

bool can_draw() { return false; }

Image draw(const Figure&) { throw RunError("cannot draw: built without Cairo"); }

}  // namespace scree
