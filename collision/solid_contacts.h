#pragma once
// Contacts with solid walls, such as boxes and meshes, of the bodies that are near one. Its memory, while detect() works:
// 240 bytes for each of these, or 32 and 36 a contact where one has more than six.

#include <algorithm>

#include "kernels/narrow_phase/solid_contacts.h"

namespace scree {

template <class B, class Real>
class SolidContacts {
 public:
  explicit SolidContacts(B& b)
      : near_(b), begin_(b), same_(b), count_(b), element_(b), way_plane_(b), lacks_room_(b, 1) {}

  /// Whether a body is near a solid wall.
  bool is_used() const { return near_count_ > 0; }

  /// Lists the bodies near solid walls; one host read.
  /// @param test   of any margins, which do not matter; its candidates are not needed
  /// @param parts  where its bodies are parts
  template <ShapeMix kMix>
  void start(B& b, const ContactTest<kMix, Real>& test, const BodyParts<Real>& parts) {
    const Index n = test.bodies.owned_count;
    Buffer<B, Index> flag(b, n);
    Buffer<B, Offset> before(b, static_cast<Offset>(n) + 1);
    for_each(b, n, FlagNearSolids<kMix, Real>{test, parts, flag.view()});
    exclusive_scan(b, Span<const Index>(flag.view()), before.view());
    near_count_ = static_cast<Index>(fetch(b, before.data() + n));
    same_.resize_discard(near_count_), count_.resize_discard(near_count_);
    begin_.release();
    has_notes_ = false;
    for_each(b, n, ListFlagged{flag.view(), before.view(), near_.resize_discard(near_count_)});
  }

  /// Finds their contacts as far as there is room, and adds the numbers of all to `count`.
  /// @param count  [piece count] contacts of each piece
  template <ShapeMix kMix>
  void count(B& b, const ContactTest<kMix, Real>& test, Span<Index> count) {
    if (!has_notes_) make_room(SolidNotes::kSlots * static_cast<Offset>(near_count_));
    find(b, test);
    for_each(b, near_count_, AddSolidContacts{notes(), test.candidates, count});
  }

  /// Finds those for which there was no room, after the host has read how many contacts there are; where a body has more
  /// than there was room for, one host read more.
  template <ShapeMix kMix>
  void complete(B& b, const ContactTest<kMix, Real>& test) {
    has_notes_ = read_note<Largest<Index>>(b).value == 0;
    if (has_notes_) return;
    exclusive_scan(b, Span<const Index>(count_.view()),
                   begin_.resize_discard(static_cast<Offset>(near_count_) + 1));
    make_room(fetch(b, begin_.data() + near_count_));
    find(b, test);
    has_notes_ = true;
  }

  /// @param begin  [piece count + 1] scan of the counts
  void write_keys(B& b, const CandidateView& candidates, Span<const Offset> begin,
                  Span<std::uint64_t> key) {
    for_each(b, near_count_, WriteSolidKeys{notes(), candidates, begin, key});
  }

  /// @param key  of all contacts
  template <ShapeMix kMix>
  void fill(B& b, const ContactTest<kMix, Real>& test, Span<const std::uint64_t> key,
            const ContactArrays<Real>& out) {
    for_each(b, static_cast<Index>(key.size),
             FillSolidContacts<kMix, Real>{test, notes(), key, out});
  }

  void release() {
    near_count_ = 0;
    near_.release(), begin_.release(), same_.release(), count_.release();
    element_.release(), way_plane_.release();
  }

 private:
  void make_room(Offset places) {
    element_.resize_discard(places), way_plane_.resize_discard(places);
    has_notes_ = false;
  }
  template <ShapeMix kMix>
  void find(B& b, const ContactTest<kMix, Real>& test) {
    reduce<Largest<Index>>(b, near_count_, FindSolidContacts<kMix, Real>{test, notes(), has_notes_},
                           StoreResult<Largest<Index>>{lacks_room_.data()});
    send_note(b, std::as_const(lacks_room_).data());
  }
  SolidNotes notes() {
    return {std::as_const(near_).view(near_count_),
            begin_.view(begin_.capacity()),
            same_.view(),
            count_.view(),
            element_.view(),
            way_plane_.view()};
  }

  Index near_count_ = 0;
  bool has_notes_ = false;  ///< of a listing of this step
  Buffer<B, Index> near_;
  Buffer<B, Offset> begin_;
  Buffer<B, SameList> same_;
  Buffer<B, Index> count_;
  Buffer<B, std::uint32_t> element_;
  Buffer<B, HoldingPlane> way_plane_;
  Buffer<B, Largest<Index>> lacks_room_;
};

}  // namespace scree
