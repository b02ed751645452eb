#include "host/cli/run_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "dynamics/dynamics_card.h"
#include "host/cli/abort_record.h"
#include "host/cli/deepest_overlap.h"
#include "host/cli/joints_apart.h"
#include "host/cli/judged.h"
#include "host/cli/run_files.h"
#include "host/cli/start_together.h"
#include "host/error.h"
#include "host/io/checkpoint.h"
#include "host/io/output_directory.h"
#include "host/io/png_file.h"
#include "host/io/problem_file.h"
#include "host/io/progress.h"
#include "host/io/run_record.h"
#include "host/io/signals.h"
#include "host/io/steps_csv.h"
#include "host/io/streams.h"
#include "host/io/walls.h"
#include "host/io/writer_thread.h"
#include "host/ranks/launch.h"
#include "host/ranks/mpi_ranks.h"
#include "host/scene/body_name.h"
#include "host/scene/overlaps.h"
#include "host/scene/stored_joints.h"
#include "host/scene_reader.h"

namespace scree {
namespace fs = std::filesystem;

namespace {

/// Calls for output at multiples of an interval, whatever the time step is.
class Schedule {
 public:
  /// @param interval  [s]; not positive: never due; below the time step: due every step
  Schedule(double interval, double time_step)
      : interval_(interval > 0 ? std::max(interval, time_step) : 0), slack_(1e-6 * time_step) {}
  bool due(double before, double now) const { return count(now) > count(before); }
  /// How many were due up to a time; a step has one at most, and there are below 2^53 steps.
  std::int64_t count(double time) const {
    return interval_ > 0 ? static_cast<std::int64_t>(std::floor((time + slack_) / interval_)) : 0;
  }

 private:
  double interval_;
  double slack_;
};

ExistingOutput existing_output(const RunOptions& options) {
  if (options.resume) return ExistingOutput::resume;
  return options.force ? ExistingOutput::replace : ExistingOutput::refuse;
}

std::int64_t step_target(const RunOptions& options, const Scene& scene) {
  if (options.steps >= 0) return options.steps;
  return std::llround(scene.stepping.duration / scene.stepping.time_step);
}

/// A run that is asked for and takes no step would end without a word.
void require_a_step(const RunOptions& options, const Scene& scene, const fs::path& file) {
  const SteppingSettings& s = scene.stepping;
  if (s.duration == 0 || step_target(options, scene) > 0 || options.steps == 0) return;
  throw InputError(fmt::format(
      "{}: duration: {} is not allowed: would take no step, must be 0 or at least half of "
      "time_step, {:g} s, without --steps",
      file.string(), s.duration, 0.5 * s.time_step));
}

fs::path output_folder(const RunOptions& options, const Scene& scene) {
  return options.out.empty() ? fs::path("out") / scene.name : options.out;
}

/// What a run reads before it looks at its output directory.
struct RunInput {
  /// @param ranks  that run the scene together, or null
  RunInput(const RunOptions& options, const std::shared_ptr<Ranks>& ranks) {
    if (options.resume && options.force)
      throw InputError("--resume and --force exclude each other");
    if (ranks != nullptr && !options.dump_problem.empty())
      throw InputError("--dump-problem is for a run of one rank");
    file = find_scene(options.target.scene);
    scene = read_scene(file, options.target.overrides, &notes);
    require_a_step(options, scene, file);
    text = scene_text(file, options.target.overrides);
    world = resolve_options(options.target, scene, &notice, ranks);
  }

  fs::path file;
  std::vector<std::string> notes;  ///< of the scene
  Scene scene;
  std::string text;
  std::string notice;  ///< about the backend
  WorldOptions world;
};

/// One run from open files to the last byte.
class Run {
 public:
  Run(const RunOptions& options, RunInput input)
      : options_(options),
        notes_(std::move(input.notes)),
        scene_(std::move(input.scene)),
        scene_text_(std::move(input.text)),
        notice_(std::move(input.notice)),
        world_options_(std::move(input.world)),
        directory_(output_folder(options, scene_), existing_output(options), scene_text_,
                   {"/duration", "/max_time", "/max_iterations", "/output"}),
        target_(step_target(options, scene_)),
        card_(dynamics_card(scene_.dynamics.type)),
        record_(card_) {
    record_.scene_file = input.file.string();
  }

  int go() {
    std::optional<Checkpoint> checkpoint = directory_.take_checkpoint();
    if (checkpoint) require_same_arithmetic(*checkpoint);
    if (checkpoint && checkpoint->state.step >= target_) {
      if (!options_.quiet) {
        say(fmt::format(
            "nothing to do: the run in {} is at step {}, the end is step {}; go on with a larger "
            "duration or --steps",
            directory_.path().string(), checkpoint->state.step, target_));
      }
      return 0;
    }
    require_steps_to_dump(checkpoint ? checkpoint->state.step : 0);
    if (checkpoint) {
      check_steps_csv(directory_.steps_csv(), card_.report, checkpoint->state.step);
      if (writes_forces()) check_forces_csv(directory_.forces_csv(), checkpoint->state.step);
    }
    require_known_solver(options_.target, scene_, world_options_, rank_count() > 1);
    require_memory(scene_, world_options_);
    if (scene_.output.surface_frames) require_surface_size(surface_size(scene_));
    start_clock_ = std::chrono::steady_clock::now();
    std::optional<std::int64_t> resumed_step;
    std::optional<double> resumed_time;
    std::string overlaps;  // where no contacts of a first step will tell
    if (!checkpoint && !card_.has_contacts)
      overlaps = overlap_warning(overlaps_as_rigid(scene_, world_options_), BodyConstants(scene_));
    std::optional<World> made;  // what it refuses is refused before any file changes
    with_scene_file(options_.target, [&] { made.emplace(scene_, world_options_); });
    World& world = *made;
    if (writes_forces()) world.track_forces();
    if (checkpoint) {
      restore_from(directory_.checkpoint_file(), *checkpoint, world);  // sums of forces go on
      resumed_step = checkpoint->state.step;
      resumed_time = checkpoint->state.time;
      checkpoint.reset();  // it is as large as the world
    }
    directory_.prepare();
    if (!options_.quiet)
      for (const std::string& note : notes_) say(note);
    if (!notice_.empty() && !options_.quiet) say(notice_);
    std::optional<RunFiles> files(std::in_place, directory_, scene_, world_options_.precision,
                                  rank_count(), resumed_step, resumed_time);
    if (!resumed_step) write_walls(directory_.walls(), scene_);
    scene_ = settings_of(scene_);  // steps have the memory of the rest
    if (!overlaps.empty()) say("warning: " + overlaps);
    record_.body_count = static_cast<int>(world.constants().size());
    const SignalGuard signals;
    start_record(resumed_step);
    const AbortRecord on_abort(world_options_.ranks.get(), [&](const std::string& text) {
      record_failure(text);
      finish_record(world);
    });
    try {
      simulate(world, *files, signals, resumed_step);
    } catch (const std::exception& error) {
      record_failure(error.what());
      directory_.require_present();  // when it is gone, that is what to tell
      const auto try_to = [](const auto& finish) {
        try {
          finish();
        } catch (const std::exception&) {
          // The first failure is the one to tell, and often the reason of this one.
        }
      };
      try_to([&] { files->publish(); });
      files.reset();  // on a full disk their second copies make room
      try_to([&] { finish_record(world); });
      throw;
    }
    finish_record(world);
    return 0;
  }

 private:
  /// The scene without its bodies.
  static Scene settings_of(const Scene& scene) {
    Scene s;
    s.name = scene.name;
    s.seed = scene.seed;
    s.dynamics = scene.dynamics;
    s.stepping = scene.stepping;
    s.solver = scene.solver;
    s.output = scene.output;
    s.joints = scene.joints;  // to name one that does not hold
    return s;
  }

  /// How GPUs of ranks exchange data; empty: there are none.
  std::string transport() const {
    if (world_options_.backend != BackendKind::cuda || world_options_.ranks == nullptr) return {};
    return to_string(world_options_.ranks->used_transport());
  }
  int rank_count() const {
    return world_options_.ranks != nullptr ? world_options_.ranks->count() : 1;
  }
  bool writes_forces() const { return scene_.output.force_interval > 0; }

  /// Another backend or precision would not go on bit for bit.
  void require_same_arithmetic(const Checkpoint& c) const {
    if (c.backend == world_options_.backend && c.precision == world_options_.precision) return;
    throw InputError(fmt::format("{}: was written with backend {} in {}, this run uses {} in {}",
                                 directory_.checkpoint_file().string(), to_string(c.backend),
                                 to_string(c.precision), to_string(world_options_.backend),
                                 to_string(world_options_.precision)));
  }

  /// @param first  steps done before the run
  void require_steps_to_dump(std::int64_t first) const {
    if (!options_.dump_problem.empty() && !card_.has_contacts)
      throw InputError(fmt::format(
          "--dump-problem: the dynamics \"{}\" have no contact problems to write", card_.name));
    if (!options_.dump_problem.empty()) require_storable_joints("--dump-problem", scene_);
    for (const std::int64_t step : options_.dump_problem)
      if (step <= first || step > target_)
        throw InputError(fmt::format("--dump-problem {}: this run makes the steps {} to {}", step,
                                     first + 1, target_));
  }

  /// Queues a task that writes into the output directory.
  template <class Task>
  void post(WriterThread& writer, Task task) const {
    writer.post([this, task = std::move(task)] {
      directory_.require_present();
      task();
    });
  }

  /// The next step; its contact problem goes to a file when that was asked for.
  StepReport advance(World& world, WriterThread& writer, Progress& progress) const {
    const std::int64_t step = world.steps_done() + 1;
    const std::vector<std::int64_t>& wanted = options_.dump_problem;
    if (std::find(wanted.begin(), wanted.end(), step) == wanted.end()) return world.step();
    auto problem = std::make_shared<StoredProblem>();
    StepReport report = world.step(problem->form.emplace<BodyProblem>());
    if (report.contact_count == 0) {
      progress.note(fmt::format("step {} has no contacts: {} is not written", step,
                                directory_.problem(step).filename().string()));
    } else {
      post(writer, [problem, path = directory_.problem(step)] { write_problem(path, *problem); });
    }
    return report;
  }

  void simulate(World& world, RunFiles& files, const SignalGuard& signals,
                std::optional<std::int64_t> resumed_step) {
    const double h = scene_.stepping.time_step;
    StepsCsv steps(directory_.steps_csv(), card_.report, resumed_step);
    WriterThread writer;
    ProgressOptions line = progress_options(options_.quiet);
    line.has_contacts = card_.has_contacts || card_.iteration_cap != nullptr;
    Progress progress(line, world.time(), static_cast<double>(target_) * h);
    if (steps.missing_steps() > 0) {
      record_.message =
          fmt::format("{} has no lines of {} of the {} steps before this run",
                      directory_.steps_csv().string(), steps.missing_steps(), *resumed_step);
      progress.note("warning: " + record_.message);
    }
    const Schedule frame_schedule(scene_.output.frame_interval, h);
    const Schedule picture_schedule(scene_.output.picture.interval, h);
    const Schedule checkpoint_schedule(scene_.output.checkpoint_interval, h);
    const Schedule force_schedule(scene_.output.force_interval, h);

    // One copy of all states at a time: each waits until the one before it is on disk.
    const auto write_frame = [&] {
      writer.finish();
      auto states = std::make_shared<BodyStates>();
      std::vector<std::int64_t> in_pieces;  // bodies of each rank
      if (files.frame_piece) {
        directory_.require_present();
        in_pieces = world.give_own_bodies(*files.frame_piece);  // all are on disk then
        *states = files.frame_piece->kept_states();
      } else {
        *states = world.states();
      }
      auto contacts = std::make_shared<std::vector<ContactRecord>>();
      if (files.contact_frames) *contacts = world.contacts();
      post(writer, [&files, states, in_pieces, contacts, t = world.time()] {
        if (files.frame_index)
          files.frame_index->append(t, in_pieces);
        else
          files.frames->append(t, *states);
        files.wall_frames.append(t, *states);
        if (files.contact_frames) files.contact_frames->append(t, *contacts);
        if (files.surface_frames) files.surface_frames->append(t, *states);
      });
    };
    // Numbers count the pictures that were due: a resumed run goes on where the first one stopped.
    std::int64_t picture_number = picture_schedule.count(world.time());
    double picture_time = -1;
    const auto write_picture = [&] {
      auto image = std::make_shared<Image>(world.render(scene_.output.picture));
      post(writer,
           [image, path = directory_.picture(picture_number++)] { write_png(path, *image); });
      picture_time = world.time();
    };
    const auto save_checkpoint = [&] {
      writer.finish();
      steps.flush();
      if (files.forces) files.forces->flush();
      auto state = std::make_shared<WorldState>(world.save());
      post(writer, [this, state, &files, &constants = world.constants()] {
        files.publish();  // a resumed run goes on from these
        write_checkpoint(directory_.checkpoint_file(), *state, constants, scene_text_,
                         world_options_.backend, world_options_.precision);
      });
    };

    if (files.frame_piece) world.begin_own_bodies(*files.frame_piece, files.pieces_resumed_time);
    if (!resumed_step) {
      for (const std::string& warning : world.warnings()) progress.note("warning: " + warning);
      write_frame();
    }
    const std::size_t told = world.warnings().size();
    double before = world.time();
    DeepestOverlap deepest;
    const auto is_interrupted = [&] { return signals.received() != 0 || world.is_asked_to_end(); };
    while (world.steps_done() < target_ && !is_interrupted()) {
      const StepReport report = advance(world, writer, progress);
      if (report.step == 1) warn_of_overlaps(world, report, progress);
      if (card_.has_contacts) deepest.note(world, report);
      steps.append(report);
      largest_share_ = std::max(largest_share_, report.largest_share);
      record_.totals.add(judged(report, scene_.solver));
      progress.update(judged(report, scene_.solver));
      writer.check();
      if (files.forces && force_schedule.due(before, report.time))
        files.forces->append(report.step, report.time, world.take_forces());
      if (frame_schedule.due(before, report.time)) write_frame();
      if (picture_schedule.due(before, report.time)) write_picture();
      if (checkpoint_schedule.due(before, report.time)) save_checkpoint();
      before = report.time;
    }
    write_frame();
    if (scene_.output.picture.interval >= 0 && picture_time != world.time()) write_picture();
    save_checkpoint();
    writer.finish();
    steps.flush();
    if (files.forces) files.forces->flush();
    progress.finish();
    record_.transport = transport();
    const std::string apart = joints_apart(record_.totals, scene_.joints, world.constants());
    const bool was_interrupted = is_interrupted();
    set_status_at_end(was_interrupted, apart, world.constants());
    if (was_interrupted) progress.note("interrupted: checkpoint written, continue with --resume");
    if (!options_.quiet) progress.note(summary());
    if (!options_.quiet && record_.ranks > 1)
      progress.note(fmt::format(
          "{} ranks{}; at most {:.3g} times the mean of bodies on one", record_.ranks,
          record_.transport.empty() ? "" : ", transport " + record_.transport, largest_share_));
    if (record_.totals.stopped() > 0) {
      progress.note(fmt::format(
          "warning: bodies were stopped {} times at a box or mesh wall that their contacts of the "
          "step did not know; a smaller time step follows them better",
          record_.totals.stopped()));
    }
    if (const std::string warning = deepest.warning(world.constants()); !warning.empty())
      progress.note("warning: " + warning);
    const std::vector<std::string> warnings = world.warnings();
    for (std::size_t k = told; k < warnings.size(); ++k) progress.note("warning: " + warnings[k]);
    constexpr double kMostTurn = 0.5;                        // rad
    if (record_.totals.max_turn() > kMostTurn * (1 + 1e-6))  // but for rounding
      progress.note(fmt::format(
          "warning: a body turned by {:.2g} rad in a step: steps follow turns of up to {:g} rad; a "
          "smaller time step follows it better, or max_turn of the dynamics",
          record_.totals.max_turn(), kMostTurn));
    const std::string unsolved = steps_not_converged(world.constants());
    if (options_.require_convergence && !(apart.empty() && unsolved.empty())) {
      const bool is_told = record_.status == RunStatus::joints_apart;
      throw RunError(is_told         ? to_string(record_.status) + (": " + record_.message)
                     : apart.empty() ? unsolved
                                     : apart);
    }
    for (const std::string& text : {apart, unsolved})
      if (!text.empty()) progress.note("warning: " + text);
  }

  /// @param apart  what is told of joints that did not hold
  void set_status_at_end(bool is_interrupted, const std::string& apart,
                         const BodyConstants& bodies) {
    record_.status = is_interrupted ? RunStatus::interrupted : RunStatus::done;
    const StepReport& last = record_.totals.last();
    if (is_interrupted) return;
    std::string message;
    if (are_joints_apart(last.max_joint_error, bodies)) {
      message = fmt::format("{}; at the end by {:.3g} m, with a residual of {:.3g} m/s RMS", apart,
                            last.max_joint_error, last.residual_rms);
    } else if (are_joints_contradicted(last, scene_.stepping.time_step, bodies)) {
      message = fmt::format(
          "the last step ended with a residual of {:.3g} m/s RMS, the largest, {:.3g} m/s, of {}: "
          "it contradicts "
          "another joint, a motion, or a motor without a bound",
          last.residual_rms, last.residual_max,
          joint_with_number(last.residual_max_joint, scene_.joints, bodies));
    } else {
      return;
    }
    record_.status = RunStatus::joints_apart;
    if (!record_.message.empty()) record_.message += "; ";
    record_.message += message;
  }

  /// Contacts of the first step are those of the start.
  static void warn_of_overlaps(const World& world, const StepReport& first, Progress& progress) {
    constexpr int kMostContacts = 50'000'000;  // that are copied to find the two bodies
    if (!(first.max_penetration > 0) || first.contact_count > kMostContacts) return;
    const Overlaps overlaps = overlaps_among(world.contacts(), world.constants());
    if (overlaps.pairs > 0)
      progress.note("warning: " + overlap_warning(overlaps, world.constants()));
  }

  /// How many steps ended at the iteration cap, as a sentence; empty when none did.
  std::string steps_not_converged(const BodyConstants& bodies) const {
    const RunTotals& t = record_.totals;
    if (t.steps_not_converged() == 0) return {};
    const SolverSettings& solver = scene_.solver;
    const SolverParameter* own = card_.iteration_cap;
    const std::string cap =
        own != nullptr ? fmt::format("dynamics.{} {}", own->key,
                                     own->text(own->of(scene_.dynamics.parameters)))
        : solver.exact_coulomb
            ? fmt::format("solver.max_iterations {}, solver.max_outer_iterations {}",
                          solver.max_iterations, solver.max_outer_iterations)
            : fmt::format("solver.max_iterations {}", solver.max_iterations);
    const char* other = own != nullptr ? ", or where rounding hid all lower energies," : "";
    return fmt::format("{} of {} steps ended at the iteration cap ({}){} above the tolerance{}",
                       t.steps_not_converged(), t.steps(), cap, other,
                       worst_of(t.worst_unsolved(), bodies));
  }

  std::string worst_of(const RunTotals::Unsolved& worst, const BodyConstants& bodies) const {
    if (worst.body_a < 0 && worst.body_b < 0) return {};
    const std::string of = worst.joint >= 0
                               ? joint_with_number(worst.joint, scene_.joints, bodies)
                               : fmt::format("{} and {}", body_with_id(bodies, worst.body_a),
                                             body_with_id(bodies, worst.body_b));
    return fmt::format("; the largest residual was {:.3g} m/s in step {}, of {}", worst.residual,
                       worst.step, of);
  }

  std::string summary() const {
    const RunTotals& t = record_.totals;
    std::string ms;
    for (const RunTotals::Stage& stage : t.stages())
      ms += fmt::format("{}{} {:.2f}", ms.empty() ? "" : ", ", stage.name, stage.mean);
    const std::string where = fmt::format("results in {}", directory_.path().string());
    if (card_.iteration_cap != nullptr)
      return fmt::format(
          "{} steps, {:.1f} iterations a step; ms a step: {}\nworst residual {:.3g} m/s; {}",
          t.steps(), t.mean_iterations(), ms, t.max_residual_rms(), where);
    if (!card_.has_contacts)
      return fmt::format("{} steps; ms a step: {}\n{}", t.steps(), ms, where);
    return fmt::format(
        "{} steps, {:.1f} iterations a step; ms a step: {}\nlargest penetration {:.3g} m, worst "
        "residual {:.3g} m/s; {}",
        t.steps(), t.mean_iterations(), ms, t.max_penetration(), t.max_residual_rms(), where);
  }

  void start_record(std::optional<std::int64_t> resumed_from) {
    const DeviceInfo device = device_info(world_options_.backend, world_options_.device);
    record_.scene_name = scene_.name;
    record_.scene_text = scene_text_;
    record_.command_line = options_.command_line;
    record_.backend = world_options_.backend;
    record_.precision = world_options_.precision;
    record_.device = device.name;
    record_.threads = threads_of(world_options_);
    record_.ranks = rank_count();
    record_.seed = scene_.seed;
    record_.start_time = utc_now();
    record_.resumed_from_step = resumed_from;
    write_run_record(directory_.run_json(), record_);
  }

  void record_failure(const std::string& message) {
    record_.status = RunStatus::failed;
    record_.message = message;
  }

  /// @throws RunError when the directory is no longer that of this run
  void finish_record(const World& world) {
    directory_.require_present();
    record_.end_time = utc_now();
    record_.peak_memory_bytes = world.peak_memory();
    record_.wall_seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start_clock_).count();
    write_run_record(directory_.run_json(), record_);
  }

  const RunOptions& options_;
  std::vector<std::string> notes_;  // of the scene
  Scene scene_;
  std::string scene_text_;
  std::string notice_;  // about the backend
  WorldOptions world_options_;
  OutputDirectory directory_;
  std::int64_t target_;
  DynamicsCard card_;  ///< of the model
  RunRecord record_;
  double largest_share_ = 1;  ///< see StepReport
  std::chrono::steady_clock::time_point start_clock_;
};

/// Ends what the ranks above 0 wait for, however a run on rank 0 ends.
class FollowerGuard {
 public:
  explicit FollowerGuard(Ranks& ranks) : ranks_(ranks) {}
  ~FollowerGuard() {
    try {
      release_followers(ranks_);
    } catch (const std::exception& error) {
      ranks_.abort(error.what(), 1);
    }
  }
  FollowerGuard(const FollowerGuard&) = delete;
  FollowerGuard& operator=(const FollowerGuard&) = delete;

 private:
  Ranks& ranks_;
};

/// Takes part in the run of rank 0, which alone speaks, and writes all but pieces of frames.
int follow(const RunOptions& options, const RunInput& input, Ranks& ranks) {
  note_requests_to_end();
  const fs::path folder = output_folder(options, input.scene);
  const AbortRecord on_abort(
      &ranks, [&](const std::string& text) { write_run_failure(folder / "run.json", text); });
  try {
    FramePiece piece(frame_piece_file(folder / "frames.vtkhdf", ranks.rank()), input.scene,
                     input.world.precision);
    follow_worlds(input.scene, input.world, &piece, is_requested_to_end);
  } catch (const std::exception& error) {
    ranks.abort(error.what(), 1);
  }
  return 0;
}

int run_on_ranks(const RunOptions& options, const std::shared_ptr<Ranks>& ranks) {
  std::optional<RunInput> input;
  const auto read = [&](RankReport& report) {
    input.emplace(options, ranks);
    require_known_solver(options.target, input->scene, input->world, true);
    require_memory(input->scene, input->world);
    report.scene = input->text;
    report.arithmetic =
        fmt::format("backend {} in {}, transport {}, to step {}", to_string(input->world.backend),
                    to_string(input->world.precision), to_string(ranks->transport()),
                    step_target(options, input->scene));
    if (input->scene.output.frame_pieces)
      report.folder =
          fs::absolute(output_folder(options, input->scene)).lexically_normal().string();
  };
  const int code = start_together(*ranks, read);
  if (code != 0) return code;
  if (ranks->rank() > 0) return follow(options, *input, *ranks);
  const FollowerGuard guard(*ranks);
  return Run(options, std::move(*input)).go();
}

}  // namespace

int run_scene(const RunOptions& options) {
  std::shared_ptr<Ranks> ranks;
  try {
    ranks = mpi_ranks();
  } catch (const InputError&) {
    if (launch_of_environment().rank > 0) return 0;  // rank 0 says it, and ends with its code
    throw;
  }
  if (ranks != nullptr) return run_on_ranks(options, ranks);
  return Run(options, RunInput(options, nullptr)).go();
}

}  // namespace scree
