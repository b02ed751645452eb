#pragma once
// run.json: what was run, with what, on what, and how it ended.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "dynamics/dynamics_card.h"
#include "host/world.h"

namespace scree {

/// Sums over the steps of a run, kept up step by step.
class RunTotals {
 public:
  /// @param card  of the model
  explicit RunTotals(const DynamicsCard& card);

  void add(const StepReport& report);

  std::int64_t steps() const { return steps_; }
  std::int64_t steps_not_converged() const { return steps_not_converged_; }
  /// How often a sphere was stopped at a box or mesh wall within a step.
  std::int64_t stopped() const { return stopped_; }
  double simulated_time() const { return simulated_time_; }  ///< at the end [s]
  /// Times of a stage of the model [ms].
  struct Stage {
    std::string name;
    double mean = 0;  ///< over the steps
  };
  std::vector<Stage> stages() const;
  double mean_iterations() const;
  double max_residual_rms() const { return max_residual_rms_; }  ///< [m/s]
  double max_residual_relative() const { return max_residual_relative_; }
  double max_penetration() const { return max_penetration_; }  ///< [m]
  double max_joint_error() const { return max_joint_error_; }  ///< [m]
  std::int64_t joint_error_step() const { return joint_error_step_; }
  int joint_error_joint() const { return joint_error_joint_; }  ///< its number in Scene::joints
  std::int64_t max_contacts() const { return max_contacts_; }
  double max_turn() const { return max_turn_; }  ///< of a body in a step [rad]
  const StepReport& last() const { return last_; }
  /// The largest residual of a contact or joint in steps above the tolerance.
  struct Unsolved {
    std::int64_t step = 0;
    double residual = 0;                           ///< [m/s]
    int body_a = kWorldBody, body_b = kWorldBody;  ///< ids; both of the world: not known
    int joint = -1;                                ///< number in the scene; -1: of a contact
  };
  const Unsolved& worst_unsolved() const { return unsolved_; }
  const DynamicsCard& card() const { return card_; }

 private:
  DynamicsCard card_;
  std::int64_t steps_ = 0;
  std::int64_t steps_not_converged_ = 0;
  std::int64_t stopped_ = 0;
  std::int64_t iterations_ = 0;
  double simulated_time_ = 0;
  std::vector<double> sum_ms_;  ///< of each stage
  double max_residual_rms_ = 0;
  double max_residual_relative_ = 0;
  double max_penetration_ = 0, max_joint_error_ = 0;
  std::int64_t joint_error_step_ = 0;
  int joint_error_joint_ = -1;
  std::int64_t max_contacts_ = 0;
  double max_turn_ = 0;
  Unsolved unsolved_;
  StepReport last_;
};

enum class RunStatus {
  running,
  done,
  joints_apart,  ///< done, with joints that do not hold at the end
  interrupted,
  failed
};

struct RunRecord {
  explicit RunRecord(const DynamicsCard& card) : totals(card) {}

  std::string scene_name;
  std::string scene_file;  ///< as given
  std::string scene_text;  ///< resolved scene; stored as JSON when it is
  std::vector<std::string> command_line;
  BackendKind backend = BackendKind::cpu;
  Precision precision = Precision::single_precision;
  std::string device;  ///< name of the processor or GPU
  int threads = 0;
  int ranks = 1;          ///< that simulate together
  std::string transport;  ///< between their GPUs; empty: they have none
  std::uint64_t seed = 0;
  int body_count = 0;       ///< of the whole scene, all kinds
  std::string start_time;   ///< utc_now() at the start
  std::string end_time;     ///< empty while running
  double wall_seconds = 0;  ///< of this process, time in set-up included
  std::optional<std::int64_t> resumed_from_step;
  RunStatus status = RunStatus::running;
  std::string message;                  ///< why it failed, or what a user should know
  std::uint64_t peak_memory_bytes = 0;  ///< backend memory
  RunTotals totals;
};

/// Replaces run.json in one rename, with the version and commit of this program.
/// @throws RunError naming the file and the reason
void write_run_record(const std::filesystem::path& path, const RunRecord& record);

/// Tells in run.json that a run failed, from a process that does not keep its record. Nothing where no run.json says that it runs.
/// @throws RunError naming the file and the reason
void write_run_failure(const std::filesystem::path& path, const std::string& message);

/// Time now, ISO 8601 in UTC with seconds: 2024-05-31T12:34:56Z.
std::string utc_now();

const char* to_string(RunStatus status);

}  // namespace scree
