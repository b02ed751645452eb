#pragma once
// Scenes, states and directories for the tests of what a run writes.

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>

#include "host/world.h"
#include "shapes/half_space.h"
#include "shapes/sphere.h"

namespace scree::test {

/// A fresh directory, removed with its contents at the end.
class ScratchDirectory {
 public:
  ScratchDirectory() {
    std::string pattern = (std::filesystem::path(testing::TempDir()) / "scree_XXXXXX").string();
    if (::mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no scratch directory");
    path_ = pattern;
  }
  ~ScratchDirectory() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  ScratchDirectory(const ScratchDirectory&) = delete;
  ScratchDirectory& operator=(const ScratchDirectory&) = delete;
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

inline std::string contents(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

inline void put(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

/// The state of a run of rigid bodies that has none.
inline WorldState empty_state() {
  WorldState state;
  state.dynamics = "rigid";
  state.add<std::int32_t>("body/id", {});
  state.add<Vec3d>("body/position", {});
  state.add<Quatd>("body/orientation", {});
  state.add<Vec3d>("body/velocity", {});
  state.add<Vec3d>("body/angular_velocity", {});
  state.add<std::int32_t>("contact/body_a", {});
  state.add<std::int32_t>("contact/body_b", {});
  state.add<std::uint64_t>("contact/feature", {});
  state.add<Vec3d>("contact/impulse", {});
  state.add<std::int32_t>("contact/mark", {});
  state.add<double>("solver/memory", {});
  return state;
}

/// Spheres present at the start, with a floor between them, and batches of spheres that join later.
inline Scene scene_with(int first, int batches, int per_batch) {
  Scene scene;
  const auto sphere = [](int i) {
    BodyDescription body;
    body.shape.kind = shapes::Sphere::kind;
    body.shape.radius = 0.1 + i;
    body.mass = 2.0 + i;
    body.group = i % 3;
    return body;
  };
  for (int i = 0; i < first; ++i) scene.bodies.push_back(sphere(i));
  if (first > 1) {
    scene.bodies[1].kind = BodyKind::fixed;
    scene.bodies[1].shape.kind = shapes::HalfSpace::kind;
    scene.bodies[1].mass = 0;
  }
  for (int batch = 0; batch < batches; ++batch) {
    Insertion insertion;
    insertion.time = batch + 1;
    for (int i = 0; i < per_batch; ++i)
      insertion.bodies.push_back(sphere(first + batch * per_batch + i));
    scene.insertions.push_back(insertion);
  }
  return scene;
}

/// States that tell frame and body apart.
inline BodyStates states_of(int frame, int bodies) {
  BodyStates states;
  for (int i = 0; i < bodies; ++i) {
    states.position.push_back({frame + 0.25, i + 0.125, 1e-9});
    states.orientation.push_back({0.5, 0.5, -0.5, 0.5});
    states.velocity.push_back({3.0 * frame, 0, 4.0 * frame});
    states.angular_velocity.push_back({i * 1.0, frame * 1.0, -1.0});
  }
  return states;
}

/// Runs a function in a child process whose files may not grow past the given size,
/// as on a full disk.
/// @return the child's exit code: what the function returns
template <class Function>
int with_full_disk(rlim_t bytes, Function function) {
  const pid_t child = ::fork();
  if (child == 0) {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{bytes, bytes};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    ::_exit(function());
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

}  // namespace scree::test
