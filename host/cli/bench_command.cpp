#include "host/cli/bench_command.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "host/cli/command_line.h"
#include "host/error.h"
#include "solvers/solver_card.h"

namespace scree {
namespace {

constexpr int kMostSteps = 1'000'000;

/// Options that all benchmarks on beds have.
void add_bed_options(CLI::App& command, BedOptions& options) {
  RunTarget& target = options.target;
  target.backend = "auto";
  target.precision = "float";
  add_backend_options(command, target, "auto", "float");
  command.add_option("--sizes", options.sizes, "numbers of bodies, such as 1e5,1e6")
      ->delimiter(',')
      ->type_name("N,...");
  command.add_option("--layers", options.layers, "height of the bed in layers of spheres")
      ->delimiter(',')
      ->type_name("N");
  command.add_option("--warmup", options.warmup, "steps before measuring (default: until settled)")
      ->check(CLI::Range(0, kMostSteps))
      ->take_last();
  command.add_option("--json", options.json, "write the results to this file")
      ->type_name("FILE")
      ->take_last();
}

void add_steps_options(CLI::App& command, BedOptions& options) {
  command.add_option("--steps", options.steps, "steps measured")
      ->check(CLI::Range(1, kMostSteps))
      ->take_last();
}

void add_sizes_option(CLI::App& command, BedOptions& options) {
  command.add_flag("--polydisperse", options.polydisperse, "diameters from 1 to 10");
}

/// Options: of scenes, those of one or of several.
template <class Options>
void add_measuring_options(CLI::App& command, Options& options) {
  command
      .add_option("--warmup", options.warmup,
                  fmt::format("steps before measuring (default: {})", options.warmup))
      ->check(CLI::Range(0, kMostSteps))
      ->take_last();
  command
      .add_option("--steps", options.steps,
                  fmt::format("steps measured (default: {})", options.steps))
      ->check(CLI::Range(1, kMostSteps))
      ->take_last();
  command
      .add_option("--json", options.json, "print JSON, or write it to FILE (name ends in .json)")
      ->type_name("[FILE]")
      ->expected(0, 1)
      ->default_str("-")
      ->take_last();
}

void add_scene_options(CLI::App& command, SceneBenchOptions& options) {
  add_target_options(command, options.target);
  command.get_option("scene")->required(false);
  add_measuring_options(command, options);
  command.add_option("--from", options.from, "checkpoint of this scene to start from")->take_last();
}

void add_affine_options(CLI::App& command, AffineBenchOptions& options) {
  command.add_option("scenes", options.scenes,
                     "scene files, or names of scenes, of affine bodies (default: all that come "
                     "with the program)");
  add_backend_options(command, options.target, "what the scene says", "double");
  add_measuring_options(command, options);
}

/// The solvers of steps, a line each.
std::string solver_lines() {
  std::string lines = "Solvers:";
  for (const SolverCard& card : solver_cards())
    lines += fmt::format("\n  {:<22}{}", card.name, card.description);
  return lines;
}

/// @throws InputError when a word behind `bench` is neither a benchmark nor a scene
void require_scene(const std::string& word, const CLI::App& command) {
  try {
    find_scene(word);
  } catch (const InputError& error) {
    std::vector<std::string> names;
    for (const CLI::App* mode : command.get_subcommands([](const CLI::App*) { return true; }))
      names.push_back(mode->get_name());
    throw InputError(fmt::format("{}; known benchmarks: {}", error.what(), fmt::join(names, ", ")));
  }
}

}  // namespace

CLI::App* add_bench_command(CLI::App& app, BenchOptions& options) {
  CLI::App* command =
      app.add_subcommand("bench", "Measure speed and memory, on beds of spheres or on a scene");
  command->require_subcommand(0, 1);
  command->footer(
      "scree bench SCENE is short for scree bench scene SCENE. All but scene and affine run on "
      "beds of equal\n"
      "spheres made in memory; scree bench iteration --help lists their options.");
  add_scene_options(*command, options.scene);
  add_scene_options(
      *command->add_subcommand("scene", "whole steps of a scene file, stage by stage"),
      options.scene);

  add_affine_options(
      *command->add_subcommand("affine", "scenes of affine bodies: frames a second, least gaps"),
      options.affine);

  CLI::App* iteration =
      command->add_subcommand("iteration", "solver iterations on a settled bed, against memory");
  add_bed_options(*iteration, options.iteration);
  add_steps_options(*iteration, options.iteration);

  CLI::App* collision =
      command->add_subcommand("collision", "collision detection on a settled bed");
  add_bed_options(*collision, options.collision);
  add_steps_options(*collision, options.collision);
  add_sizes_option(*collision, options.collision);

  CLI::App* step =
      command->add_subcommand("step", "whole steps to quality and to preview, stage by stage");
  add_bed_options(*step, options.step.bed);
  add_steps_options(*step, options.step.bed);
  add_sizes_option(*step, options.step.bed);
  step->add_option("--kind", options.step.kind, "bed (settled) or column (collapsing)")
      ->take_last();

  CLI::App* scaling =
      command->add_subcommand("scaling", "whole steps on one rank and on all of mpirun -n N");
  add_bed_options(*scaling, options.scaling);
  add_steps_options(*scaling, options.scaling);
  add_transport_option(*scaling, options.scaling.target);
  scaling->footer(
      "Sizes are those of one rank. Weak scaling: as many bodies on each of the ranks; strong: as "
      "many on\nall. Efficiency is of the time for an application of the operator.");

  CLI::App* solvers =
      command->add_subcommand("solvers", "time to equal residual, solver by solver");
  solvers->footer(solver_lines());
  add_bed_options(*solvers, options.solvers.bed);
  solvers
      ->add_option("--solvers", options.solvers.solvers,
                   "some of those below (default: all that run there)")
      ->delimiter(',')
      ->type_name("NAME,...");
  solvers->add_option("--levels", options.solvers.levels, "residuals relative to v*")
      ->delimiter(',')
      ->type_name("X,...");
  solvers->add_option("--limit", options.solvers.limit, "longest solve [s]")->take_last();

  CLI::App* capacity =
      command->add_subcommand("capacity", "memory expected and held, and how many bodies fit");
  add_bed_options(*capacity, options.capacity);
  add_steps_options(*capacity, options.capacity);
  add_sizes_option(*capacity, options.capacity);
  return command;
}

int run_bench(const CLI::App& command, const BenchOptions& options) {
  const auto chosen = command.get_subcommands();
  const std::string mode = chosen.empty() ? "" : chosen.front()->get_name();
  if (mode == "iteration") return bench_iteration(options.iteration);
  if (mode == "collision") return bench_collision(options.collision);
  if (mode == "step") return bench_step(options.step);
  if (mode == "scaling") return bench_scaling(options.scaling);
  if (mode == "solvers") return bench_solvers(options.solvers);
  if (mode == "capacity") return bench_capacity(options.capacity);
  if (mode == "affine") return bench_affine(options.affine);
  if (mode.empty()) require_scene(options.scene.target.scene, command);
  return bench_scene(options.scene);
}

}  // namespace scree
