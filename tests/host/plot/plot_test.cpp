// Charts: where values stand on axes, and what is in the pictures.
#include <gtest/gtest.h>
#include <png.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "host/error.h"
#include "host/io/png_file.h"
#include "host/plot/axis_scale.h"
#include "host/plot/draw.h"
#include "host/solve/solve_charts.h"
#include "tests/host/io/output_fixtures.h"

namespace scree::test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::vector<std::string> labels(const AxisScale& scale) {
  std::vector<std::string> result;
  for (const AxisScale::Tick& tick : scale.ticks()) result.push_back(tick.label);
  return result;
}

TEST(AxisScale, DecadesAreEquallyFarApart) {
  const AxisScale scale({"x", true}, {1e-2, 1e-4, 1});
  EXPECT_DOUBLE_EQ(scale.place(1e-4), 0);
  EXPECT_DOUBLE_EQ(scale.place(1e-2), 0.5);
  EXPECT_DOUBLE_EQ(scale.place(1), 1);
  EXPECT_EQ(labels(scale), (std::vector<std::string>{"1e-4", "1e-3", "1e-2", "1e-1", "1"}));
}

TEST(AxisScale, ZerosOfALogarithmicAxisStandBelowAllOthers) {
  const AxisScale scale({"x", true}, {0, 1, 1000, -5});
  EXPECT_EQ(scale.place(0), 0);
  EXPECT_EQ(scale.place(-5), 0);
  EXPECT_GT(scale.place(1), 0.05);
  EXPECT_DOUBLE_EQ(scale.place(1000), 1);
  EXPECT_EQ(labels(scale), (std::vector<std::string>{"0", "1", "10", "100", "1000"}));
}

TEST(AxisScale, OnlyZerosHaveADecadeNevertheless) {
  const AxisScale scale({"x", true}, {0, 0});
  EXPECT_EQ(scale.place(0), 0);
  EXPECT_EQ(labels(scale), (std::vector<std::string>{"0", "1", "10"}));
}

TEST(AxisScale, ManyDecadesHaveFewLabels) {
  const AxisScale scale({"x", true}, {1e-30, 1e10});
  const std::vector<std::string> all = labels(scale);
  EXPECT_EQ(all.size(), 41u);
  EXPECT_EQ(std::count_if(all.begin(), all.end(), [](const auto& s) { return !s.empty(); }), 9);
}

TEST(AxisScale, LinearTicksAreRound) {
  const AxisScale scale({"x", false}, {0, 0.31, 1});
  EXPECT_EQ(labels(scale), (std::vector<std::string>{"0", "0.2", "0.4", "0.6", "0.8", "1"}));
  EXPECT_DOUBLE_EQ(scale.place(0.31), 0.31);
  const AxisScale negative({"x", false}, {-3, 4});
  EXPECT_EQ(labels(negative),
            (std::vector<std::string>{"-3", "-2", "-1", "0", "1", "2", "3", "4"}));
}

TEST(AxisScale, OneValueOfALinearAxisStandsAgainstZero) {
  EXPECT_EQ(labels(AxisScale({"x", false}, {1, 1})),
            (std::vector<std::string>{"0", "0.2", "0.4", "0.6", "0.8", "1"}));
  const AxisScale negative({"x", false}, {-2});
  EXPECT_EQ(negative.place(-2), 0);
  EXPECT_EQ(negative.place(0), 1);
  EXPECT_EQ(labels(AxisScale({"x", false}, {0})).back(), "1");
}

TEST(AxisScale, ValuesThatAreNotFiniteAreSkipped) {
  const AxisScale scale({"x", false}, {kNan, 1, kInfinity, 2, -kInfinity});
  EXPECT_EQ(scale.place(1), 0);
  EXPECT_EQ(scale.place(2), 1);
}

TEST(AxisScale, LargerValuesThanTheMostStandAtItsEnd) {
  const AxisScale scale({"x", true, 100}, {1e-2, 1e50});
  EXPECT_EQ(scale.place(1e50), 1);
  EXPECT_EQ(scale.place(100), 1);
  EXPECT_DOUBLE_EQ(scale.place(1), 0.5);
}

TEST(AxisScale, EqualAndNoValuesHaveARange) {
  for (const bool is_log : {true, false}) {
    for (const std::vector<double>& values :
         {std::vector<double>{}, {5, 5}, {1e-300}, {kNan}, {1e300, 1e300}}) {
      const AxisScale scale({"x", is_log}, values);
      EXPECT_GE(scale.ticks().size(), 2u);
      EXPECT_LE(scale.ticks().size(), 12u);
      for (const double value : values) {
        if (!std::isfinite(value)) continue;
        EXPECT_GE(scale.place(value), 0);
        EXPECT_LE(scale.place(value), 1);
      }
    }
  }
}

TEST(LineStyles, OfThirtyNamesDiffer) {
  std::set<std::vector<double>> looks;
  for (int k = 0; k < 30; ++k) {
    const LineStyle style = line_style(k);
    std::vector<double> look{style.red, style.green, style.blue};
    look.insert(look.end(), style.dashes.begin(), style.dashes.end());
    looks.insert(look);
  }
  EXPECT_EQ(looks.size(), 30u);
}

TEST(FigureNames, AreThoseOfAllChartsOnce) {
  Figure figure;
  figure.charts = {{{"x"}, {"y"}, {{"b", {}, {}}, {"a", {}, {}}}},
                   {{"x"}, {"y"}, {{"a", {}, {}}, {"c", {}, {}}}}};
  EXPECT_EQ(figure.names(), (std::vector<std::string>{"b", "a", "c"}));
}

struct Pixel {
  int x, y;
};

/// Pixels which the k-th line covers by half or more, within the columns [from, to) of a picture:
/// its color, or a mixture of that with the white of the paper.
std::vector<Pixel> pixels_of_line(const Image& image, int k, int from, int to) {
  const LineStyle style = line_style(k);
  const double color[3] = {style.red, style.green, style.blue};
  std::vector<Pixel> found;
  for (int y = 0; y < image.height; ++y) {
    for (int x = from; x < to; ++x) {
      const std::uint8_t* rgb = &image.rgb[3 * static_cast<std::size_t>(y * image.width + x)];
      double along = 0, square = 0;
      for (int c = 0; c < 3; ++c) {
        along += (1 - rgb[c] / 255.0) * (1 - color[c]);
        square += (1 - color[c]) * (1 - color[c]);
      }
      const double share = along / square;
      double off = 0;
      for (int c = 0; c < 3; ++c)
        off = std::max(off, std::abs(1 - rgb[c] / 255.0 - share * (1 - color[c])));
      if (share >= 0.5 && off <= 0.02) found.push_back({x, y});
    }
  }
  return found;
}

constexpr int kChartWidth = 500;  // of one chart, the legend is beyond

Image read_png(const std::filesystem::path& path) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  EXPECT_NE(png_image_begin_read_from_file(&png, path.c_str()), 0) << png.message;
  png.format = PNG_FORMAT_RGB;
  Image image{static_cast<int>(png.width), static_cast<int>(png.height), {}};
  image.rgb.resize(PNG_IMAGE_SIZE(png));
  EXPECT_NE(png_image_finish_read(&png, nullptr, image.rgb.data(), 0, nullptr), 0);
  return image;
}

class Drawing : public testing::Test {
 protected:
  void SetUp() override {
    if (!can_draw()) GTEST_SKIP() << "built without Cairo";
  }
};

TEST_F(Drawing, LinesAreWhereTheirPointsAre) {
  // Three level lines at known heights of a logarithmic axis, and one that falls.
  Chart chart{{"x", false}, {"y"}, {}};
  chart.lines = {{"top", {0, 1}, {1, 1}},
                 {"middle", {0, 1}, {1e-2, 1e-2}},
                 {"bottom", {0, 1}, {1e-4, 1e-4}},
                 {"falling", {0, 1}, {1, 1e-4}}};
  const ScratchDirectory folder;
  write_png(folder.path() / "a.png", draw({"Lines", 1, {chart}}));
  const Image image = read_png(folder.path() / "a.png");
  ASSERT_GT(image.width, kChartWidth);
  double mean[4], spread[4], left[4], right[4];
  for (int k = 0; k < 4; ++k) {
    const std::vector<Pixel> pixels = pixels_of_line(image, k, 0, kChartWidth);
    ASSERT_GT(pixels.size(), 100u) << k;
    double sum = 0;
    const auto [low, high] = std::minmax_element(
        pixels.begin(), pixels.end(), [](const Pixel& a, const Pixel& b) { return a.y < b.y; });
    const auto [first, last] = std::minmax_element(
        pixels.begin(), pixels.end(), [](const Pixel& a, const Pixel& b) { return a.x < b.x; });
    for (const Pixel& p : pixels) sum += p.y;
    mean[k] = sum / static_cast<double>(pixels.size());
    spread[k] = high->y - low->y;
    left[k] = first->x;
    right[k] = last->x;
    EXPECT_GT(pixels_of_line(image, k, kChartWidth, image.width).size(), 15u) << "legend " << k;
  }
  EXPECT_NEAR(mean[1], (mean[0] + mean[2]) / 2, 2);  // one hundredth: half of the way
  EXPECT_GT(mean[2] - mean[0], 250);
  for (int k = 0; k < 3; ++k) EXPECT_LE(spread[k], 8) << k;  // the dot at the end
  EXPECT_NEAR(spread[3], mean[2] - mean[0], 10);
  EXPECT_NEAR(mean[3], mean[1], 10);
  for (int k = 0; k < 4; ++k) EXPECT_GT(right[k] - left[k], 350) << k;
}

TEST_F(Drawing, ZerosOfALogarithmicAxisAreDrawn) {
  Chart chart{{"x"}, {"y"}, {{"a", {0, 1, 10}, {1, 0, 0}}, {"b", {0, 1, 10}, {1, 1, 1}}}};
  const Image image = draw({"Zeros", 1, {chart}});
  const std::vector<Pixel> zero = pixels_of_line(image, 0, 0, kChartWidth);
  const std::vector<Pixel> one = pixels_of_line(image, 1, 0, kChartWidth);
  ASSERT_FALSE(zero.empty());
  ASSERT_FALSE(one.empty());
  EXPECT_GT(zero.back().y, one.back().y + 10);
}

TEST_F(Drawing, PointsThatAreNotFiniteLeaveABreak) {
  std::vector<double> x, y;
  for (int k = 0; k <= 100; ++k) {
    x.push_back(k);
    y.push_back(k > 30 && k < 70 ? kNan : 1.0);
  }
  const Image image = draw({"Break", 1, {{{"x", false}, {"y", false}, {{"a", x, y}}}}});
  std::vector<bool> has_pixel(kChartWidth);
  for (const Pixel& p : pixels_of_line(image, 0, 0, kChartWidth)) has_pixel[p.x] = true;
  const auto first = std::find(has_pixel.begin(), has_pixel.end(), true) - has_pixel.begin();
  const auto last = has_pixel.rend() - std::find(has_pixel.rbegin(), has_pixel.rend(), true);
  const auto missing = std::count(has_pixel.begin() + first, has_pixel.begin() + last, false);
  EXPECT_NEAR(static_cast<double>(missing) / static_cast<double>(last - first), 0.4, 0.03);
}

TEST_F(Drawing, NoDataGivesAPicture) {
  const std::vector<Figure> figures{
      {"Nothing", 1, {}},
      {"No lines", 1, {{{"x"}, {"y"}, {}}}},
      {"No points", 1, {{{"x"}, {"y"}, {{"a", {}, {}}}}}},
      {"No numbers", 2, {{{"x"}, {"y"}, {{"a", {kNan, 1}, {1, kInfinity}}}}}},
  };
  for (const Figure& figure : figures) {
    const Image image = draw(figure);
    EXPECT_GE(image.width, kChartWidth) << figure.title;
    EXPECT_TRUE(pixels_of_line(image, 0, 0, kChartWidth).empty()) << figure.title;
    EXPECT_TRUE(std::any_of(image.rgb.begin(), image.rgb.end(), [](auto v) { return v < 100; }))
        << figure.title << " has no text";
  }
}

TEST(DrawingWithoutCairo, IsRefused) {
  if (can_draw()) GTEST_SKIP() << "built with Cairo";
  EXPECT_THROW(draw(Figure{}), RunError);
  const ScratchDirectory folder;
  const std::string note = write_profile_charts(folder.path(), {ProblemReport{}});
  EXPECT_NE(note.find("without Cairo"), std::string::npos);
  EXPECT_NE(note.find((folder.path() / "curves").string()), std::string::npos);
}

SolverRun run_of(const std::string& solver, double velocity_error) {
  SolverRun run;
  run.solver = solver;
  for (int k = 0; k < 3; ++k) {
    AssembledCurvePoint point;
    point.iteration = 10 * k;
    point.applications = 20 * k;
    point.seconds = 0.5 * k;
    point.residual.relative = std::pow(10.0, -k);
    point.velocity_error = velocity_error;
    point.state_changes = 3 - k;
    run.curve.push_back(point);
  }
  return run;
}

TEST(SolveCharts, ShowWhatWasMeasured) {
  ProblemReport report;
  report.name = "pile";
  report.contact_count = 7;
  report.runs = {run_of("jacobi", -1), run_of("newton", -1)};
  const Figure figure = curves_figure(report);
  EXPECT_EQ(figure.title, "pile: 7 contacts");
  EXPECT_EQ(figure.names(), (std::vector<std::string>{"jacobi", "newton"}));
  ASSERT_EQ(figure.charts.size(), 6u);
  EXPECT_EQ(figure.charts[0].lines[0].x, (std::vector<double>{0, 10, 20}));
  EXPECT_EQ(figure.charts[1].lines[0].x, (std::vector<double>{0, 20, 40}));
  EXPECT_EQ(figure.charts[2].lines[1].x, (std::vector<double>{0, 0.5, 1}));
  EXPECT_EQ(figure.charts[0].lines[1].y, (std::vector<double>{1, 0.1, 0.01}));
  EXPECT_EQ(figure.charts[3].lines[0].y, (std::vector<double>{3, 2, 1}));
  report.runs = {run_of("jacobi", 0.25)};
  const Figure with_reference = curves_figure(report);
  ASSERT_EQ(with_reference.charts.size(), 9u);
  EXPECT_EQ(with_reference.charts[4].lines[0].y, (std::vector<double>{0.25, 0.25, 0.25}));
}

/// Distances from the least objective that a solver of the cone has converged to,
/// in charts and CSV.
TEST(SolveCharts, ShowTheObjectiveGapWhereItIsKnown) {
  const auto run = [](const std::string& solver, AssembledStatus status, double end) {
    SolverRun r = run_of(solver, -1);
    for (int k = 0; k < 3; ++k) r.curve[k].residual.objective = end + 2 - k;
    r.result.residual.objective = end;
    r.result.residual.relative = 1e-8;
    r.result.status = status;
    return r;
  };
  ProblemReport report;
  report.runs = {run("jacobi", AssembledStatus::iteration_limit, -9),
                 run("newton", AssembledStatus::stalled, -8)};
  EXPECT_FALSE(std::isfinite(least_objective(report)));
  EXPECT_EQ(curves_figure(report).charts.size(), 6u);
  report.runs.push_back(run("apgd", AssembledStatus::converged, -4));
  report.runs.push_back(run("pgs_pyramid4", AssembledStatus::converged, -7));
  report.runs.back().friction = "4-sided pyramid";
  EXPECT_EQ(least_objective(report), -4);
  const Figure figure = curves_figure(report);
  ASSERT_EQ(figure.charts.size(), 9u);
  EXPECT_NE(figure.charts[3].y.label.find("objective"), std::string::npos);
  EXPECT_EQ(figure.charts[3].lines[2].y, (std::vector<double>{2, 1, 0}));
  EXPECT_EQ(figure.charts[3].lines[0].y, (std::vector<double>{3, 4, 5}));
  EXPECT_EQ(figure.charts[4].lines[2].x, (std::vector<double>{0, 20, 40}));
  // A reference counts where it is as accurate as they are.
  report.reference = run("interior_point", AssembledStatus::stalled, -5);
  report.reference->result.residual.relative = 1e-6;
  EXPECT_EQ(least_objective(report), -4);
  report.reference->result.residual.relative = 1e-12;
  EXPECT_EQ(least_objective(report), -5);
  EXPECT_EQ(curves_figure(report).charts[3].lines[2].y, (std::vector<double>{3, 2, 1}));
}

TEST(SolveCharts, ProfilesAreSteps) {
  const PerformanceProfile profile{{"a", "b"}, {1, 4}, {{0.5, 0.5}, {1, 0.5}}};
  const Figure figure = profile_figure(profile, "seconds");
  ASSERT_EQ(figure.charts.size(), 1u);
  EXPECT_EQ(figure.charts[0].x.label, "seconds over seconds of the best solver");
  EXPECT_EQ(figure.charts[0].lines[0].x, (std::vector<double>{1, 4, 4, 10}));
  EXPECT_EQ(figure.charts[0].lines[0].y, (std::vector<double>{0.5, 0.5, 1, 1}));
  // A solver alone is the best one everywhere.
  const Figure alone = profile_figure({{"a"}, {1}, {{0.5}}}, "seconds");
  EXPECT_EQ(alone.charts[0].lines[0].x, (std::vector<double>{1, 10}));
  EXPECT_EQ(alone.charts[0].lines[0].y, (std::vector<double>{0.5, 0.5}));
}

}  // namespace
}  // namespace scree::test
