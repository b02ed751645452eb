#include "tests/fuzz/readers.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "host/error.h"
#include "host/io/body_problem_layout.h"
#include "host/io/checkpoint.h"
#include "host/io/problem_file.h"
#include "host/io/seal.h"
#include "host/scene/height_field.h"
#include "host/scene/mesh_reader.h"
#include "host/scene/motion.h"
#include "host/scene/particle_table.h"
#include "host/scene_reader.h"
#include "host/solve/solve_problem.h"
#include "host/urdf.h"
#include "host/world.h"
#include "tests/fuzz/hdf5_edits.h"
#include "tests/urdf_support.h"

namespace scree::fuzz {
namespace {

namespace fs = std::filesystem;

/// A file of this process, gone at the end of the scope.
class ScratchFile {
 public:
  explicit ScratchFile(const std::string& extension)
      : path_(fs::temp_directory_path() /
              ("scree_fuzz_" + std::to_string(::getpid()) + extension)) {}
  ~ScratchFile() {
    std::error_code ignored;
    fs::remove(path_, ignored);
  }
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

void put(const fs::path& path, std::string_view bytes) {
  std::ofstream(path, std::ios::binary)
      .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

/// Whether a scene asks for more than a test has time for: what it may, and others test.
bool is_large(const nlohmann::json& json) {
  if (json.is_structured())
    return std::any_of(json.begin(), json.end(), [](const auto& value) { return is_large(value); });
  return json.is_number() && !(std::abs(json.get<double>()) <= 3000);
}

void read_scene_bytes(std::string_view bytes) {
  const nlohmann::json json =
      nlohmann::json::parse(bytes, nullptr, /*allow_exceptions=*/false, /*ignore_comments=*/true);
  if (is_large(json)) throw InputError("larger than tests have time for");
  parse_scene(std::string(bytes), "scene.json", fs::temp_directory_path());
}

template <class Read>
void read_as_file(std::string_view bytes, const std::string& extension, Read read) {
  const ScratchFile file(extension);
  put(file.path(), bytes);
  read(file.path());
}

void read_mesh_bytes(std::string_view bytes) {
  bool was_read = false;
  for (const char* extension : {".obj", ".stl", ".msh", ".vtk"})
    for (const bool closed : {true, false}) try {
        read_as_file(bytes, extension,
                     [&](const fs::path& path) { read_mesh(path, {.closed = closed}); });
        was_read = true;
      } catch (const InputError&) {
        // The other ways of reading it have their turn.
      }
  if (!was_read) throw InputError("no mesh");
}

/// As a table and as a picture; both make the mesh.
void read_height_bytes(std::string_view bytes) {
  HeightGrid grid;
  try {
    read_as_file(bytes, ".csv",
                 [&](const fs::path& path) { grid = read_height_table(path, 1, 0); });
  } catch (const InputError&) {
    read_as_file(bytes, ".png",
                 [&](const fs::path& path) { grid = read_height_picture(path, -1, 1); });
  }
  try {
    height_field_mesh("heights", grid, {3, 2}, 0.1);
  } catch (const std::invalid_argument& error) {
    throw InputError(error.what());
  }
}

void read_motion_bytes(std::string_view bytes) {
  read_as_file(bytes, ".csv", [](const fs::path& path) {
    Motion motion;
    motion.kind = Motion::Kind::sampled;
    read_motion_csv(path, motion);
    BodyDescription wall;
    wall.motion = motion;
    for (const double t : {0.0, 0.5, 1e9}) pose_at(wall, t);
  });
}

void use_problem(const fs::path& path) {
  const StoredProblem stored = read_problem(path);
  ready_matrix_free("fuzz", stored);
  try {
    ready("fuzz", stored);
  } catch (const InputError&) {
    // Bodies with rolling friction have no matrices.
  }
}

/// All that is done with a checkpoint: another scene takes its spheres, a run goes on from it.
void use_checkpoint(const fs::path& path) {
  const Checkpoint c = read_checkpoint(path);
  try {
    read_checkpoint_particles(path);
  } catch (const InputError&) {
    // It may still be one to go on from.
  }
  World world(parse_scene(c.scene_text, "scene.json", fs::temp_directory_path()),
              {.backend = BackendKind::cpu, .precision = c.precision, .threads = 1});
  world.restore(c.state);
  for (int k = 0; k < 2; ++k) world.step();
}

/// Edits the seed that the first byte picks, and seals it. That goes for files of others too:
/// without a seal they are read in a child process first, and what crashes there is
/// only a refusal here.
template <class Use>
void edit_and_use(const std::string& reader, const char* kind, int version, std::string_view bytes,
                  Use use) {
  if (bytes.empty()) return;
  const std::vector<fs::path> all = seeds(reader);
  const fs::path& seed = all[static_cast<unsigned char>(bytes.front()) % all.size()];
  const std::string user_block(reader == "fclib" ? seal_bytes : 0, '\0');
  read_as_file(user_block + contents(seed), ".hdf5", [&](const fs::path& path) {
    edit_hdf5(path, bytes.substr(1));
    write_seal(path, kind, version);
    use(path);
  });
}

void give(const std::string& reader, std::string_view bytes) {
  if (reader == "scene") return read_scene_bytes(bytes);
  if (reader == "particles")
    return read_as_file(bytes, ".csv", [](const fs::path& path) { read_particle_csv(path, 0); });
  if (reader == "mesh") return read_mesh_bytes(bytes);
  if (reader == "heights") return read_height_bytes(bytes);
  if (reader == "motion") return read_motion_bytes(bytes);
  if (reader == "urdf") {
    Scene scene;
    add_urdf(scene, parse_urdf(std::string(bytes), "x.urdf"));
    return;
  }
  if (reader == "problem" || reader == "fclib")
    return edit_and_use(reader, problem_format_name, problem_format_version, bytes, use_problem);
  if (reader == "checkpoint")
    return edit_and_use(reader, "scree checkpoint", checkpoint_format_version, bytes,
                        use_checkpoint);
  throw std::logic_error("no reader " + reader);
}

}  // namespace

const std::vector<std::string>& readers() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all{"scene",  "particles", "mesh",       "heights",
                                 "motion", "problem",   "checkpoint", "fclib"};
    if (test::reads_urdf()) all.emplace_back("urdf");
    return all;
  }();
  return names;
}

std::vector<fs::path> seeds(const std::string& reader) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry :
       fs::directory_iterator(fs::path(SCREE_SOURCE_DIR) / "tests/fuzz/seeds" / reader))
    files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

std::string contents(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

bool read_bytes(const std::string& reader, std::string_view bytes) try {
  give(reader, bytes);
  return true;
} catch (const InputError&) {
  return false;  // what readers are for
} catch (const RunError&) {
  return false;  // a run from odd numbers may fail, with a message
}

}  // namespace scree::fuzz
