#pragma once
// A model of dynamics that is not in the list of dynamics/: point masses in free flight. They pass
// through each other and have no orientation. tests/dynamics/point_masses_test.cpp and
// tests/cli/extra_dynamics_test.cpp show that the program knows it.

#include <array>

#include "dynamics/dynamics_card.h"
#include "dynamics/model_on.h"
#include "host/error.h"
#include "kernels/backend/backend.h"
#include "shapes/shape_card.h"

namespace scree {

inline constexpr SolverParameter kGravityFactor{
    .key = "gravity_factor",
    .description = "part of the gravity of the scene that acts [-].",
    .standard = 1,
    .low = -10,
    .high = 10};

/// A step of free flight, exact but for rounding.
template <class Real>
struct FreeFlight {
  static constexpr const char* name = "free_flight";
  Span<Vec3<double>> position;
  Span<Vec3<Real>> velocity;
  Span<Real> distance;  ///< flown so far [m]
  Span<const Real> mass;
  Vec3<double> gravity;
  double h;

  /// @return kinetic energy after the step [J], upward momentum [kg m/s]
  SCREE_HD Sums<2> operator()(Index i) const {
    const Vec3<double> v(velocity[i]);
    const Vec3<double> way = h * (v + (0.5 * h) * gravity);
    position[i] = position[i] + way;
    distance[i] += static_cast<Real>(norm(way));
    const Vec3<double> after = v + h * gravity;
    velocity[i] = Vec3<Real>(after);
    const auto m = static_cast<double>(mass[i]);
    return {{0.5 * m * norm2(after), m * after.z}};
  }
};

template <class B, class Real>
class PointMasses final : public ModelOn<B, Real> {
 public:
  PointMasses(std::unique_ptr<B> on, const Scene& scene)
      : ModelOn<B, Real>(std::move(on), scene),
        gravity_(kGravityFactor.of(scene.dynamics.parameters) * scene.gravity),
        h_(scene.stepping.time_step),
        position_(backend()),
        orientation_(backend()),
        velocity_(backend()),
        distance_(backend()),
        mass_(backend()),
        radius_(backend()),
        id_(backend()),
        sums_(backend(), 1) {
    std::vector<Vec3d> position;
    std::vector<Vec3<Real>> velocity;
    std::vector<Real> mass, radius;
    const auto add = [&](const BodyDescription& body, double r) {
      position.push_back(body.position);
      velocity.emplace_back(body.velocity);
      mass.push_back(static_cast<Real>(body.mass));
      radius.push_back(static_cast<Real>(r));
    };
    for (const BodyDescription& body : scene.bodies) add(body, body.shape.radius);
    for (const ParticleSet& set : scene.particles)
      for (std::size_t i = 0; i < set.position.size(); ++i)
        add(particle_body(set, i), set.radius[i]);
    count_ = static_cast<Index>(position.size());
    std::vector<Index> id(position.size());
    for (std::size_t i = 0; i < id.size(); ++i) id[i] = static_cast<Index>(i);
    upload(backend(), position, position_);
    upload(backend(), velocity, velocity_);
    upload(backend(), mass, mass_);
    upload(backend(), radius, radius_);
    upload(backend(), id, id_);
    fill(backend(), orientation_.resize_discard(count_), Quat<Real>{});
    fill(backend(), distance_.resize_discard(count_), Real(0));
  }

  StepReport step(BodyProblem* /*problem*/) override {
    StageClock<B> clock(backend());
    reduce<Sums<2>>(backend(), count_,
                    FreeFlight<Real>{position_.view(), velocity_.view(), distance_.view(),
                                     mass_.view(count_), gravity_, h_},
                    StoreResult<Sums<2>>{sums_.data()});
    const Sums<2> sums = fetch(backend(), sums_.data());
    this->count_step();
    StepReport report;
    report.step = this->steps_done();
    report.time = this->time();
    report.body_count = count_;
    report.kinetic_energy = sums.value[0];
    report.own = {sums.value[1], clock.lap()};
    report.ms.total = report.own[1];
    return report;
  }

  int body_count() const override { return count_; }

  BodyStates states() override {
    BodyStates states;
    states.position = download(backend(), position_.view());
    states.velocity = doubles<Vec3d>(velocity_);
    states.own = {doubles<double>(distance_)};
    return states;
  }

  void arrays_changed(Written /*what*/) override {}

 private:
  using ModelOn<B, Real>::backend;

  void save_arrays(WorldState& s) override {
    s.add("body/id", download(backend(), id_.view()));
    s.add("body/position", download(backend(), position_.view()));
    s.add("body/velocity", doubles<Vec3d>(velocity_));
    s.add("body/distance", doubles<double>(distance_));
  }

  void restore_arrays(const WorldState& s) override {
    const auto& id = s.at<std::int32_t>("body/id");
    if (id.size() != static_cast<std::size_t>(count_))
      throw_wrong_body_count(id.size(), static_cast<std::size_t>(count_));
    upload(backend(), id, id_);
    upload(backend(), s.at<Vec3d>("body/position"), position_);
    const std::vector<Vec3d>& velocity = s.at<Vec3d>("body/velocity");
    upload(backend(), std::vector<Vec3<Real>>(velocity.begin(), velocity.end()), velocity_);
    const std::vector<double>& distance = s.at<double>("body/distance");
    upload(backend(), std::vector<Real>(distance.begin(), distance.end()), distance_);
  }

  template <class D, class T>
  std::vector<D> doubles(Buffer<B, T>& buffer) {
    const std::vector<T> values = download(backend(), buffer.view());
    return std::vector<D>(values.begin(), values.end());
  }

  typename ModelOn<B, Real>::Drawn drawn() override {
    BodyView<Real> v;
    v.owned_count = v.moving_count = v.fixed_begin = v.count = count_;
    v.position = position_.view();
    v.orientation = orientation_.view();
    v.velocity = velocity_.view();
    v.id = id_.view();
    v.radius = radius_.view();
    v.shape.first = v.group.first = count_;
    v.shape.shared = -1;
    return {v};
  }

  void for_each_array(const typename ModelOn<B, Real>::VisitArray& visit) override {
    const auto numbers = [&](const void* data, DataType type, int columns) {
      const std::int64_t size = type == DataType::float64 ? 8 : 4;
      ArrayView v;
      v.data = const_cast<void*>(data);
      v.type = type;
      v.dimensions = columns > 1 ? 2 : 1;
      v.shape = {count_, columns};
      v.strides = {size * columns, size};
      return v;
    };
    visit({"position", "m", "world frame", true},
          [&] { return numbers(position_.data(), DataType::float64, 3); });
    visit({"distance", "m", "flown so far", false}, [&] {
      return numbers(distance_.data(), sizeof(Real) == 8 ? DataType::float64 : DataType::float32,
                     1);
    });
  }

  Vec3d gravity_;
  double h_;
  Index count_ = 0;
  Buffer<B, Vec3<double>> position_;
  Buffer<B, Quat<Real>> orientation_;  ///< for pictures
  Buffer<B, Vec3<Real>> velocity_;
  Buffer<B, Real> distance_, mass_, radius_;
  Buffer<B, Index> id_;
  Buffer<B, Sums<2>> sums_;
};

template <class B, class Real>
std::unique_ptr<Dynamics> make_point_masses(Scene scene, const WorldOptions& options) {
  return std::make_unique<PointMasses<B, Real>>(make_backend<B>(options), scene);
}

inline constexpr std::array kPointMassParameters{kGravityFactor};

inline constexpr std::array kPointMassReport{
    ReportColumn{"step", &StepReport::step},
    ReportColumn{"time_s", &StepReport::time},
    ReportColumn{"bodies", &StepReport::body_count},
    ReportColumn{"kinetic_energy_J", &StepReport::kinetic_energy},
    ReportColumn{"upward_momentum_kg_m_per_s", Own{0}},
    ReportColumn{"flight_ms", Own{1}},
    ReportColumn{"total_ms", &StageTimes::total}};

inline constexpr std::array kPointMassFrame{
    FrameField{"velocity", 3, &BodyStates::velocity},
    FrameField{.name = "speed", .columns = 1, .values = &BodyStates::velocity, .length = true},
    FrameField{"distance", 1, Own{0}}};

inline constexpr std::array kPointMassState{
    StateField{.name = "body/id", .type = StateField::Type::int32},
    StateField{.name = "body/position", .type = StateField::Type::vector, .rows_of = "body/id"},
    StateField{.name = "body/velocity", .type = StateField::Type::vector, .rows_of = "body/id"},
    StateField{.name = "body/distance", .type = StateField::Type::number, .rows_of = "body/id"}};

inline void check_point_masses(const Scene& scene) {
  if (!scene.insertions.empty())
    throw InputError("dynamics.type: point_masses knows no bodies that join later");
  for (const BodyDescription& body : scene.bodies)
    if (body.kind != BodyKind::free || !shape_card(body.shape.kind).is_ball)
      throw InputError("dynamics.type: point_masses knows free spheres only");
}

constexpr DynamicsCard point_masses_card() {
  return {.name = "point_masses",
          .description = "point masses in free flight, which pass through each other",
          .parameters = kPointMassParameters,
          .report = kPointMassReport,
          .frame = kPointMassFrame,
          .state = kPointMassState,
          .check = check_point_masses,
          // Position, velocity, orientation, distance, mass, radius and id.
          .bytes_per_body = [](const Scene&, const WorldOptions& options) {
            const double real = options.precision == Precision::double_precision ? 8 : 4;
            return 24 + (3 + 4 + 3) * real + 4;
          }};
}

}  // namespace scree
