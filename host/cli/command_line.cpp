#include "host/cli/command_line.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <vector>

#include "host/cli/bench_command.h"
#include "host/cli/check_command.h"
#include "host/cli/convert_command.h"
#include "host/cli/info_command.h"
#include "host/cli/run_command.h"
#include "host/cli/solve_command.h"
#include "host/cli/start_together.h"
#include "host/io/printable.h"
#include "host/io/streams.h"
#include "host/ranks/launch.h"
#include "host/version.h"

namespace scree {
namespace {

constexpr int kMostDevices = 1024;

CLI::App* add_run_command(CLI::App& app, RunOptions& options) {
  CLI::App* command = app.add_subcommand("run", "Simulate a scene");
  add_target_options(*command, options.target);
  add_transport_option(*command, options.target);
  command->add_option("--steps", options.steps, "time steps (default: the scene's duration)")
      ->check(CLI::Range(std::int64_t{0}, std::int64_t{1'000'000'000'000}))
      ->take_last();
  command
      ->add_option("--dump-problem", options.dump_problem,
                   "write the contact problem of step N, rows of joints included; repeatable")
      ->type_name("N")
      ->check(CLI::Range(std::int64_t{1}, std::int64_t{1'000'000'000'000}))
      ->take_all()
      ->expected(1);
  command->add_option("--out", options.out, "output directory (default: out/<scene name>)")
      ->take_last();
  command->add_flag("--resume", options.resume,
                    "continue from the checkpoint in the output directory");
  command->add_flag("--force", options.force, "replace the results in the output directory");
  command->add_flag("--quiet", options.quiet, "no progress line and no summary; warnings stay");
  command->add_flag(
      "--require-convergence", options.require_convergence,
      "exit with 1 when steps ended at the iteration cap, or joints were off in any step; "
      "results are kept");
  return command;
}

CLI::App* add_check_command(CLI::App& app, CheckOptions& options) {
  CLI::App* command =
      app.add_subcommand("check", "Validate a scene; print bodies, memory and time step");
  add_target_options(*command, options.target);
  command->add_flag("--json", options.target.json, "print JSON");
  return command;
}

CLI::App* add_solve_command(CLI::App& app, SolveOptions& options) {
  CLI::App* command = app.add_subcommand("solve", "Solve stored contact problems; compare solvers");
  command
      ->add_option("problem", options.problem, "problem file, or folder of *.hdf5 and *.h5 files")
      ->required();
  command
      ->add_option("--solver", options.solver,
                   "name, names separated by commas, or all (default: auto)")
      ->take_last();
  command->add_option("--model", options.model, "convex or exact (default: exact)")->take_last();
  command
      ->add_option("--tolerance", options.tolerance,
                   "on the error |r - P(r - v)| / |q|, or the measure (default: 1e-8)")
      ->take_last();
  command
      ->add_option("--measure", options.measure,
                   "that the tolerance is on: relative, absolute or unit-free (default: relative)")
      ->take_last();
  command
      ->add_option("--max-iterations", options.max_iterations,
                   "most iterations (default: each solver's own)")
      ->take_last();
  command
      ->add_option("--max-seconds", options.max_seconds,
                   "most seconds per solver and problem, 0: no limit (default: 100)")
      ->take_last();
  command
      ->add_option("--check-every", options.check_every,
                   "iterations between checks of the residual (default: each solver's own)")
      ->take_last();
  command
      ->add_option("--relaxation", options.relaxation,
                   "of sor, jacobi, admm and pgs_... (default: their own)")
      ->take_last();
  command->add_flag("--matrix-free", options.matrix_free,
                    "solvers of simulation steps, for problems with bodies and no joints");
  add_device_options(*command, options.target, "cpu; auto with --matrix-free", "double",
                     "1; all with --matrix-free");
  command
      ->add_option("--reference", options.reference,
                   "what velocity errors are measured against: a solver, a solution file, or a "
                   "folder of them (default: the solution in the problem's file)")
      ->take_last();
  command
      ->add_option("--solution", options.solution,
                   "file for impulses and velocities of the best solver; a folder for those of "
                   "several problems (default: none written)")
      ->take_last();
  command->add_flag("--warm-start", options.warm_start, "start from the guess in the file, if any");
  command
      ->add_option("--out", options.out,
                   "folder for CSV, JSON and PNG files (default: none written)")
      ->take_last();
  command->add_flag("--force", options.force, "write into a folder that is not empty");
  command->add_flag("--json", options.json, "print JSON");
  return command;
}

CLI::App* add_convert_command(CLI::App& app, ConvertOptions& options) {
  CLI::App* command = app.add_subcommand("convert",
                                         "Write a stored contact problem as FCLIB file, or a run "
                                         "of a scene of rigid-ipc as its sim.json");
  command
      ->add_option("problem", options.problem,
                   "problem file, scree's or FCLIB's; or the folder of a run")
      ->required();
  command->add_option("out", options.out, "file to write")->required();
  command
      ->add_option("--kind", options.kind,
                   "local (W, q, mu; bilateral rows: V, R, s) or global (M, H, f, w, mu; G, b) "
                   "(default: local)")
      ->take_last();
  command
      ->add_option("--storage", options.storage,
                   "of matrices: rows, columns or triplets (default: rows if local, triplets if "
                   "global)")
      ->take_last();
  command->add_flag("--force", options.force, "replace a file that is there");
  return command;
}

CLI::App* add_info_command(CLI::App& app, InfoOptions& options) {
  CLI::App* command = app.add_subcommand("info", "Devices, build options, versions");
  CLI::Option* json = command->add_flag("--json", options.json, "print JSON");
  command
      ->add_flag(
          "--schema", options.schema,
          "print the JSON schema of scene files, with all solvers and models of this program")
      ->excludes(json);
  return command;
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

CLI::Validator memory_limits() {
  return {[](std::string& text) -> std::string {
            double value = 0;
            const bool is_number = CLI::detail::lexical_cast(text, value);
            if (is_number && value > 0 && value <= 1e9) return {};
            return text + " is not allowed: must be above 0 and up to 1e+09 [MiB]";
          },
          "", "memory limits"};
}

}  // namespace

void add_device_options(CLI::App& command, RunTarget& target, const std::string& backend,
                        const std::string& precision, const std::string& threads) {
  command.add_option("--backend", target.backend, "cuda, cpu or auto (default: " + backend + ")")
      ->take_last();
  command
      .add_option("--device", target.device,
                  "number of the CUDA device, see scree info (default: 0)")
      ->type_name("N")
      ->check(CLI::Range(0, kMostDevices - 1))
      ->take_last();
  command
      .add_option("--precision", target.precision, "float or double (default: " + precision + ")")
      ->take_last();
  command.add_option("--threads", target.threads, "CPU threads (default: " + threads + ")")
      ->check(CLI::Range(0, 4096))
      ->take_last();
}

void add_backend_options(CLI::App& command, RunTarget& target, const std::string& backend,
                         const std::string& precision) {
  add_device_options(command, target, backend, precision);
  command
      .add_option("--memory", target.memory,
                  "refuse what is expected to take more [MiB] (default: what is free)")
      ->type_name("MIB")
      ->check(memory_limits())
      ->take_last();
  command
      .add_option("--set", target.overrides,
                  "key.path=value, replaces a value of the scene; repeatable")
      ->type_name("KEY=VALUE")
      ->take_all()
      ->expected(1);
}

void add_transport_option(CLI::App& command, RunTarget& target) {
  command
      .add_option("--transport", target.transport,
                  "between the GPUs of ranks: peer, nccl, hosts, or auto, the first of these that "
                  "works (default: auto)")
      ->take_last();
}

void add_target_options(CLI::App& command, RunTarget& target) {
  command.add_option("scene", target.scene, "scene file, or name of a scene in the scenes folder")
      ->required();
  add_backend_options(command, target, "what the scene says", "what the scene says");
}

int fail(const std::string& what, int code) {
  constexpr std::size_t kMaxPrinted = 4000;  // a key or a name in a message may be of any length
  scree::say("scree: " + scree::printable(what, kMaxPrinted));
  return code;
}

int run_command_line(int argc, char** argv) {
  CLI::App app("scree: rigid bodies in frictional contact, by the million");
  app.set_version_flag("--version", fmt::format("scree {} ({})", version(), commit()));
  app.require_subcommand(1);

  RunOptions run;
  run.command_line.assign(argv, argv + argc);
  CheckOptions check;
  BenchOptions bench;
  SolveOptions solve;
  ConvertOptions conversion;
  InfoOptions info;
  const CLI::App* run_command = add_run_command(app, run);
  const CLI::App* check_command = add_check_command(app, check);
  const CLI::App* bench_command = add_bench_command(app, bench);
  const CLI::App* solve_command = add_solve_command(app, solve);
  const CLI::App* convert_command = add_convert_command(app, conversion);
  const CLI::App* info_command = add_info_command(app, info);

  const bool speaks = launch_of_environment().rank == 0;
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() != 0) return fail_together(usage_fault(app, error, argc, argv));
    return speaks ? app.exit(error) : 0;  // --help, --version
  }
  // Several processes of one launch make one run, or one benchmark of ranks; what other commands do, one does.
  const bool is_shared = *run_command || bench_command->got_subcommand("scaling");
  if (!speaks && !is_shared) return 0;
  if (*run_command) return run_scene(run);
  if (*check_command) return check_scene(check);
  if (*bench_command) return run_bench(*bench_command, bench);
  if (*solve_command) return solve_problems(solve);
  if (*convert_command) return convert(conversion);
  if (*info_command) return print_info(info);
  return 0;
}

}  // namespace scree
