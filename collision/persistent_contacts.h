#pragma once
// Contacts remembered from one step to the next, with their impulses and what
// the solver left there.

#include <algorithm>
#include <vector>

#include "kernels/backend/backend.h"
#include "kernels/bodies/permute.h"
#include "kernels/contact/contact_match.h"

namespace scree {

template <class B, class Real>
class PersistentContacts {
 public:
  explicit PersistentContacts(B& b) : key_(b), impulse_(b), mark_(b), left_(b) {}

  Index count() const { return count_; }
  int vectors() const { return vectors_; }
  Span<const std::uint64_t> keys() const { return key_.view(count_); }
  Span<const Vec3<Real>> impulses() const {
    return impulse_.view(static_cast<Offset>(count_) * vectors_);
  }
  /// [count()], or empty when none were kept.
  Span<const Index> marks() const { return mark_.view(mark_count_); }

  /// Warm start: what is remembered of contacts that were there before, zero for new ones.
  /// Bytes per contact (float, one vector): 28 read, 12 written, and a few cached reads to find it.
  /// @param vectors  impulse vectors per contact, next to each other
  /// @param impulse  [vectors * keys.size] out [N s]
  void match(B& b, Span<const std::uint64_t> keys, int vectors, Span<Vec3<Real>> impulse) const {
    // Impulses of another layout mean nothing here.
    const Index known = vectors == vectors_ ? count_ : 0;
    for_each(
        b, static_cast<Index>(keys.size),
        MatchImpulses<Real>{key_.view(known), impulse_.view(static_cast<Offset>(known) * vectors),
                            keys, vectors, impulse});
  }

  /// Remembers a step; the memory of keys and impulses passes to this object.
  /// @param key      [count] ascending
  /// @param impulse  [vectors * count] that the next step is to start from [N s]
  void keep(Buffer<B, std::uint64_t>&& key, Index count, int vectors,
            Buffer<B, Vec3<Real>>&& impulse) {
    key_ = std::move(key);
    impulse_ = std::move(impulse);
    count_ = count;
    vectors_ = vectors;
    mark_count_ = 0;
  }

  /// Marks of contacts that were there before, -1 for new ones. @param mark  [keys.size] out
  void match_marks(B& b, Span<const std::uint64_t> keys, Span<Index> mark) const {
    for_each(b, static_cast<Index>(keys.size),
             MatchMarks{key_.view(mark_count_), mark_.view(mark_count_), keys, mark});
  }
  /// Remembers the marks of the contacts of the last keep(). @param mark  [count()]
  void keep_marks(Buffer<B, Index>&& mark) {
    mark_ = std::move(mark);
    mark_count_ = count_;
  }

  /// Follows a reordering of the owned bodies: renames the bodies in the keys and sorts again. Rare,
  /// so it takes its working memory for the moment.
  /// @param new_of_old  [owned_count] new storage index of each owned body
  void remap(B& b, const ContactKeys& names, Span<const Index> new_of_old) {
    SortSpace<B> sort(b);
    Buffer<B, Index> order(b, count_);
    Buffer<B, Vec3<Real>> sorted(b, static_cast<Offset>(count_) * vectors_);
    const Span<std::uint64_t> key = key_.view(count_);
    const Span<Vec3<Real>> impulse = impulse_.view(static_cast<Offset>(count_) * vectors_);
    for_each(b, count_,
             RenameContacts<Real>{names, new_of_old, vectors_, key, impulse, order.view()});
    const auto bodies = static_cast<std::uint64_t>(std::max<Offset>(new_of_old.size, 1));
    sort_pairs(b, sort, key, order.view(), names.has_groups ? 64 : 32 + bits_for(bodies));
    for_each(b, count_, Gather<Vec3<Real>>{order.view(), impulse, sorted.view(), vectors_});
    swap(impulse_, sorted);
    if (mark_count_ == 0) return;
    Buffer<B, Index> sorted_mark(b, mark_count_);
    for_each(b, mark_count_, Gather<Index>{order.view(), marks(), sorted_mark.view()});
    swap(mark_, sorted_mark);
  }

  /// Follows ghosts that came, went or changed places: renames them, forgets contacts of those that are gone, sorts again.
  /// @param new_of_old  new place of each old ghost, -1: gone
  void rename_ghosts(B& b, const ContactKeys& names, Index owned_count,
                     const std::vector<Index>& new_of_old) {
    if (count_ == 0) return;
    Buffer<B, Index> places(b);
    upload(b, new_of_old, places);
    SortSpace<B> sort(b);
    Buffer<B, Index> order(b, count_);
    const Span<std::uint64_t> key = key_.view(count_);
    for_each(b, count_,
             RenameGhosts{names, owned_count,
                          std::as_const(places).view(static_cast<Offset>(new_of_old.size())), key,
                          order.view()});
    sort_pairs(b, sort, key, order.view(), 64);  // forgotten ones come last
    reduce<Sums<1>>(b, count_, CountKeys{key}, StoreResult<Sums<1>>{left_.resize_discard(1).data});
    const auto left = static_cast<Index>(fetch(b, std::as_const(left_).data()).value[0]);
    Buffer<B, Vec3<Real>> impulse(b, static_cast<Offset>(left) * vectors_);
    for_each(b, left, Gather<Vec3<Real>>{order.view(), impulses(), impulse.view(), vectors_});
    swap(impulse_, impulse);
    if (mark_count_ > 0) {
      Buffer<B, Index> mark(b, left);
      for_each(b, left, Gather<Index>{order.view(), marks(), mark.view()});
      swap(mark_, mark);
      mark_count_ = left;
    }
    count_ = left;
  }

  /// Forgets everything and gives the memory back.
  void forget() {
    key_.release(), impulse_.release(), mark_.release();
    count_ = mark_count_ = 0;
  }

  /// Everything remembered, for a checkpoint; double holds float exactly.
  void save(B& b, std::vector<std::uint64_t>& key, std::vector<Vec3<double>>& impulse) const {
    key = download(b, keys());
    const auto values = download(b, impulses());
    impulse = std::vector<Vec3<double>>(values.begin(), values.end());
  }
  void restore(B& b, const std::vector<std::uint64_t>& key,
               const std::vector<Vec3<double>>& impulse, int vectors) {
    const std::vector<Vec3<Real>> values(impulse.begin(), impulse.end());
    Buffer<B, std::uint64_t> keys(b);
    Buffer<B, Vec3<Real>> impulses(b);
    upload(b, key, keys);
    upload(b, values, impulses);
    keep(std::move(keys), static_cast<Index>(key.size()), vectors, std::move(impulses));
  }

 private:
  Buffer<B, std::uint64_t> key_;
  Buffer<B, Vec3<Real>> impulse_;
  Buffer<B, Index> mark_;
  Buffer<B, Sums<1>> left_;
  Index count_ = 0;
  Index mark_count_ = 0;  ///< count_, or 0 when no marks are kept
  int vectors_ = 1;
};

}  // namespace scree
