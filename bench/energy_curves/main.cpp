// scree_energy_curves [--steps N] [--step H] [--json FILE]: the energy of an elastic ball and rod on a floor by several methods.

#include <charconv>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>

#include "bench/energy_curves/trace.h"
#include "host/version.h"

namespace {

using Json = nlohmann::ordered_json;

struct Options {
  scree::bench::RunLength length;
  std::string json;
};

template <class Number>
bool read_number(const char* text, Number& out) {
  const char* end = text + std::strlen(text);
  const auto [last, error] = std::from_chars(text, end, out);
  return error == std::errc() && last == end && out > 0;
}

bool read_options(int argc, char** argv, Options& out) {
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string key = argv[i];
    const bool is_read = key == "--steps"  ? read_number(argv[i + 1], out.length.steps)
                         : key == "--step" ? read_number(argv[i + 1], out.length.step)
                                           : key == "--json";
    if (key == "--json") out.json = argv[i + 1];
    if (!is_read) {
      std::cerr << key << ' ' << argv[i + 1]
                << ": expected --steps N, --step SECONDS or --json FILE\n";
      return false;
    }
  }
  if (argc % 2 == 0) std::cerr << argv[argc - 1] << ": expected a value behind it\n";
  return argc % 2 == 1;
}

Json to_json(const char* system, const scree::bench::EnergyTrace& trace) {
  return {{"system", system},
          {"method", trace.method()},
          {"largest_energy_change", trace.largest()},
          {"last_energy_change", trace.last()},
          {"impacts", trace.turns()},
          {"largest_turn_error_m", trace.turn_error()},
          {"lowest_gap_m", trace.lowest()},
          {"energy_intervals", trace.energy_intervals()},
          {"place_intervals_m", trace.place_intervals()}};
}

}  // namespace

int main(int argc, char** argv) try {
  Options options;
  if (!read_options(argc, argv, options)) return 2;
  Json results = Json::array();
  for (const auto& trace : scree::bench::ball_traces(options.length))
    results.push_back(to_json("ball", trace));
  for (const auto& trace : scree::bench::rod_traces(options.length))
    results.push_back(to_json("rod", trace));
  const Json document = {{"benchmark", "energy_curves"},  {"version", scree::version()},
                         {"commit", scree::commit()},     {"step_s", options.length.step},
                         {"steps", options.length.steps}, {"results", results}};
  for (const Json& r : results)
    std::printf(
        "%-5s %-20s largest |dE/E| %.2e, at the end %.2e; %d impacts, turned %.1e m off, lowest "
        "gap %.1e m\n",
        r["system"].get<std::string>().c_str(), r["method"].get<std::string>().c_str(),
        r["largest_energy_change"].get<double>(), r["last_energy_change"].get<double>(),
        r["impacts"].get<int>(), r["largest_turn_error_m"].get<double>(),
        r["lowest_gap_m"].get<double>());
  if (options.json.empty()) return 0;
  std::ofstream file(options.json);
  file << document.dump(1) << '\n';
  if (file.flush()) return 0;
  std::cerr << options.json << ": cannot be written\n";
  return 1;
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
