#pragma once
// What a model of dynamics says of itself. The record stands beside its class; scene check, schema,
// help, memory forecast, steps.csv, frames and checkpoints read it, so that a model is known
// everywhere by its own file and a line in the list of dynamics/CMakeLists.txt.

#include <limits>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "host/world.h"
#include "solvers/solver_parameter.h"

namespace scree {

/// A quantity that StepReport or BodyStates hold in `own`, at this place.
struct Own {
  std::size_t place = 0;
};

/// Stands in a StepReport for what a step has no value of: steps.csv has an empty field there, run.json null.
inline constexpr double kNoValue = std::numeric_limits<double>::infinity();

/// A column of steps.csv.
struct ReportColumn {
  const char* name;  ///< with its unit; times of stages end with _ms
  std::variant<std::int64_t StepReport::*, int StepReport::*, bool StepReport::*,
               double StepReport::*, double StageTimes::*, Own>
      value;
};

/// Calls visit(value) with the value of a column in a report. Report: StepReport or const.
template <class Report, class Visit>
void with_value(const ReportColumn& column, Report& report, Visit visit) {
  std::visit(
      [&](auto where) {
        using Where = decltype(where);
        if constexpr (std::is_same_v<Where, Own>) {
          if constexpr (!std::is_const_v<Report>) {
            if (report.own.size() <= where.place) report.own.resize(where.place + 1);
          }
          visit(report.own.at(where.place));
        } else if constexpr (std::is_same_v<Where, double StageTimes::*>) {
          visit(report.ms.*where);
        } else {
          visit(report.*where);
        }
      },
      column.value);
}

/// What frames hold of every body beside its position, in the precision of the run.
struct FrameField {
  const char* name;
  int columns;  ///< numbers a body
  std::variant<std::vector<Vec3d> BodyStates::*, std::vector<Quatd> BodyStates::*, Own> values;
  bool length = false;  ///< the length of the vector stands for it: one column
};

/// An array that a state of the model has, see WorldState.
struct StateField {
  enum class Type { int32, uint64, number, vector, quaternion };
  const char* name;  ///< the bodies themselves are body/id and body/position in every model
  Type type;
  const char* rows_of = nullptr;  ///< has as many rows as this array; null: any number
  int most_rows = 1;              ///< or a multiple of them up to this
  bool may_be_empty = false;      ///< or none
  bool may_be_absent = false;     ///< a scene may have nothing of the kind
  double largest = 0;             ///< of its numbers; 0: not checked
  int first_version = 1;          ///< of the format of checkpoints that has it
  int last_version = 1 << 30;
};

struct DynamicsCard {
  const char* name;                                  ///< in scenes; that of its file
  const char* description;                           ///< what it is, in one line
  std::span<const SolverParameter> parameters = {};  ///< in `dynamics` of a scene
  /// Bodies meet in contacts that a solver of steps solves: it is asked whether it serves the
  /// scene, and progress, totals and benchmarks tell of contacts and residuals.
  bool has_contacts = false;
  /// Parameter that bounds iterations of a step in models that solve by themselves: progress and totals tell of contacts,
  /// iterations and residuals. Null: a step has none, or those of a solver.
  const SolverParameter* iteration_cap = nullptr;
  bool has_joints = false;               ///< joints hold bodies together; else scenes have none
  bool meshes_may_be_free = false;       ///< what meets are surfaces, those of free bodies too
  bool bodies_may_be_elastic = false;    ///< and bend, where their meshes have tetrahedra
  bool has_collision_groups = false;     ///< bodies of one group do not touch each other
  bool has_loads = false;                ///< bodies may have forces and torques of their own
  std::span<const ReportColumn> report;  ///< steps.csv; the first is the number of the step
  std::span<const FrameField> frame;
  std::span<const StateField> state;
  /// What is wrong with the scene for this model, @throws InputError; null: nothing ever is.
  void (*check)(const Scene&) = nullptr;
  /// Backend memory of a body at the fullest, all that goes with it included [bytes].
  double (*bytes_per_body)(const Scene&, const WorldOptions&);
  /// The same when what only makes steps faster is left out; null: nothing is.
  double (*least_bytes_per_body)(const Scene&, const WorldOptions&) = nullptr;

  bool has_column(const std::string& column) const;
};

/// The models that this program has, in the order of the list.
const std::vector<DynamicsCard>& dynamics_cards();

/// The model of that name, or null.
const DynamicsCard* find_dynamics(const std::string& name);

/// @throws InputError naming the known models when the name is none of them
const DynamicsCard& dynamics_card(const std::string& name);

std::vector<std::string> dynamics_names();

}  // namespace scree
