#include <array>

#include "host/plot/draw.h"

namespace scree {

LineStyle line_style(int k) {
  constexpr std::array<std::array<double, 3>, 10> colors{{{0.00, 0.45, 0.70},
                                                          {0.84, 0.37, 0.00},
                                                          {0.00, 0.62, 0.45},
                                                          {0.80, 0.18, 0.25},
                                                          {0.49, 0.36, 0.68},
                                                          {0.90, 0.62, 0.00},
                                                          {0.34, 0.71, 0.91},
                                                          {0.85, 0.47, 0.69},
                                                          {0.35, 0.35, 0.35},
                                                          {0.58, 0.62, 0.12}}};
  const std::array<std::vector<double>, 3> dashes{
      {std::vector<double>{}, std::vector<double>{7, 3}, std::vector<double>{2, 3}}};
  const auto index = static_cast<std::size_t>(k);
  const auto& color = colors[index % colors.size()];
  return {color[0], color[1], color[2], dashes[index / colors.size() % dashes.size()]};
}

}  // namespace scree
