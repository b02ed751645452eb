#include "host/problems/body_problem.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "host/problems/checks.h"

namespace scree {
namespace {

constexpr const char* per_body = "one a body";
constexpr const char* per_contact = "one a contact";

std::string text_of(const Vec3d& v) { return fmt::format("({}, {}, {})", v.x, v.y, v.z); }

template <class T, class Accept, class Show>
void require_all(const std::vector<T>& values, const std::string& name, const char* expected,
                 Accept accept, Show show) {
  for (std::size_t k = 0; k < values.size(); ++k)
    if (!accept(values[k]))
      throw InputError(
          fmt::format("{}[{}] is {}, expected {}", name, k, show(values[k]), expected));
}

void require_finite_vectors(const std::vector<Vec3d>& values, const std::string& name) {
  require_all(values, name, "finite numbers", is_finite<double>, text_of);
}

bool is_finite_sym(const Sym3<double>& m) {
  return std::isfinite(m.xx) && std::isfinite(m.yy) && std::isfinite(m.zz) && std::isfinite(m.xy) &&
         std::isfinite(m.xz) && std::isfinite(m.yz);
}

std::string text_of_sym(const Sym3<double>& m) {
  return fmt::format("({}, {}, {}, {}, {}, {})", m.xx, m.yy, m.zz, m.xy, m.xz, m.yz);
}

/// Zero, or positive definite on the axes whose diagonal entry is not zero.
bool is_inverse_inertia(const Sym3<double>& m) {
  if (!is_finite_sym(m) || m.xx < 0 || m.yy < 0 || m.zz < 0) return false;
  // Minors of order two, and the determinant, with room for rounding of near-singular ones.
  const double slack = 1e-6;
  const auto minor = [&](double p, double q, double off) {
    return off * off <= p * q * (1 + slack);
  };
  if (!minor(m.xx, m.yy, m.xy) || !minor(m.xx, m.zz, m.xz) || !minor(m.yy, m.zz, m.yz))
    return false;
  const double determinant = m.xx * (m.yy * m.zz - m.yz * m.yz) -
                             m.xy * (m.xy * m.zz - m.yz * m.xz) +
                             m.xz * (m.xy * m.yz - m.yy * m.xz);
  return determinant >= -slack * m.xx * m.yy * m.zz;
}

void check_bodies(const BodyProblem& p) {
  const std::size_t n = p.free_velocity.size();
  if (p.free_count < 1 || static_cast<std::size_t>(p.free_count) > n)
    throw InputError(
        fmt::format("free_count is {}, expected 1 to {} (the number of bodies)", p.free_count, n));
  require_size(p.body_id, n, "body/id", per_body);
  require_all(
      p.free_velocity, "body/free_velocity", "finite numbers",
      [](const Twist<double>& t) { return is_finite(t.linear) && is_finite(t.angular); },
      [](const Twist<double>& t) { return text_of(t.linear) + " " + text_of(t.angular); });

  const bool radial = p.layout == ContactLayout::radial;
  require_size(p.radial_inertia, radial ? n : 0, "body/inv_spin", "radial layout");
  require_size(p.general_inertia, radial ? 0 : n, "body/inertia", "general and rolling layout");
  for (std::size_t i = 0; i < n; ++i) {
    const bool is_free = i < static_cast<std::size_t>(p.free_count);
    const char* expected = is_free ? "finite numbers that are not negative"
                                   : "zero: bodies from free_count on do not move";
    const auto check = [&](bool fits, const char* name, const std::string& found) {
      if (!fits)
        throw InputError(fmt::format("{}[{}] is {}, expected {}", name, i, found, expected));
    };
    const auto is_inverse = [&](double x) {
      return std::isfinite(x) && x >= 0 && (is_free || !(x > 0));
    };
    if (radial) {
      const RadialInertia<double>& r = p.radial_inertia[i];
      check(is_inverse(r.inv_mass), "body/inv_mass", fmt::to_string(r.inv_mass));
      check(is_inverse(r.inv_spin), "body/inv_spin", fmt::to_string(r.inv_spin));
      continue;
    }
    const GeneralInertia<double>& g = p.general_inertia[i];
    check(is_inverse(g.inv_mass.x) && is_inverse(g.inv_mass.y) && is_inverse(g.inv_mass.z),
          "body/inv_mass", text_of(g.inv_mass));
    check(is_inverse(g.inv_inertia.trace()), "body/inv_inertia", text_of_sym(g.inv_inertia));
    expected = "a positive definite matrix on the axes that are not zero";
    check(is_inverse_inertia(g.inv_inertia), "body/inv_inertia", text_of_sym(g.inv_inertia));
    expected = "finite numbers that are not negative";
    check(std::isfinite(g.mass) && g.mass >= 0, "body/mass", fmt::to_string(g.mass));
    expected = "finite numbers";
    check(is_finite_sym(g.inertia), "body/inertia", text_of_sym(g.inertia));
  }
}

void check_pairs(const BodyProblem& p) {
  for (std::size_t c = 0; c < p.body_a.size(); ++c) {
    const int a = p.body_a[c], b = p.body_b[c];
    if (a < 0 || a >= p.free_count)
      throw InputError(fmt::format("contact/body_a[{}] is {}, expected 0 to {} (a free body)", c, a,
                                   p.free_count - 1));
    if (b <= a || b >= p.body_count())
      throw InputError(fmt::format("contact/body_b[{}] is {}, expected {} to {} (a body behind {})",
                                   c, b, a + 1, p.body_count() - 1, "body_a"));
    if (c > 0 && a < p.body_a[c - 1])
      throw InputError(fmt::format("contact/body_a[{}] is {}, expected at least {} (ascending)", c,
                                   a, p.body_a[c - 1]));
  }
}

const char* reason_of_size(const ContactField& field) {
  if (field.part == &ContactParts::arms) return "one a contact, not in the radial layout";
  if (field.part == &ContactParts::rolling) return "one a contact, rolling layout only";
  return per_contact;
}

void require_values(const std::vector<int>&, const std::string&, FieldValues) {}  // check_pairs()

void require_values(const std::vector<double>& values, const std::string& name, FieldValues rule) {
  rule == FieldValues::not_negative ? require_not_negative(values, name)
                                    : require_finite(values, name);
}

void require_values(const std::vector<Vec3d>& values, const std::string& name, FieldValues rule) {
  if (rule != FieldValues::unit) return require_finite_vectors(values, name);
  require_all(
      values, name, "a unit vector", [](const Vec3d& v) { return std::abs(norm(v) - 1) < 1e-4; },
      text_of);
}

void require_values(const std::vector<RollingRow<double>>& values, const std::string& name,
                    FieldValues) {
  require_all(
      values, name, "a positive length and coefficients that are not negative",
      [](const RollingRow<double>& r) {
        return std::isfinite(r.length) && r.length > 0 && std::isfinite(r.rolling) &&
               r.rolling >= 0 && std::isfinite(r.spinning) && r.spinning >= 0;
      },
      [](const RollingRow<double>& r) {
        return fmt::format("({}, {}, {})", r.length, r.rolling, r.spinning);
      });
}

void check_contacts(const BodyProblem& p) {
  const std::size_t n = p.body_a.size();
  if (n == 0) throw InputError("contact/body_a is empty: the problem has no contacts");
  const ContactParts parts = stored_parts(p.layout);
  const auto path = [](const ContactField& field) { return std::string("contact/") + field.name; };
  p.visit(
      [&](const ContactField& field, const auto& values) {
        const bool is_stored = field.is_optional ? !values.empty() : parts.*field.part;
        require_size(values, is_stored ? n : 0, path(field), reason_of_size(field));
      },
      p);
  check_pairs(p);
  p.visit([&](const ContactField& field,
              const auto& values) { require_values(values, path(field), field.values); },
          p);
  require_size(p.impulse, n * static_cast<std::size_t>(vectors_per_contact(p.layout)),
               "warm_start/impulse", "vectors of all contacts");
  require_finite_vectors(p.impulse, "warm_start/impulse");
}

void check_bilateral(const BodyProblem& p) {
  if (!p.bilateral.empty() && p.layout == ContactLayout::radial)
    throw InputError(
        "bilateral/body_a is there and the layout is radial, expected general or rolling");
  for (std::size_t k = 0; k < p.bilateral.size(); ++k) {
    const BilateralRow& row = p.bilateral[k];
    const auto check = [&](bool fits, const char* name, const std::string& found,
                           const std::string& expected) {
      if (!fits)
        throw InputError(fmt::format("{}[{}] is {}, expected {}", name, k, found, expected));
    };
    check(row.body_a >= 0 && row.body_a < p.free_count, "bilateral/body_a",
          fmt::to_string(row.body_a), fmt::format("0 to {} (a free body)", p.free_count - 1));
    check(row.body_b > row.body_a && row.body_b < p.body_count(), "bilateral/body_b",
          fmt::to_string(row.body_b),
          fmt::format("{} to {} (a body behind body_a)", row.body_a + 1, p.body_count() - 1));
    const std::pair<const char*, Vec3d> vectors[] = {{"bilateral/arm_a", row.arm_a},
                                                     {"bilateral/arm_b", row.arm_b},
                                                     {"bilateral/force", row.force},
                                                     {"bilateral/moment", row.moment}};
    for (const auto& [name, v] : vectors) check(is_finite(v), name, text_of(v), "finite numbers");
    check(norm(row.force) > 0 || norm(row.moment) > 0, "bilateral/force", text_of(row.force),
          "a force or a moment that is not zero");
    check(std::isfinite(row.bias), "bilateral/bias", fmt::to_string(row.bias), "a finite number");
    check(std::isfinite(row.impulse), "warm_start/bilateral", fmt::to_string(row.impulse),
          "a finite number");
  }
}

}  // namespace

void validate(const BodyProblem& p) {
  const ProblemSource& s = p.source;
  if (!(std::isfinite(s.time_step) && s.time_step > 0))
    throw InputError(fmt::format("time_step is {}, expected a positive number [s]", s.time_step));
  if (!std::isfinite(s.time))
    throw InputError(fmt::format("time is {}, expected a finite number [s]", s.time));
  if (!(std::isfinite(s.reference_speed) && s.reference_speed >= 0))
    throw InputError(
        fmt::format("reference_speed is {}, expected 0 or more [m/s]", s.reference_speed));
  check_bodies(p);
  check_contacts(p);
  check_bilateral(p);
}

const char* to_string(ContactLayout layout) {
  switch (layout) {
    case ContactLayout::radial:
      return "radial";
    case ContactLayout::general:
      return "general";
    case ContactLayout::mixed:
      return "mixed";
    case ContactLayout::jointed:
      return "jointed";
    case ContactLayout::rolling:
      break;
  }
  return "rolling";
}

}  // namespace scree
