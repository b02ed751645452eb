#include <cairo.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <utility>

#include "host/error.h"
#include "host/plot/axis_scale.h"
#include "host/plot/draw.h"

namespace scree {
namespace {

// Pixels.
constexpr double kCellWidth = 500, kCellHeight = 360, kTitleHeight = 40;
constexpr double kLeft = 66, kRight = 16, kTop = 12, kBottom = 52;  // margins within a cell
constexpr double kFont = 13, kLegendLine = 19, kSample = 34, kDot = 3;

struct Box {
  double x, y, width, height;
};

class Canvas {
 public:
  Canvas(int width, int height)
      : surface_(cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height),
                 cairo_surface_destroy),
        context_(cairo_create(surface_.get()), cairo_destroy) {
    cairo_select_font_face(context(), "sans-serif", CAIRO_FONT_SLANT_NORMAL,
                           CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(context(), kFont);
    cairo_set_source_rgb(context(), 1, 1, 1);
    cairo_paint(context());
  }

  cairo_t* context() const { return context_.get(); }

  void gray(double level) { cairo_set_source_rgb(context(), level, level, level); }

  double width_of(const std::string& text) const {
    cairo_text_extents_t extents;
    cairo_text_extents(context(), text.c_str(), &extents);
    return extents.x_advance;
  }

  /// @param align  share of the width that lies left of x
  void write(const std::string& text, double x, double y, double align) {
    cairo_move_to(context(), x - align * width_of(text), y);
    cairo_show_text(context(), text.c_str());
  }

  /// The same upward, centered on y.
  void write_upward(const std::string& text, double x, double y) {
    cairo_save(context());
    cairo_translate(context(), x, y);
    cairo_rotate(context(), -std::acos(-1.0) / 2);
    write(text, 0, 0, 0.5);
    cairo_restore(context());
  }

  /// From one point to another, on whole pixels.
  void rule(double x0, double y0, double x1, double y1) {
    cairo_set_line_width(context(), 1);
    cairo_move_to(context(), std::floor(x0) + 0.5, std::floor(y0) + 0.5);
    cairo_line_to(context(), std::floor(x1) + 0.5, std::floor(y1) + 0.5);
    cairo_stroke(context());
  }

  void set(const LineStyle& style) {
    cairo_set_source_rgb(context(), style.red, style.green, style.blue);
    cairo_set_line_width(context(), 1.5);
    cairo_set_line_join(context(), CAIRO_LINE_JOIN_ROUND);
    cairo_set_dash(context(), style.dashes.data(), static_cast<int>(style.dashes.size()), 0);
  }

  void unset_dashes() { cairo_set_dash(context(), nullptr, 0, 0); }

  /// @throws RunError when anything before went wrong
  Image image() const {
    cairo_surface_flush(surface_.get());
    const cairo_status_t status = cairo_status(context());
    if (status != CAIRO_STATUS_SUCCESS)
      throw RunError(fmt::format("cannot draw: {}", cairo_status_to_string(status)));
    Image image;
    image.width = cairo_image_surface_get_width(surface_.get());
    image.height = cairo_image_surface_get_height(surface_.get());
    const unsigned char* row = cairo_image_surface_get_data(surface_.get());
    const int stride = cairo_image_surface_get_stride(surface_.get());
    for (int y = 0; y < image.height; ++y, row += stride) {
      for (int x = 0; x < image.width; ++x) {
        std::uint32_t pixel;  // in the byte order of the machine
        std::memcpy(&pixel, row + 4 * x, sizeof pixel);
        for (const int shift : {16, 8, 0})
          image.rgb.push_back(static_cast<std::uint8_t>(pixel >> shift & 0xff));
      }
    }
    return image;
  }

 private:
  std::unique_ptr<cairo_surface_t, void (*)(cairo_surface_t*)> surface_;
  std::unique_ptr<cairo_t, void (*)(cairo_t*)> context_;
};

/// Scale of the values of all lines along one axis.
AxisScale scale_of(const Axis& axis, const std::vector<Line>& lines,
                   std::vector<double> Line::*values) {
  std::vector<double> all;
  for (const Line& line : lines)
    all.insert(all.end(), (line.*values).begin(), (line.*values).end());
  return {axis, all};
}

/// @return whether the line has a point
bool draw_line(Canvas& canvas, const Box& plot, const Line& line, const AxisScale& x,
               const AxisScale& y, const LineStyle& style) {
  cairo_t* c = canvas.context();
  canvas.set(style);
  bool has_point = false, is_joined = false;
  double last_x = 0, last_y = 0;
  for (std::size_t k = 0; k < std::min(line.x.size(), line.y.size()); ++k) {
    const bool is_finite = std::isfinite(line.x[k]) && std::isfinite(line.y[k]);
    if (is_finite) {
      last_x = plot.x + x.place(line.x[k]) * plot.width;
      last_y = plot.y + (1 - y.place(line.y[k])) * plot.height;
      if (is_joined) {
        cairo_line_to(c, last_x, last_y);
      } else {
        cairo_move_to(c, last_x, last_y);
      }
      has_point = true;
    }
    is_joined = is_finite;
  }
  cairo_stroke(c);
  canvas.unset_dashes();
  if (has_point) {
    cairo_arc(c, last_x, last_y, kDot, 0, 2 * std::acos(-1.0));
    cairo_fill(c);
  }
  return has_point;
}

void draw_axes(Canvas& canvas, const Box& plot, const Chart& chart, const AxisScale& x,
               const AxisScale& y) {
  const double bottom = plot.y + plot.height;
  for (const AxisScale::Tick& tick : x.ticks()) {
    const double at = plot.x + tick.place * plot.width;
    canvas.gray(0.88);
    canvas.rule(at, plot.y, at, bottom);
    canvas.gray(0.2);
    canvas.write(tick.label, at, bottom + 17, 0.5);
  }
  for (const AxisScale::Tick& tick : y.ticks()) {
    const double at = plot.y + (1 - tick.place) * plot.height;
    canvas.gray(0.88);
    canvas.rule(plot.x, at, plot.x + plot.width, at);
    canvas.gray(0.2);
    canvas.write(tick.label, plot.x - 6, at + 4, 1);
  }
  canvas.write(chart.x.label, plot.x + plot.width / 2, bottom + 38, 0.5);
  canvas.write_upward(chart.y.label, plot.x - kLeft + 16, plot.y + plot.height / 2);
}

void draw_frame(Canvas& canvas, const Box& plot) {
  canvas.gray(0.4);
  canvas.rule(plot.x, plot.y, plot.x + plot.width, plot.y);
  canvas.rule(plot.x, plot.y + plot.height, plot.x + plot.width, plot.y + plot.height);
  canvas.rule(plot.x, plot.y, plot.x, plot.y + plot.height);
  canvas.rule(plot.x + plot.width, plot.y, plot.x + plot.width, plot.y + plot.height);
}

void draw_chart(Canvas& canvas, const Box& cell, const Chart& chart,
                const std::vector<std::string>& names) {
  const Box plot{cell.x + kLeft, cell.y + kTop, cell.width - kLeft - kRight,
                 cell.height - kTop - kBottom};
  const AxisScale x = scale_of(chart.x, chart.lines, &Line::x);
  const AxisScale y = scale_of(chart.y, chart.lines, &Line::y);
  draw_axes(canvas, plot, chart, x, y);
  draw_frame(canvas, plot);
  bool is_empty = true;
  for (const Line& line : chart.lines) {
    const auto name = std::find(names.begin(), names.end(), line.name);
    const LineStyle style = line_style(static_cast<int>(name - names.begin()));
    is_empty = !draw_line(canvas, plot, line, x, y, style) && is_empty;
  }
  if (is_empty) {
    canvas.gray(0.4);
    canvas.write("no data", plot.x + plot.width / 2, plot.y + plot.height / 2, 0.5);
  }
}

void draw_legend(Canvas& canvas, double left, double top, const std::vector<std::string>& names) {
  for (std::size_t k = 0; k < names.size(); ++k) {
    const double y = top + kLegendLine * static_cast<double>(k);
    canvas.set(line_style(static_cast<int>(k)));
    cairo_move_to(canvas.context(), left, y);
    cairo_line_to(canvas.context(), left + kSample, y);
    cairo_stroke(canvas.context());
    canvas.unset_dashes();
    canvas.gray(0.2);
    canvas.write(names[k], left + kSample + 7, y + 4, 0);
  }
}

}  // namespace

bool can_draw() { return true; }

Image draw(const Figure& figure) {
  const std::vector<std::string> names = figure.names();
  const int columns = std::max(1, figure.columns);
  const int rows = std::max(1, (static_cast<int>(figure.charts.size()) + columns - 1) / columns);
  double legend_width = 0;
  const Canvas ruler(1, 1);
  for (const std::string& name : names)
    legend_width = std::max(legend_width, kSample + 7 + ruler.width_of(name) + 14);
  const double charts_width = columns * kCellWidth;
  const double height = std::max(rows * kCellHeight, kTop + kLegendLine * (names.size() + 1.0));
  Canvas canvas(static_cast<int>(charts_width + legend_width),
                static_cast<int>(kTitleHeight + height));
  canvas.gray(0.1);
  cairo_set_font_size(canvas.context(), 1.2 * kFont);
  canvas.write(figure.title, charts_width / 2, 27, 0.5);
  cairo_set_font_size(canvas.context(), kFont);
  for (int k = 0; k < static_cast<int>(figure.charts.size()); ++k) {
    const int column = k % columns, row = k / columns;
    draw_chart(canvas,
               {column * kCellWidth, kTitleHeight + row * kCellHeight, kCellWidth, kCellHeight},
               figure.charts[k], names);
  }
  draw_legend(canvas, charts_width, kTitleHeight + kTop + kLegendLine / 2, names);
  return canvas.image();
}

}  // namespace scree
