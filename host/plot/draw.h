#pragma once
// Figures as pictures. Needs Cairo, which is optional: without it can_draw() is false.

#include "host/plot/figure.h"
#include "host/world.h"

namespace scree {

struct LineStyle {
  double red, green, blue;     ///< in [0, 1]
  std::vector<double> dashes;  ///< lengths of strokes and gaps in turn [pixel]; empty: no gaps
};

/// The look of the k-th name of a figure. The first 30 differ.
LineStyle line_style(int k);

/// Whether this build has the library that draws.
bool can_draw();

/// Draws a figure: every chart with grid, labels and its lines, which end in a dot, and a legend at
/// the right. A chart without any point says "no data".
/// @throws RunError when it cannot be drawn, or can_draw() is false
Image draw(const Figure& figure);

}  // namespace scree
