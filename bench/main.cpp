// The program scree_bench. Its own flags are read first, the rest is Google Benchmark's.

#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "bench/options.h"
#include "host/version.h"
#ifdef SCREE_HAS_CUDA
#include "host/engine/cuda_device.h"
#endif

namespace scree::bench {
namespace {

constexpr const char* kUsage =
    "scree_bench [--backend=cpu|cuda] [--sizes=N,N,...] [--batches=N] [--threads=N]\n"
    "            [Google Benchmark flags, for instance --benchmark_filter=REGEX\n"
    "             --benchmark_out=FILE --benchmark_out_format=json]\n";

/// A whole number; 1e6 is one.
Index parse_count(std::string_view flag, const std::string& text, double least, double largest) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0' || !(value >= least && value <= largest) ||
      value != std::floor(value)) {
    throw std::invalid_argument(fmt::format("{} must be a whole number from {} to {}, got '{}'",
                                            flag, least, largest, text));
  }
  return static_cast<Index>(value);
}

std::vector<Index> parse_sizes(const std::string& text) {
  std::vector<Index> sizes;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    sizes.push_back(parse_count("--sizes", text.substr(begin, end - begin), 100, 2e8));
    begin = end + 1;
  }
  return sizes;
}

/// Takes the flags of scree_bench out of the arguments and leaves the others.
Options take_options(std::vector<char*>& arguments) {
  Options options;
  std::vector<char*> others;
  for (char* argument : arguments) {
    const std::string_view text = argument;
    const std::size_t equals = text.find('=');
    const std::string_view flag = text.substr(0, equals);
    const std::string value(equals == text.npos ? "" : text.substr(equals + 1));
    if (flag == "--sizes") {
      options.sizes = parse_sizes(value);
    } else if (flag == "--batches") {
      options.batches = parse_count(flag, value, 1, 1e6);
    } else if (flag == "--threads") {
      options.threads = parse_count(flag, value, 1, 4096);
    } else if (flag == "--backend") {
      if (value != "cpu" && value != "cuda") {
        throw std::invalid_argument("--backend must be cpu or cuda, got '" + value + "'");
      }
      options.cpu = value == "cpu";
      options.cuda = value == "cuda";
    } else {
      others.push_back(argument);
    }
  }
  arguments = others;
  return options;
}

std::shared_ptr<void> register_cuda(const Options& options) {
  std::string reason = "this build has no CUDA";
#ifdef SCREE_HAS_CUDA
  if (cuda_available(&reason)) {
    benchmark::AddCustomContext("cuda_device", cuda_device_info().name);
    return register_benchmarks(BackendTag<Cuda>{}, options);
  }
#endif
  if (!options.cpu) throw std::runtime_error("--backend=cuda: " + reason);
  fmt::print(stderr, "no CUDA benchmarks: {}\n", reason);
  return nullptr;
}

int run(int argc, char** argv) {
  std::vector<char*> arguments(argv, argv + argc);
  const Options options = take_options(arguments);
  std::string tabular = "--benchmark_counters_tabular=true";
  arguments.insert(arguments.begin() + 1, tabular.data());
  int count = static_cast<int>(arguments.size());
  arguments.push_back(nullptr);
  benchmark::Initialize(&count, arguments.data(), [] { fmt::print("{}", kUsage); });
  if (benchmark::ReportUnrecognizedArguments(count, arguments.data())) return 2;

  benchmark::AddCustomContext("command", fmt::format("{}", fmt::join(argv, argv + argc, " ")));
  benchmark::AddCustomContext("scree_version", version());
  benchmark::AddCustomContext("scree_commit", commit());
  std::shared_ptr<void> suites[2];
  if (options.cpu) {
    const int threads = options.threads > 0 ? options.threads : omp_get_max_threads();
    benchmark::AddCustomContext("cpu_threads", std::to_string(threads));
    suites[0] = register_benchmarks(BackendTag<Cpu>{}, options);
  }
  if (options.cuda) suites[1] = register_cuda(options);
  const std::size_t matched = benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return matched > 0 ? 0 : 2;
}

}  // namespace
}  // namespace scree::bench

int main(int argc, char** argv) {
  try {
    return scree::bench::run(argc, argv);
  } catch (const std::invalid_argument& error) {
    fmt::print(stderr, "scree_bench: {}\n{}", error.what(), scree::bench::kUsage);
    return 2;
  } catch (const std::exception& error) {
    fmt::print(stderr, "scree_bench: {}\n", error.what());
    return 1;
  }
}
