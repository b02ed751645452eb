#include "dynamics/ranks/leading.h"

#include <algorithm>
#include <new>
#include <utility>

#include "dynamics/ranks/common_error.h"
#include "dynamics/ranks/shareable.h"
#include "dynamics/ranks/state_bytes.h"

namespace scree {
namespace {

/// What rank 0 asks the others to do.
enum class Call : std::int32_t {
  stop,
  make,
  end,
  step,
  states,
  begin_own_bodies,
  give_own_bodies,
  contacts,
  overlaps,
  joints,
  track_forces,
  take_forces,
  force_on_body,
  force_on_group,
  set_gravity,
  set_velocity,
  save,
  restore,
  render
};

/// A call with the numbers that it takes.
struct Order {
  Call call = Call::stop;
  std::int32_t number = 0;
  Vec3d first, second;
};

/// Rank 0 says, the others hear. Their `number` is not 0 where they were asked to end.
std::vector<Order> tell(Ranks& ranks, const Order& order) { return gather(ranks, order); }

/// Calls `work`, and ends all ranks when it fails on this one alone.
/// @param takes_input  input that is refused is refused everywhere; else a rank has met it alone
template <class F>
auto together(Ranks& ranks, bool takes_input, F&& work) {
  std::string fault;
  try {
    return work();
  } catch (const CommonError&) {
    throw;
  } catch (const InputError& error) {
    if (takes_input) throw;
    fault = error.what();
  } catch (const std::bad_alloc&) {
    fault = "host memory exhausted";
  } catch (const std::exception& error) {
    fault = error.what();
  }
  ranks.abort(fault, 1);
  throw CommonError(fault);  // not reached, which compilers do not see
}

/// Makes a simulation on every rank, or on none. @throws what failed
std::unique_ptr<Dynamics> make_together(Ranks& ranks, const MakeDynamics& make) {
  std::unique_ptr<Dynamics> made;
  std::string fault;
  bool is_input = false;
  try {
    made = make();
  } catch (const InputError& error) {
    fault = error.what();
    is_input = true;
  } catch (const std::bad_alloc&) {
    fault = "host memory exhausted";
  } catch (const std::exception& error) {
    fault = error.what();
  }
  if (!any(ranks, !fault.empty())) return made;
  made.reset();
  const std::vector<std::string> faults = gather_texts(ranks, fault);
  const bool all_alike = std::equal(faults.begin() + 1, faults.end(), faults.begin());
  const bool is_bad_input = any(ranks, is_input);
  for (std::size_t r = 0; r < faults.size(); ++r) {
    if (faults[r].empty()) continue;
    std::string text = faults[r];
    if (!all_alike) text.insert(0, "rank " + std::to_string(r) + ": ");
    if (is_bad_input) throw InputError(text);
    throw CommonError(text);
  }
  throw std::logic_error("a rank failed without a reason");
}

/// Every rank is here, rank 0 maybe with an error on its way.
void end_with_others(Ranks& ranks, std::unique_ptr<Dynamics>& own) {
  ranks.set_ends_together(true);
  own.reset();
  ranks.set_ends_together(false);
}

class LeadingDynamics final : public Dynamics {
  // First, because the type that it returns follows from what it calls.
  template <class F>
  auto led(const Order& order, F&& work) {
    const std::vector<Order> all = tell(*ranks_, order);
    is_asked_to_end_ =
        is_asked_to_end_ ||
        std::any_of(all.begin() + 1, all.end(), [](const Order& o) { return o.number != 0; });
    return together(*ranks_, order.call != Call::step, work);
  }
  template <class F>
  auto led(Call call, F&& work) {
    return led(Order{call, 0, {}, {}}, work);
  }

 public:
  LeadingDynamics(std::shared_ptr<Ranks> ranks, std::unique_ptr<Dynamics> own)
      : ranks_(std::move(ranks)), own_(std::move(own)) {}
  ~LeadingDynamics() override {
    try {
      tell(*ranks_, {Call::end, 0, {}, {}});
      end_with_others(*ranks_, own_);
    } catch (const std::exception&) {  // the others are gone
    }
  }

  StepReport step(BodyProblem* problem) override {
    if (problem != nullptr) throw_not_over_ranks("step(BodyProblem&)");
    return led(Call::step, [&] { return own_->step(nullptr); });
  }
  std::int64_t steps_done() const override { return own_->steps_done(); }
  double time() const override { return own_->time(); }
  int body_count() const override { return own_->body_count(); }
  BodyStates states() override {
    return led(Call::states, [&] { return own_->states(); });
  }
  void begin_own_bodies(OwnBodiesSink& sink, std::optional<double> resumed_time) override {
    const Order order{
        Call::begin_own_bodies, resumed_time ? 1 : 0, Vec3d{resumed_time.value_or(0), 0, 0}, {}};
    led(order, [&] { own_->begin_own_bodies(sink, resumed_time); });
  }
  std::vector<std::int64_t> give_own_bodies(OwnBodiesSink& sink) override {
    return led(Call::give_own_bodies, [&] { return own_->give_own_bodies(sink); });
  }
  const BodyConstants& constants() const override { return own_->constants(); }
  std::vector<ContactRecord> contacts() override {
    return led(Call::contacts, [&] { return own_->contacts(); });
  }
  std::vector<ContactRecord> overlaps() override {
    return led(Call::overlaps, [&] { return own_->overlaps(); });
  }
  std::vector<JointRecord> joints() override {
    return led(Call::joints, [&] { return own_->joints(); });
  }
  void track_forces() override {
    led(Call::track_forces, [&] { own_->track_forces(); });
  }
  MeanForces take_forces() override {
    return led(Call::take_forces, [&] { return own_->take_forces(); });
  }
  ForceRecord force_on_body(int body) override {
    return led({Call::force_on_body, body, {}, {}}, [&] { return own_->force_on_body(body); });
  }
  ForceRecord force_on_group(int group) override {
    return led({Call::force_on_group, group, {}, {}}, [&] { return own_->force_on_group(group); });
  }
  void set_gravity(const Vec3d& gravity) override {
    led({Call::set_gravity, 0, gravity, {}}, [&] { own_->set_gravity(gravity); });
  }
  void set_velocity(int body, const Vec3d& velocity, const Vec3d& angular_velocity) override {
    led({Call::set_velocity, body, velocity, angular_velocity},
        [&] { own_->set_velocity(body, velocity, angular_velocity); });
  }
  void set_motion(int, const Motion&) override { throw_not_over_ranks("set_motion()"); }
  void apply_force(int, const Vec3d&, const Vec3d&) override {
    throw_not_over_ranks("apply_force()");
  }
  bool has_body(int id) const override { return own_->has_body(id); }
  int id_end() const override { return own_->id_end(); }

  std::vector<ArrayInfo> arrays() override { throw_not_over_ranks("arrays()"); }
  ArrayView array(const std::string&) override { throw_not_over_ranks("array()"); }
  void arrays_changed(Written) override { throw_not_over_ranks("arrays_changed()"); }

  WorldState save() override {
    return led(Call::save, [&] { return own_->save(); });
  }
  void restore(const WorldState& state) override {
    led(Call::restore, [&] {
      broadcast(*ranks_, to_bytes(state), 0);
      own_->restore(state);
    });
  }
  Image render(const PictureSettings& settings) override {
    return led(Call::render, [&] { return own_->render(settings); });
  }
  bool is_asked_to_end() const override { return is_asked_to_end_; }
  int cuda_device() const override { return own_->cuda_device(); }
  std::size_t memory() const override { return own_->memory(); }
  std::size_t peak_memory() const override { return own_->peak_memory(); }

 private:
  std::shared_ptr<Ranks> ranks_;
  std::unique_ptr<Dynamics> own_;
  bool is_asked_to_end_ = false;
};

/// What rank 0 asked for, on the simulation of this rank.
void obey(Ranks& ranks, const Order& order, Dynamics& own, OwnBodiesSink* sink) {
  const auto given = [&]() -> OwnBodiesSink& {
    if (sink != nullptr) return *sink;
    throw std::logic_error("follow_worlds() was given no sink for the bodies of its rank");
  };
  switch (order.call) {
    case Call::step:
      own.step(nullptr);
      return;
    case Call::states:
      own.states();
      return;
    case Call::begin_own_bodies:
      own.begin_own_bodies(given(),
                           order.number != 0 ? std::optional<double>(order.first.x) : std::nullopt);
      return;
    case Call::give_own_bodies:
      own.give_own_bodies(given());
      return;
    case Call::contacts:
      own.contacts();
      return;
    case Call::overlaps:
      own.overlaps();
      return;
    case Call::joints:
      own.joints();
      return;
    case Call::track_forces:
      own.track_forces();
      return;
    case Call::take_forces:
      own.take_forces();
      return;
    case Call::force_on_body:
      own.force_on_body(order.number);
      return;
    case Call::force_on_group:
      own.force_on_group(order.number);
      return;
    case Call::set_gravity:
      own.set_gravity(order.first);
      return;
    case Call::set_velocity:
      own.set_velocity(order.number, order.first, order.second);
      return;
    case Call::save:
      own.save();
      return;
    case Call::restore:
      own.restore(state_from(broadcast(ranks, {}, 0)));
      return;
    case Call::render:
      own.render({});
      return;
    case Call::stop:
    case Call::make:
    case Call::end:
      break;
  }
  throw std::logic_error("rank 0 asked for what no rank can do");
}

}  // namespace

std::unique_ptr<Dynamics> lead(std::shared_ptr<Ranks> ranks, const MakeDynamics& make) {
  tell(*ranks, {Call::make, 0, {}, {}});
  std::unique_ptr<Dynamics> own = make_together(*ranks, make);
  return std::make_unique<LeadingDynamics>(std::move(ranks), std::move(own));
}

void follow(Ranks& ranks, const MakeDynamics& make, OwnBodiesSink* sink, const AsksToEnd& asks) {
  std::unique_ptr<Dynamics> own;
  for (;;) {
    const int wish = asks && asks() ? 1 : 0;
    const Order order = tell(ranks, {Call::stop, wish, {}, {}})[0];
    if (order.call == Call::stop) return;
    try {
      if (order.call == Call::make) {
        if (own != nullptr) throw std::logic_error("rank 0 leads one World at a time");
        own = make_together(ranks, make);
      } else if (order.call == Call::end) {
        end_with_others(ranks, own);
      } else if (own != nullptr) {
        together(ranks, order.call != Call::step, [&] { obey(ranks, order, *own, sink); });
      }
    } catch (const CommonError&) {  // rank 0 tells of it
    } catch (const InputError&) {
    }
  }
}

void release(Ranks& ranks) { tell(ranks, {Call::stop, 0, {}, {}}); }

}  // namespace scree
