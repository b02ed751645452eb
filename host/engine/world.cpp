#include "host/world.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <thread>

#include "dynamics/dynamics.h"
#include "dynamics/ranks/leading.h"
#include "dynamics/ranks/shareable.h"
#include "host/engine/cuda_device.h"
#include "host/engine/roster.h"
#include "host/error.h"
#include "host/scene/scene_checks.h"
#include "kernels/backend/cpu.h"

namespace scree {

class Cuda;

namespace {

bool has_several_ranks(const WorldOptions& options) {
  return options.ranks != nullptr && options.ranks->count() > 1;
}

std::unique_ptr<Dynamics> own_dynamics(Scene scene, const WorldOptions& options) {
  validate(scene);
  if (has_several_ranks(options)) require_shareable(scene);
  std::string reason;
  if (!backend_available(options.backend, &reason, options.device))
    throw InputError((options.backend == BackendKind::cuda ? "backend cuda: " : "backend cpu: ") +
                     reason);
  if (options.threads < 0)
    throw InputError("threads are " + std::to_string(options.threads) +
                     ", expected 1 or more, or 0 for as many as OpenMP offers");
  require_solver(scene, options);
#ifdef SCREE_HAS_CUDA
  if (options.backend == BackendKind::cuda) {
    const CudaDeviceScope scope(options.device);
    return make_dynamics<Cuda>(std::move(scene), options);
  }
#endif
  return make_dynamics<Cpu>(std::move(scene), options);
}

std::unique_ptr<Dynamics> dynamics_for(Scene scene, const WorldOptions& options) {
  if (!has_several_ranks(options) || options.rank_calls == RankCalls::together)
    return own_dynamics(std::move(scene), options);
  return lead(options.ranks, [&] { return own_dynamics(std::move(scene), options); });
}

/// The dynamics of a world, while its device is the current one of this thread.
class OnDevice {
 public:
#ifdef SCREE_HAS_CUDA
  explicit OnDevice(Dynamics& dynamics) : dynamics_(&dynamics), scope_(dynamics.cuda_device()) {}
#else
  explicit OnDevice(Dynamics& dynamics) : dynamics_(&dynamics) {}
#endif
  Dynamics* operator->() const { return dynamics_; }

 private:
  Dynamics* dynamics_;
#ifdef SCREE_HAS_CUDA
  CudaDeviceScope scope_;
#endif
};

[[noreturn]] void throw_unknown_name(const char* what, const std::string& name,
                                     const std::vector<std::string>& known) {
  std::string list;
  for (const std::string& other : known) list += (list.empty() ? "\"" : ", \"") + other + '"';
  throw InputError(std::string("no ") + what + " is called \"" + name + "\"; " +
                   (known.empty() ? std::string("none has a name") : "there are " + list));
}

/// Host memory that can be had without swapping [bytes]; the largest number when unknown.
std::size_t free_host_memory() {
  std::ifstream lines("/proc/meminfo");
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with("MemAvailable:"))
      return 1024 * static_cast<std::size_t>(std::stoull(line.substr(13)));
  return std::numeric_limits<std::size_t>::max();
}

}  // namespace

World::World(Scene scene, const WorldOptions& options)
    : names_{scene.body_names, scene.groups, scene.stepping.time_step},
      options_(options),
      roster_(options.bodies_may_change ? std::make_unique<Roster>(scene) : nullptr),
      dynamics_(dynamics_for(std::move(scene), options)) {}
World::~World() { release(); }
World::World(World&&) noexcept = default;
World& World::operator=(World&& other) noexcept {
  if (this == &other) return *this;
  release();
  names_ = std::move(other.names_);
  options_ = other.options_;
  roster_ = std::move(other.roster_);
  peak_before_ = other.peak_before_;
  dynamics_ = std::move(other.dynamics_);
  return *this;
}

/// Memory is given back while its device is the current one.
void World::release() noexcept {
  if (dynamics_ == nullptr) return;
  try {
    const OnDevice on_device(*dynamics_);
    dynamics_.reset();
  } catch (const std::runtime_error&) {  // the driver is gone, as when a program ends
    dynamics_.reset();
  }
}

StepReport World::step() { return OnDevice(*dynamics_)->step(nullptr); }
StepReport World::step(BodyProblem& problem) { return OnDevice(*dynamics_)->step(&problem); }
StepReport World::run(double seconds, const std::function<bool(const StepReport&)>& after_step) {
  const double steps = std::round(seconds / names_.time_step);
  if (!(steps >= 0 && steps <= 1e15))
    throw InputError("run(): " + std::to_string(seconds) + " s is not allowed: must be from 0 to " +
                     "1e15 time steps");
  StepReport report;
  for (auto left = static_cast<std::int64_t>(steps); left > 0; --left) {
    report = step();
    if (after_step && !after_step(report)) break;
  }
  return report;
}

std::int64_t World::steps_done() const { return dynamics_->steps_done(); }
double World::time() const { return dynamics_->time(); }
int World::body_count() const { return dynamics_->body_count(); }
int World::id_end() const { return dynamics_->id_end(); }
bool World::has_body(int id) const { return dynamics_->has_body(id); }
BodyStates World::states() const { return OnDevice(*dynamics_)->states(); }
void World::begin_own_bodies(OwnBodiesSink& sink, std::optional<double> resumed_time) {
  OnDevice(*dynamics_)->begin_own_bodies(sink, resumed_time);
}
std::vector<std::int64_t> World::give_own_bodies(OwnBodiesSink& sink) {
  return OnDevice(*dynamics_)->give_own_bodies(sink);
}
const BodyConstants& World::constants() const { return dynamics_->constants(); }
std::vector<ContactRecord> World::contacts() const { return OnDevice(*dynamics_)->contacts(); }
std::vector<JointRecord> World::joints() const { return OnDevice(*dynamics_)->joints(); }
void World::track_forces() { OnDevice(*dynamics_)->track_forces(); }
MeanForces World::take_forces() { return OnDevice(*dynamics_)->take_forces(); }

BodyKind World::kind_of(int body) const {
  if (roster_ != nullptr && roster_->is_removed(body))
    throw InputError("body " + std::to_string(body) + " is not in the simulation: it was removed");
  if (!dynamics_->has_body(body))
    throw InputError("body " + std::to_string(body) + " is not in the simulation: it has " +
                     std::to_string(dynamics_->body_count()) + " bodies now, with numbers below " +
                     std::to_string(dynamics_->id_end()));
  return dynamics_->constants()[static_cast<std::size_t>(body)].kind;
}

ForceRecord World::force_on(int body) const {
  kind_of(body);
  return OnDevice(*dynamics_)->force_on_body(body);
}

int World::group(const std::string& name) const {
  const auto found = std::find(names_.groups.begin(), names_.groups.end(), name);
  if (found == names_.groups.end()) throw_unknown_name("group", name, names_.groups);
  return static_cast<int>(found - names_.groups.begin());
}

ForceRecord World::force_on_group(const std::string& name) const {
  return OnDevice(*dynamics_)->force_on_group(group(name));
}

int World::body(const std::string& name) const {
  const auto found = names_.bodies.find(name);
  if (found != names_.bodies.end()) return found->second;
  std::vector<std::string> known;
  for (const auto& [other, id] : names_.bodies) known.push_back(other);
  throw_unknown_name("body", name, known);
}

void World::set_gravity(const Vec3d& gravity) { OnDevice(*dynamics_)->set_gravity(gravity); }

void World::set_velocity(int body, const Vec3d& velocity, const Vec3d& angular_velocity) {
  const BodyKind kind = kind_of(body);
  if (kind == BodyKind::free) {
    OnDevice(*dynamics_)->set_velocity(body, velocity, angular_velocity);
    return;
  }
  if (kind == BodyKind::fixed)
    throw InputError("set_velocity(): body " + std::to_string(body) +
                     " is fixed: only free and kinematic bodies have a velocity");
  Motion motion;
  motion.kind = Motion::Kind::linear;
  motion.velocity = velocity;
  motion.angular_velocity = angular_velocity;
  set_motion(body, motion);
}

void World::set_motion(int body, const Motion& motion) {
  kind_of(body);
  OnDevice(*dynamics_)->set_motion(body, motion);
}

void World::apply_force(int body, const Vec3d& force, const Vec3d& torque) {
  if (kind_of(body) != BodyKind::free)
    throw InputError("apply_force(): body " + std::to_string(body) +
                     " is not free: forces do not move it");
  OnDevice(*dynamics_)->apply_force(body, force, torque);
}

std::vector<std::string> World::warnings() const { return dynamics_->warnings(); }
std::vector<ContactRecord> World::overlaps() const { return OnDevice(*dynamics_)->overlaps(); }
std::vector<ArrayInfo> World::arrays() const { return OnDevice(*dynamics_)->arrays(); }
ArrayView World::array(const std::string& name) { return OnDevice(*dynamics_)->array(name); }
void World::arrays_changed(Written what) { OnDevice(*dynamics_)->arrays_changed(what); }

void World::require_changing_bodies(const char* call) const {
  if (!dynamics_->bodies_may_change())
    throw InputError(std::string("the dynamics of this scene have no ") + call);
  if (roster_ == nullptr)
    throw InputError(std::string(call) + " needs WorldOptions::bodies_may_change");
}

void World::become(std::unique_ptr<Roster> next,
                   const std::function<void(Dynamics&, const WorldState&)>& go_on) {
  const WorldState left = OnDevice(*dynamics_)->leave();
  const auto make = [&](const Roster& roster, const auto& then) {
    dynamics_ = dynamics_for(roster.scene(), options_);
    const OnDevice on_device(*dynamics_);
    dynamics_->change_bodies(roster.removed());
    then(*dynamics_, left);
  };
  peak_before_ = peak_memory();
  release();  // its memory is for what comes
  try {
    make(*next, go_on);
  } catch (...) {
    if (dynamics_ != nullptr) release();
    make(*roster_, [](Dynamics& dynamics, const WorldState& state) { dynamics.enter(state); });
    throw;
  }
  roster_ = std::move(next);
  names_.bodies = roster_->names();
}

int World::add(const BodyDescription& body, const std::string& name) {
  return add_all({body}, {name})[0];
}

std::vector<int> World::add_all(const std::vector<BodyDescription>& bodies,
                                const std::vector<std::string>& names) {
  require_changing_bodies("add()");
  if (!names.empty() && names.size() != bodies.size())
    throw InputError("add_all(): " + std::to_string(names.size()) +
                     " names are not allowed: must be " + "one for each of " +
                     std::to_string(bodies.size()) + " bodies, or none");
  if (bodies.empty()) return {};
  auto next = std::make_unique<Roster>(*roster_);
  std::vector<int> ids = next->add(bodies, names);
  require_solver(next->scene(), options_);
  become(std::move(next), [](Dynamics& dynamics, const WorldState& left) { dynamics.enter(left); });
  return ids;
}

void World::remove(int body) { remove_all({body}); }

void World::remove_all(const std::vector<int>& bodies) {
  require_changing_bodies("remove()");
  if (bodies.empty()) return;
  auto next = std::make_unique<Roster>(*roster_);
  for (const int body : bodies) {
    if (kind_of(body) != BodyKind::free)
      throw InputError("remove(): body " + std::to_string(body) +
                       " is not free: only free bodies can be removed");
    if (next->is_removed(body))
      throw InputError("remove(): body " + std::to_string(body) + " is listed twice");
    next->remove(body);
  }
  become(std::move(next), [](Dynamics& dynamics, const WorldState& left) { dynamics.enter(left); });
}

WorldState World::save() const {
  WorldState state = OnDevice(*dynamics_)->save();
  if (roster_ != nullptr) roster_->save(state);
  return state;
}

void World::restore(const WorldState& state) {
  const bool has_changes = roster_ != nullptr && roster_->has_changes();
  const bool goes_back = state.insertions_done < dynamics_->insertions_done();
  if (!has_changed_bodies(state) && !has_changes && !goes_back) {
    OnDevice(*dynamics_)->restore(state);
    return;
  }
  if (!dynamics_->bodies_may_change() || roster_ == nullptr)
    throw InputError(
        std::string("the state ") +
        (goes_back ? "is from before bodies were inserted"
                   : "has bodies that a program added or removed") +
        ": it takes a World of rigid bodies with WorldOptions::bodies_may_change, which scree run "
        "is not");
  become(std::make_unique<Roster>(roster_->restored(state)),
         [&](Dynamics& dynamics, const WorldState& left) { dynamics.restore_after(left, state); });
}

Image World::render(const PictureSettings& settings) const {
  check_picture(settings);
  return OnDevice(*dynamics_)->render(settings);
}
bool World::is_asked_to_end() const { return dynamics_->is_asked_to_end(); }
std::size_t World::memory() const { return dynamics_->memory(); }
std::size_t World::peak_memory() const { return std::max(peak_before_, dynamics_->peak_memory()); }

void follow_worlds(const Scene& scene, const WorldOptions& options, OwnBodiesSink* sink,
                   const std::function<bool()>& asks_to_end) {
#ifdef SCREE_HAS_CUDA
  const CudaDeviceScope scope(options.backend == BackendKind::cuda ? options.device : -1);
#endif
  follow(
      *options.ranks, [&] { return own_dynamics(scene, options); }, sink, asks_to_end);
}
void release_followers(Ranks& ranks) { release(ranks); }

bool backend_available(BackendKind kind, std::string* reason, int device) {
  if (kind == BackendKind::cpu) {
    if (device == 0) return true;
    if (reason != nullptr)
      *reason = "there is no device " + std::to_string(device) + "; the CPU is device 0";
    return false;
  }
#ifdef SCREE_HAS_CUDA
  return cuda_available(reason, device);
#else
  if (reason != nullptr) *reason = "this program was built without CUDA";
  return false;
#endif
}

int device_count(BackendKind kind) {
  if (kind == BackendKind::cpu) return 1;
#ifdef SCREE_HAS_CUDA
  return cuda_device_count();
#else
  return 0;
#endif
}

int threads_of(const WorldOptions& options) {
  return options.backend == BackendKind::cpu ? Cpu(options.threads).threads()
                                             : device_info(options.backend, options.device).threads;
}

DeviceInfo device_info([[maybe_unused]] BackendKind kind, [[maybe_unused]] int device) {
#ifdef SCREE_HAS_CUDA
  if (kind == BackendKind::cuda) return cuda_device_info(device);
#endif
  DeviceInfo info;
  info.name = "CPU";
  std::ifstream cpuinfo("/proc/cpuinfo");
  for (std::string line; std::getline(cpuinfo, line);) {
    const auto colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) {
      info.name = line.substr(colon + 2);
      break;
    }
  }
  info.threads = static_cast<int>(std::thread::hardware_concurrency());
  info.memory_bytes = static_cast<std::size_t>(sysconf(_SC_PHYS_PAGES)) *
                      static_cast<std::size_t>(sysconf(_SC_PAGE_SIZE));
  info.free_bytes = std::min(free_host_memory(), info.memory_bytes);
  return info;
}

}  // namespace scree
