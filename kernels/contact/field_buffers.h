#pragma once
// Contacts in arrays of their own: one buffer for each field of a list.

#include <algorithm>

#include "kernels/backend/backend.h"
#include "kernels/contact/contact_problem.h"

namespace scree {

/// Store: fields in backend memory.
template <class B, class Real_>
struct InBuffers {
  using Real = Real_;
  template <class T>
  using Array = Buffer<B, T>;
  using Bias = Buffer<B, Real>;
  using Varying = Buffer<B, Real>;
};

/// @tparam Fields  FoundFields or ProblemFields
template <template <class> class Fields, class B, class Real>
struct FieldBuffers : Fields<InBuffers<B, Real>> {
  explicit FieldBuffers(B& b) {
    this->visit([&]<class T>(const ContactField&, Buffer<B, T>& array) { array = Buffer<B, T>(b); },
                *this);
  }

  /// Makes room for exactly these contacts, of which the first ones are radial; old contents are
  /// lost where a size changes. Fields of other parts take no memory; the others have one value at
  /// the least, because an empty view means that a field is not stored.
  void resize_discard(const ContactParts& parts, Offset contacts, Offset radial = 0) {
    this->visit(
        [&](const ContactField& field, auto& array) {
          const Offset size = field.size(parts, contacts, radial);
          array.resize_discard(parts.*field.part ? std::max<Offset>(size, 1) : 0);
        },
        *this);
  }

  void release() {
    this->visit([](const ContactField&, auto& array) { array.release(); }, *this);
  }

  /// Views to write, empty where a field is not stored.
  Fields<InSpans<Real>> spans() {
    Fields<InSpans<Real>> views;
    this->visit([](const ContactField&, auto& array, auto& view) { view = array.view(); }, *this,
                views);
    return views;
  }
};

/// Contacts as collision detection leaves them.
template <class B, class Real>
using FoundContacts = FieldBuffers<FoundFields, B, Real>;
/// Fields of the contacts of a problem.
template <class B, class Real>
using ProblemContacts = FieldBuffers<ProblemFields, B, Real>;

/// Points a problem at the fields that the buffers hold; it keeps its others.
template <class B, class Real>
void point_to(ContactProblem<Real>& p, ProblemContacts<B, Real>& own) {
  p.visit(
      []<class T>(const ContactField&, auto& field, Buffer<B, T>& array) {
        if (array.capacity() > 0) point_to(field, Span<const T>(array.view()));
      },
      p, own);
}

}  // namespace scree
