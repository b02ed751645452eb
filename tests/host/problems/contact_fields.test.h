// Every field of a contact arrives wherever contacts are copied: what a new field would need beside
// its line in the list is a fault here.
#include <vector>

#include "collision/pair_filter.h"
#include "host/problems/download_problem.h"
#include "host/problems/upload_problem.h"
#include "kernels/solve/gauss_seidel_pass.h"
#include "tests/backend_fixture.h"
#include "tests/distinct_fields.h"
#include "tests/stored_problem_samples.h"

namespace scree {
namespace {

using fixtures::distinct_values;
using fixtures::same;
using fixtures::visit_numbered;

constexpr ContactLayout kLayouts[] = {ContactLayout::radial, ContactLayout::general,
                                      ContactLayout::rolling};

template <class Real>
class ContactFieldsTest : public BackendTest<Real> {
 protected:
  /// A problem with all fields that its layout may have; bodies are those of a random one.
  static BodyProblem full_problem(ContactLayout layout) {
    BodyProblem p = fixtures::random_body_problem({.layout = layout});
    const std::size_t n = p.body_a.size();
    const ContactParts parts = stored_parts(layout);
    visit_numbered(p, [&]<class T>(const ContactField& field, int number, std::vector<T>& values) {
      const bool may_be =
          parts.*field.part || (field.is_optional && layout != ContactLayout::radial);
      if (!std::is_integral_v<T>) values = distinct_values<T>(number, may_be ? n : 0);
    });
    return p;
  }

  /// What a backend with this Real leaves of a problem.
  static BodyProblem rounded(BodyProblem p) {
    for (Vec3d& g : p.impulse) g = Vec3d(Vec3<Real>(g));
    return p;
  }

  static void expect_same_fields(const BodyProblem& found, const BodyProblem& expected) {
    found.visit([&](const ContactField& field, const auto& a,
                    const auto& b) { EXPECT_TRUE(same(a, b)) << field.name; },
                found, expected);
  }

  /// Fills buffers for these contacts; ids stay below `id_count`.
  template <class Buffers>
  void fill_distinct(Buffers& buffers) {
    visit_numbered(buffers, [&]<class T>(const ContactField&, int number,
                                         Buffer<TestBackend, T>& array) {
      const auto values = distinct_values<T>(number, static_cast<std::size_t>(array.capacity()));
      upload(this->backend(), values, array);
    });
  }
};
TYPED_TEST_SUITE(ContactFieldsTest, Reals);

TYPED_TEST(ContactFieldsTest, SurviveUploadAndDownload) {
  TestBackend& b = this->backend();
  for (const ContactLayout layout : kLayouts) {
    const BodyProblem stored = this->full_problem(layout);
    UploadedProblem<TestBackend, TypeParam> uploaded(b, stored);
    const BodyProblem back = download_problem<TestBackend, TypeParam>(
        b, uploaded.problem(), uploaded.impulses(), stored.body_id);
    this->expect_same_fields(back, stored);
    EXPECT_TRUE(same(back.impulse, this->rounded(stored).impulse));
  }
}

TYPED_TEST(ContactFieldsTest, SurviveReordering) {
  using Real = TypeParam;
  TestBackend& b = this->backend();
  for (const ContactLayout layout : kLayouts) {
    const BodyProblem stored = this->full_problem(layout);
    UploadedProblem<TestBackend, Real> uploaded(b, stored);
    const Index n = stored.contact_count();
    std::vector<Index> order(static_cast<std::size_t>(n));
    for (Index k = 0; k < n; ++k) order[static_cast<std::size_t>(k)] = (7 * k + 3) % n;
    Buffer<TestBackend, Index> order_there(b);
    upload(b, order, order_there);

    ContactProblem<Real> p = uploaded.problem();
    ProblemContacts<TestBackend, Real> contacts(b);
    contacts.resize_discard(parts_of(p), n);
    Buffer<TestBackend, ContactMetric<Real>> metric(b, n);
    with_rows_of_one_group<Real>(layout, [&](auto rows) {
      for_each(b, n,
               GatherContacts<decltype(rows), Real>{p, order_there.view(), contacts.spans(),
                                                    metric.view()});
    });
    p.visit([](const ContactField&, auto& field) { field = {}; }, p);  // only what was copied
    point_to(p, contacts);
    const BodyProblem found =
        download_problem<TestBackend, Real>(b, p, uploaded.impulses(), stored.body_id);

    BodyProblem expected;
    expected.visit(
        [&](const ContactField&, const auto& from, auto& to) {
          for (const Index c : order)
            if (!from.empty()) to.push_back(from[static_cast<std::size_t>(c)]);
        },
        stored, expected);
    this->expect_same_fields(found, expected);
  }
}

/// The general problem that stands for one of two groups has all fields of both.
TYPED_TEST(ContactFieldsTest, SurviveExpansion) {
  using Real = TypeParam;
  TestBackend& b = this->backend();
  fixtures::ProblemBuffers<TestBackend, Real> random(
      b, fixtures::random_problem({.layout = ContactLayout::mixed, .contact_count = 40}));
  ContactProblem<Real> mixed = random.problem();
  ASSERT_GT(mixed.radial_count, 0);
  ASSERT_LT(mixed.radial_count, mixed.contact_count);
  ContactParts parts(ContactLayout::mixed);
  parts.pair = false;
  parts.bias = parts.friction = parts.adhesion = parts.drift = true;
  ProblemContacts<TestBackend, Real> contacts(b);
  contacts.resize_discard(parts, mixed.contact_count, mixed.radial_count);
  this->fill_distinct(contacts);
  point_to(mixed, contacts);

  ExpandedProblem<TestBackend, Real> expanded(b, mixed);
  std::vector<std::size_t> source;  // of each contact of the expanded problem
  for (Index k = 0; k < mixed.contact_count; ++k)
    source.push_back(static_cast<std::size_t>(expanded.mixed_contact(b, k)));
  const auto radial = static_cast<std::size_t>(mixed.radial_count);
  const std::vector<Vec3<Real>> normal = download(b, mixed.normal);
  mixed.visit(
      [&](const ContactField& field, const auto& before, const auto& after) {
        if (stored_values(before).empty()) {
          EXPECT_TRUE(stored_values(after).empty()) << field.name;
          return;
        }
        const auto from = download(b, stored_values(before));
        const auto to = download(b, stored_values(after));
        ASSERT_EQ(to.size(), source.size()) << field.name;
        for (std::size_t k = 0; k < to.size(); ++k) {
          const std::size_t c = source[k];
          if (field.count != FieldCount::general) {
            EXPECT_TRUE(same(to[k], from[c])) << field.name << "[" << k << "]";
          } else if (c >= radial) {
            EXPECT_TRUE(same(to[k], from[c - radial])) << field.name << "[" << k << "]";
          } else if constexpr (std::is_same_v<std::decay_t<decltype(to[k])>, Vec3<Real>>) {
            // Arms of a sphere whose length is its radius; it has nothing else of a general contact.
            const std::string name = field.name;
            const Vec3<Real> n = normal[c];
            const Vec3<Real> expected = name == "arm_a" ? n : name == "arm_b" ? -n : Vec3<Real>{};
            EXPECT_TRUE(same(to[k], expected)) << field.name << "[" << k << "]";
          }
        }
      },
      mixed, expanded.problem());
}

TYPED_TEST(ContactFieldsTest, SurviveTakingContactsOut) {
  using Real = TypeParam;
  TestBackend& b = this->backend();
  const Index n = 33;
  FoundContacts<TestBackend, Real> found(b);
  found.resize_discard(ContactParts(ContactLayout::general), n);
  this->fill_distinct(found);
  std::vector<Index> body_a, body_b, id;
  for (Index c = 0; c < n; ++c) body_a.push_back(c), body_b.push_back(c + 1);
  for (Index i = 0; i <= n; ++i) id.push_back(i);
  Buffer<TestBackend, Index> ids(b);
  upload(b, id, ids);
  upload(b, body_a, found.body_a);
  upload(b, body_b, found.body_b);

  const PairFilter<TestBackend> filter(b, {{5, 4}, {20, 21}});
  ASSERT_EQ(filter.apply(b, ids.view(), n, found), n - 2);
  visit_numbered(found, [&]<class T>(const ContactField& field, int number,
                                     Buffer<TestBackend, T>& array) {
    const std::vector<T> left = download(b, array.view(n - 2));
    std::vector<T> expected;
    for (Index c = 0; c < n; ++c) {
      const bool is_id = field.name == std::string("body_a") || field.name == std::string("body_b");
      const int value = is_id ? (field.name == std::string("body_a") ? c : c + 1) : number + c;
      if (c != 4 && c != 20) expected.push_back(fixtures::distinct<T>(value));
    }
    EXPECT_TRUE(same(left, expected)) << field.name;
  });
}

/// What the memory forecast counts is what arrays take of the backend's memory.
TYPED_TEST(ContactFieldsTest, TakeTheMemoryThatIsForecast) {
  using Real = TypeParam;
  TestBackend& b = this->backend();
  const Index n = 64;
  ContactParts parts;
  for (ContactPart part : {&ContactParts::bias, &ContactParts::friction, &ContactParts::adhesion,
                           &ContactParts::arms, &ContactParts::rolling, &ContactParts::drift}) {
    parts.*part = true;
    const std::size_t before = b.allocated();
    FoundContacts<TestBackend, Real> found(b);
    found.resize_discard(parts, n);
    const std::size_t between = b.allocated();
    EXPECT_EQ(between - before,
              static_cast<std::size_t>(n * bytes_per_contact<FoundFields, Real>(parts)));
    ProblemContacts<TestBackend, Real> contacts(b);
    contacts.resize_discard(parts, n);
    EXPECT_EQ(b.allocated() - between,
              static_cast<std::size_t>(n * bytes_per_contact<ProblemFields, Real>(parts)));
  }
}

}  // namespace
}  // namespace scree
