#pragma once
// forces.csv: mean force and torque on each wall, group and joint, a line each per interval.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "host/io/line_file.h"
#include "host/world.h"

namespace scree {

/// Which lines an interval has: kind and name of each target.
struct ForceTargets {
  /// Groups are told apart only where there are several.
  explicit ForceTargets(const Scene& scene);

  std::vector<std::string>
      bodies;  ///< "fixed,4": the columns kind and name, in the order of MeanForces
  std::vector<std::string> groups;
  std::vector<std::string> joints;
};

/// Writes forces.csv, see LineFile.
class ForcesCsv {
 public:
  /// Starts a new file, or continues one.
  /// @param resume_step  number of steps done by the checkpoint: later lines, and a torn last one, are cut off. Not set, or
  ///                     no file there: a new file
  /// @throws InputError when the file to continue is another table, @throws RunError when it cannot be written
  ForcesCsv(std::filesystem::path path, ForceTargets targets,
            std::optional<std::int64_t> resume_step = {});

  /// @param step, time  at the end of the interval
  void append(std::int64_t step, double time, const MeanForces& forces);
  void flush() { file_->flush(); }

 private:
  void append_part(const std::string& start, const std::vector<std::string>& targets,
                   const std::vector<ForceRecord>& forces);

  ForceTargets targets_;
  std::optional<LineFile> file_;
};

/// Changes nothing. @throws InputError as ForcesCsv does of a file to continue
void check_forces_csv(const std::filesystem::path& path, std::int64_t resume_step);

}  // namespace scree
