#pragma once
// Words and numbers on a picture: the time, and what its colors mean.

#include <string>
#include <vector>

#include "host/scene.h"
#include "host/world.h"

namespace scree::render {

/// Values at the ends of the color map, in the unit of what the colors show.
struct ColorRange {
  double low = 0;
  double high = 1;  ///< > low
};

/// Numbers below the bar of a range: multiples of the largest of 1, 2, 5 times a power of ten of which two or more are in it.
std::vector<double> bar_ticks(const ColorRange& range);

/// "t = 0.250 s", with as many digits as tell steps apart.
/// @param time       [s]   @param time_step  [s], > 0
std::string time_text(double time, double time_step);

/// Writes the time into the upper left corner and, where colors show a value (speed or size), a bar
/// of the color map with title, unit and numbers into the lower right one. Pictures with a side of
/// less than 160 pixels are too small for that and stay as they are.
void add_labels(Image& image, ColorBy color_by, const ColorRange& range, double time,
                double time_step);

}  // namespace scree::render
