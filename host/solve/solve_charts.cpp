#include "host/solve/solve_charts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host/io/png_file.h"
#include "host/plot/draw.h"

namespace scree {
namespace {

using Point = AssembledCurvePoint;

/// What curves show of a point.
template <class Value>
struct Quantity {
  Axis axis;
  Value value;
};

template <class X, class Y>
Chart curve_chart(const ProblemReport& report, const Quantity<X>& x, const Quantity<Y>& y) {
  Chart chart{x.axis, y.axis, {}};
  for (const SolverRun& run : report.runs) {
    Line line{run.solver, {}, {}};
    for (const Point& point : run.curve) {
      line.x.push_back(x.value(point));
      line.y.push_back(y.value(point));
    }
    chart.lines.push_back(std::move(line));
  }
  return chart;
}

template <class Y>
void add_row(Figure& figure, const ProblemReport& report, const Quantity<Y>& y) {
  const auto add = [&](const char* label, auto value) {
    figure.charts.push_back(curve_chart(report, Quantity<decltype(value)>{{label}, value}, y));
  };
  add("iterations", [](const Point& p) { return static_cast<double>(p.iteration); });
  add("applications of W", [](const Point& p) { return static_cast<double>(p.applications); });
  add("seconds", [](const Point& p) { return p.seconds; });
}

bool has_reference(const ProblemReport& report) {
  return std::any_of(report.runs.begin(), report.runs.end(), [](const SolverRun& run) {
    return !run.curve.empty() && run.curve.front().velocity_error >= 0;
  });
}

}  // namespace

Figure curves_figure(const ProblemReport& report) {
  constexpr double diverged = 100;  // beyond it nobody reads a curve
  Figure figure{fmt::format("{}: {} contacts", report.name, report.contact_count), 3, {}};
  const auto row = [&](const Axis& axis, auto value) {
    add_row(figure, report, Quantity<decltype(value)>{axis, value});
  };
  row({"residual |r - P(r - v)| / |q|", true, diverged},
      [](const Point& p) { return p.residual.relative; });
  if (const double least = least_objective(report); std::isfinite(least)) {
    Axis gap{"|objective - least of the converged| [J]"};
    if (std::abs(least) > 0) gap.most = diverged * std::abs(least);
    row(gap, [least](const Point& p) { return std::abs(p.residual.objective - least); });
  }
  if (has_reference(report))
    row({"velocity error |u - u*| / max(|u*|, |q| / 1000)", true, diverged},
        [](const Point& p) { return p.velocity_error; });
  row({"contacts that changed state since the last check"},
      [](const Point& p) { return static_cast<double>(p.state_changes); });
  return figure;
}

Figure profile_figure(const PerformanceProfile& profile, const std::string& cost) {
  Chart chart{{fmt::format("{0} over {0} of the best solver", cost)},
              {"share of problems solved", false},
              {}};
  const double end = std::max(10.0, profile.ratio.back());  // one solver alone never steps
  for (std::size_t s = 0; s < profile.solvers.size(); ++s) {
    Line line{profile.solvers[s], {}, {}};
    for (std::size_t k = 0; k < profile.ratio.size(); ++k) {
      if (k > 0) {
        line.x.push_back(profile.ratio[k]);
        line.y.push_back(profile.share[k - 1][s]);
      }
      line.x.push_back(profile.ratio[k]);
      line.y.push_back(profile.share[k][s]);
    }
    line.x.push_back(end);
    line.y.push_back(profile.share.back()[s]);
    chart.lines.push_back(std::move(line));
  }
  return {"Performance profile", 1, {chart}};
}

void write_curves_chart(const std::filesystem::path& folder, const ProblemReport& report) {
  if (can_draw())
    write_png(folder / ("curves_" + report.name + ".png"), draw(curves_figure(report)));
}

std::string write_profile_charts(const std::filesystem::path& folder,
                                 const std::vector<ProblemReport>& reports) {
  if (!can_draw())
    return fmt::format("built without Cairo, which draws charts: the numbers are in {}",
                       (folder / "curves").string());
  if (reports.size() < 2) return {};
  write_png(folder / "profile_seconds.png",
            draw(profile_figure(seconds_profile(reports), "seconds")));
  write_png(folder / "profile_applications.png",
            draw(profile_figure(applications_profile(reports), "applications")));
  return {};
}

}  // namespace scree
