#pragma once
// The arrays that a World hands out: what each is called, means and points at, said once.

#include <type_traits>

#include "collision/contact_detector.h"
#include "dynamics/rigid/body_loads.h"
#include "dynamics/rigid/body_store.h"
#include "host/arrays.h"

namespace scree {

/// Numbers of one element of an array.
template <class T>
struct ArrayElement {
  using Number = T;
  static constexpr int kCount = 1;
};
template <class Real>
struct ArrayElement<Vec3<Real>> {
  using Number = Real;
  static constexpr int kCount = 3;
};
template <class Real>
struct ArrayElement<Quat<Real>> {
  using Number = Real;
  static constexpr int kCount = 4;
};

template <class Number>
constexpr DataType data_type_of() {
  if constexpr (std::is_same_v<Number, double>) {
    return DataType::float64;
  } else if constexpr (std::is_same_v<Number, float>) {
    return DataType::float32;
  } else if constexpr (std::is_same_v<Number, std::int32_t>) {
    return DataType::int32;
  } else {
    static_assert(std::is_same_v<Number, std::uint8_t>);
    return DataType::uint8;
  }
}

/// A view of rows of type T. @param row_stride  from one to the next [bytes]
template <class T>
ArrayView array_of(const T* data, Offset rows, std::size_t row_stride = sizeof(T)) {
  using Element = ArrayElement<T>;
  using Number = typename Element::Number;
  static_assert(sizeof(T) == sizeof(Number) * Element::kCount);
  ArrayView v;
  v.data = const_cast<T*>(data);
  v.type = data_type_of<Number>();
  v.dimensions = Element::kCount > 1 ? 2 : 1;
  v.shape = {rows, Element::kCount};
  v.strides = {static_cast<std::int64_t>(row_stride), sizeof(Number)};
  return v;
}

/// Passes over the arrays of a simulation: calls visit(info, make), where make() gives the view.
/// @param impulses  of the contacts of the last step; empty when the contacts are no such
template <class B, class Real, class Visit>
void for_each_named_array(B& b, BodyStore<B, Real>& store, BodyLoads<B, Real>& loads,
                          const ContactView<Real>& contacts, Span<const Vec3<Real>> impulses,
                          int vectors_per_contact, Visit visit) {
  const BodyView<Real> bodies = store.view();
  const Index n = bodies.owned_count;
  const auto state = [&](const char* name, const char* unit, const char* meaning, auto span) {
    visit(ArrayInfo{name, unit, meaning, true}, [&] { return array_of(span.data, n); });
  };
  state("position", "m", "center of mass, world frame", bodies.position);
  state("orientation", "1", "unit quaternion w, x, y, z, body frame to world frame",
        bodies.orientation);
  state("velocity", "m/s", "of the center of mass, world frame", bodies.velocity);
  state("angular_velocity", "rad/s", "world frame", bodies.angular_velocity);
  visit(ArrayInfo{"id", "1", "index of the body in the scene", false},
        [&] { return array_of(bodies.id.data, n); });
  visit(ArrayInfo{"row_id", "1",
                  "id of every row: free bodies, then -1 where none is yet, then fixed and "
                  "kinematic ones",
                  false},
        [&] { return array_of(bodies.id.data, bodies.count); });
  store.for_each_constant(
      [&](const char* name, const char* unit, const char* meaning, auto& constants) {
        visit(ArrayInfo{name, unit, meaning, false}, [&] {
          const auto of_free = constants.of_free_bodies(b);
          return array_of(of_free.data, n, of_free.is_shared ? 0 : sizeof(*of_free.data));
        });
      });
  if (!bodies.inertia.empty()) {
    visit(ArrayInfo{"inertia", "kg m^2", "principal moments, body frame", false},
          [&] { return array_of(bodies.inertia.data, n); });
  }
  visit(ArrayInfo{"force", "N", "by id: through the center of mass, world frame", true}, [&] {
    loads.use(b);
    return array_of(loads.force().data, loads.force().size);
  });
  visit(ArrayInfo{"torque", "N m", "by id: about the center of mass, world frame", true}, [&] {
    loads.use(b);
    return array_of(loads.torque().data, loads.torque().size);
  });
  const auto contact = [&](const char* name, const char* unit, const char* meaning, auto span,
                           int vectors = 1) {
    visit(ArrayInfo{name, unit, meaning, false}, [&] {
      const Offset rows = impulses.empty() ? 0 : contacts.count;
      return array_of(rows > 0 ? span.data : nullptr, rows,
                      static_cast<std::size_t>(vectors) * sizeof(*span.data));
    });
  };
  contact("contact_body_a", "1", "row of body A, see row_id", contacts.body_a);
  contact("contact_body_b", "1", "row of body B, see row_id", contacts.body_b);
  contact("contact_normal", "1", "unit, from A to B, world frame", contacts.normal);
  contact("contact_gap", "m", "at the start of the step", contacts.gap);
  contact("contact_impulse", "N s", "acting on B, world frame, without those of impacts", impulses,
          vectors_per_contact);
}

}  // namespace scree
