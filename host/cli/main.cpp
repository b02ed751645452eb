// The program scree. Exit codes: 0 done, 1 a run failed, 2 bad input.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <new>
#include <string>
#include <system_error>
#include <vector>

#include "host/cli/bench_command.h"
#include "host/cli/check_command.h"
#include "host/cli/convert_command.h"
#include "host/cli/info_command.h"
#include "host/cli/run_command.h"
#include "host/cli/solve_command.h"
#include "host/error.h"
#include "host/io/printable.h"
#include "host/io/streams.h"
#include "host/version.h"

namespace {

int fail(const std::string& what, int code) {
  constexpr std::size_t kMaxPrinted = 4000;  // a key or a name in a message may be of any length
  scree::say("scree: " + scree::printable(what, kMaxPrinted));
  return code;
}

/// One line for what is wrong with the command line.
std::string usage_fault(const CLI::App& app, const CLI::ParseError& error, int argc, char** argv) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(command->get_name());
  std::string chosen;
  for (const CLI::App* command = &app; !command->get_subcommands().empty();) {
    command = command->get_subcommands().front();
    chosen += command->get_name() + " ";
  }
  if (!chosen.empty()) return fmt::format("{}; see scree {}--help", error.what(), chosen);
  if (argc > 1) {
    return fmt::format("{}: no such {}; expected a command: {}", argv[1],
                       argv[1][0] == '-' ? "option" : "command", fmt::join(names, ", "));
  }
  return fmt::format("no command given; expected one of {}; see scree --help",
                     fmt::join(names, ", "));
}

}  // namespace

int main(int argc, char** argv) {
  scree::prepare_streams();
  CLI::App app("scree: rigid bodies in frictional contact, by the million");
  app.set_version_flag("--version",
                       fmt::format("scree {} ({})", scree::version(), scree::commit()));
  app.require_subcommand(1);

  scree::RunOptions run;
  run.command_line.assign(argv, argv + argc);
  scree::CheckOptions check;
  scree::BenchOptions bench;
  scree::SolveOptions solve;
  scree::ConvertOptions convert;
  scree::InfoOptions info;
  const CLI::App* run_command = scree::add_run_command(app, run);
  const CLI::App* check_command = scree::add_check_command(app, check);
  const CLI::App* bench_command = scree::add_bench_command(app, bench);
  const CLI::App* solve_command = scree::add_solve_command(app, solve);
  const CLI::App* convert_command = scree::add_convert_command(app, convert);
  const CLI::App* info_command = scree::add_info_command(app, info);

  const auto run_command_line = [&]() -> int {
    try {
      app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
      if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
      return fail(usage_fault(app, error, argc, argv), 2);
    }
    if (*run_command) return scree::run_scene(run);
    if (*check_command) return scree::check_scene(check);
    if (*bench_command) return scree::run_bench(*bench_command, bench);
    if (*solve_command) return scree::solve_problems(solve);
    if (*convert_command) return scree::convert_problem(convert);
    if (*info_command) return scree::print_info(info);
    return 0;
  };
  try {
    const int code = run_command_line();
    scree::finish_output();
    return code;
  } catch (const scree::InputError& error) {
    return fail(error.what(), 2);
  } catch (const std::bad_alloc&) {
    return fail("host memory exhausted", 1);
  } catch (const std::system_error& error) {
    // The formatting library reports only a reason when standard output cannot be written.
    if (std::ferror(stdout) == 0) return fail(error.what(), 1);
    return fail("cannot write standard output: " + error.code().message(), 1);
  } catch (const std::exception& error) {
    return fail(error.what(), 1);
  }
}
