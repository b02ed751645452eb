#pragma once
// Contacts with a value of its own in every place of every field, to see which of them arrive
// where contacts are copied.

#include <vector>

#include "kernels/backend/backend.h"
#include "kernels/contact/contact_fields.h"

namespace scree::fixtures {

/// Values that no other number gives; exact in float below 1e6.
template <class T>
T distinct(int number) {
  if constexpr (requires(T x) { x.length; }) {
    using Real = decltype(T::length);
    return {static_cast<Real>(number), static_cast<Real>(number + 0.25),
            static_cast<Real>(number + 0.5)};
  } else if constexpr (requires(T x) { x.x; }) {
    using Real = decltype(T::x);
    return {static_cast<Real>(number), static_cast<Real>(number + 0.25),
            static_cast<Real>(number + 0.5)};
  } else {
    return static_cast<T>(number);
  }
}

/// Calls f with each field and its number; numbers of fields are 1000 apart.
template <class Record, class F>
void visit_numbered(Record& record, F f) {
  int number = 0;
  record.visit([&](const ContactField& field, auto& values) { f(field, number += 1000, values); },
               record);
}

template <class T>
std::vector<T> distinct_values(int first, std::size_t count) {
  std::vector<T> values;
  for (std::size_t k = 0; k < count; ++k)
    values.push_back(distinct<T>(first + static_cast<int>(k)));
  return values;
}

template <class T>
bool same(const T& a, const T& b) {
  return a == b;
}
template <class Real>
bool same(const RollingRow<Real>& a, const RollingRow<Real>& b) {
  return a.length == b.length && a.rolling == b.rolling && a.spinning == b.spinning;
}
template <class T>
bool same(const std::vector<T>& a, const std::vector<T>& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t k = 0; k < a.size(); ++k)
    if (!same(a[k], b[k])) return false;
  return true;
}

}  // namespace scree::fixtures
