#pragma once
// A small font of strokes for labels on pictures.

#include <string_view>

#include "host/world.h"

namespace scree::render {

/// Letters that draw_text() knows; it leaves others out.
bool has_letter(char letter);

/// Width of a line of text as high as `size` from its base line to the top of its digits [pixels].
double text_width(std::string_view text, double size);

/// Draws text in a dark gray, from x on to the right and with the base line at y, which counts from
/// the top [pixels]. What lies outside of the picture is cut off.
void draw_text(Image& image, std::string_view text, double x, double y, double size);

}  // namespace scree::render
