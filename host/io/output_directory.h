#pragma once
// Where a run writes, and the rules that keep earlier results safe.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "host/io/checkpoint.h"

namespace scree {

/// What to do with a directory that holds something already.
enum class ExistingOutput {
  refuse,   ///< default: it must be empty or not exist
  replace,  ///< --force: files that runs write are removed, nothing else is touched
  resume    ///< --resume: the run of its checkpoint goes on
};

/// The output directory of a run. Made in two moves: the constructor only checks, so that it can
/// refuse before anything starts; prepare() creates and removes.
///
/// Rules: a directory that does not exist is created, with its parents. One that is not empty is
/// refused unless told otherwise. One that is no directory, cannot be written, or is being written
/// by another run is refused. resume needs a readable checkpoint.h5 of the same scene.
class OutputDirectory {
 public:
  /// @param scene_text  resolved scene, as write_checkpoint stores it; compared with the
  ///                    checkpoint's when resuming. JSON texts are compared by value
  /// @param may_differ  JSON pointers of values that a resumed run may change, for example
  ///                    "/stepping/duration"; what lies below them may change too
  /// @throws InputError naming the path, what was found and what to do
  OutputDirectory(std::filesystem::path path, ExistingOutput existing,
                  const std::string& scene_text, const std::vector<std::string>& may_differ = {});
  ~OutputDirectory();
  OutputDirectory(const OutputDirectory&) = delete;
  OutputDirectory& operator=(const OutputDirectory&) = delete;

  /// Creates the directory, or removes the files of the earlier run, and locks it
  /// against other runs.
  /// @throws InputError when another run came first, @throws RunError when the system refuses
  void prepare();

  /// Files that are written now are files of this run. Call it before and after writing.
  /// @throws RunError when the directory was removed or replaced since prepare()
  void require_present() const;

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path run_json() const { return path_ / "run.json"; }
  std::filesystem::path steps_csv() const { return path_ / "steps.csv"; }
  std::filesystem::path forces_csv() const { return path_ / "forces.csv"; }
  std::filesystem::path frames() const { return path_ / "frames.vtkhdf"; }
  std::filesystem::path checkpoint_file() const { return path_ / "checkpoint.h5"; }
  std::filesystem::path contact_frames() const { return path_ / "contacts.vtkhdf"; }
  std::filesystem::path wall_frames() const { return path_ / "walls.vtkhdf"; }
  std::filesystem::path surface_frames() const { return path_ / "surfaces.vtkhdf"; }
  std::filesystem::path walls() const { return path_ / "walls.obj"; }
  std::filesystem::path picture(std::int64_t number) const;  ///< picture_00042.png
  std::filesystem::path problem(std::int64_t step) const;    ///< problem_42.hdf5

  /// The checkpoint to go on from; empty unless resuming. Taking it frees its memory here.
  bool resuming() const { return existing_ == ExistingOutput::resume; }
  std::optional<Checkpoint> take_checkpoint() { return std::exchange(checkpoint_, {}); }

 private:
  void check_directory() const;
  void lock();
  void load_checkpoint(const std::string& scene_text, const std::vector<std::string>& may_differ);
  std::vector<std::filesystem::path> own_files() const;

  std::filesystem::path path_;
  ExistingOutput existing_;
  std::optional<Checkpoint> checkpoint_;
  int lock_ = -1;
};

}  // namespace scree
