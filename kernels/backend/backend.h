#pragma once
// What both backends provide: owning buffers, transfers, and the short closed list of parallel
// primitives (for_each, reduce, exclusive_scan, sort_pairs, fill, copy). Only cpu.h and cuda.cuh
// are written twice; everything above them is one source.
//
//   for_each(b, n, f)            f(i) for i in [0, n), any order
//   reduce<R>(b, n, f, finish)   combines the R returned by f(i) in a fixed order, then runs
//                                finish(total) once on the backend; f may also write its element
//   exclusive_scan(b, in, out)   out[i] = sum of in[0..i), out has one element more than in
//   sort_pairs(b, keys, values, bits)
//                                stable ascending radix sort of 64-bit keys with 32-bit values
//
// R is trivially copyable with a default constructor giving the identity and
// `void combine(const R&)`.

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "kernels/types.h"

namespace scree {

/// A fault of the device or its runtime. what() names the operation and, where known, the kernel.
class DeviceError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Device (or host) memory ran out. Carries the size that was asked for.
class OutOfMemory : public DeviceError {
 public:
  OutOfMemory(std::size_t bytes, const std::string& where)
      : DeviceError(where + " memory exhausted: could not allocate " +
                    std::to_string(bytes / (1024 * 1024) + 1) + " MiB") {}
};

class Ranks;  // kernels/backend/ranks.h

/// What a backend knows of the other ranks that simulate the same scene.
class InRanks {
 public:
  /// Null: there are none.
  Ranks* ranks() const { return ranks_; }
  void set_ranks(Ranks* ranks) { ranks_ = ranks; }

 private:
  Ranks* ranks_ = nullptr;
};

/// Owns `capacity` elements in the memory of backend B. Move-only; contents start uninitialized.
template <class B, class T>
class Buffer {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  Buffer() = default;  ///< holds nothing, and takes over another one only
  explicit Buffer(B& backend, Offset count = 0) : backend_(&backend) { reserve_discard(count); }
  ~Buffer() { release(); }
  Buffer(Buffer&& o) noexcept
      : backend_(o.backend_),
        data_(std::exchange(o.data_, nullptr)),
        capacity_(std::exchange(o.capacity_, 0)) {}
  Buffer& operator=(Buffer&& o) noexcept {
    if (this != &o) {
      release();
      backend_ = o.backend_;
      data_ = std::exchange(o.data_, nullptr);
      capacity_ = std::exchange(o.capacity_, 0);
    }
    return *this;
  }
  Buffer(const Buffer&) = delete;
  Buffer& operator=(const Buffer&) = delete;

  /// Makes room for `count` elements; old contents are lost when the buffer has to grow.
  void reserve_discard(Offset count) {
    if (count <= capacity_) return;
    release();
    data_ = static_cast<T*>(backend_->allocate(bytes(count)));
    capacity_ = count;
  }
  /// Makes the capacity `count`, no more; old contents are lost when it changes.
  Span<T> resize_discard(Offset count) {
    if (count != capacity_) {
      release();  // first, so that the old and the new memory are never both held
      reserve_discard(count);
    }
    return view();
  }

  /// Gives the memory back.
  void release() noexcept {
    if (data_) backend_->deallocate(data_, bytes(capacity_));
    data_ = nullptr;
    capacity_ = 0;
  }

  Offset capacity() const { return capacity_; }
  Span<T> view() { return {data_, capacity_}; }
  Span<T> view(Offset count) { return view().first(count); }
  Span<const T> view(Offset count) const { return Span<const T>{data_, capacity_}.first(count); }
  T* data() { return data_; }
  const T* data() const { return data_; }
  friend void swap(Buffer& a, Buffer& b) noexcept {
    std::swap(a.backend_, b.backend_);
    std::swap(a.data_, b.data_);
    std::swap(a.capacity_, b.capacity_);
  }

 private:
  static std::size_t bytes(Offset count) { return static_cast<std::size_t>(count) * sizeof(T); }

  B* backend_ = nullptr;
  T* data_ = nullptr;
  Offset capacity_ = 0;
};

/// Workspace of sort_pairs, specialized by each backend; owned by the caller, so repeated
/// sorts do not allocate.
template <class B>
struct SortSpace;

/// Copies between two views in the memory of the same backend.
template <class B, class T>
void copy(B& b, Span<const T> source, Span<T> destination) {
  b.copy_bytes(destination.data, source.data, static_cast<std::size_t>(source.size) * sizeof(T));
}

/// Host to backend memory.
template <class B, class T>
void upload(B& b, const T* source, Span<T> destination) {
  b.upload_bytes(destination.data, source, static_cast<std::size_t>(destination.size) * sizeof(T));
}
template <class B, class T>
void upload(B& b, const std::vector<T>& source, Buffer<B, T>& destination) {
  const auto count = static_cast<Offset>(source.size());
  if (count <= 0) return;  // compilers that see an empty buffer fear negative sizes
  destination.reserve_discard(count);
  upload(b, source.data(), destination.view(count));
}

/// Backend memory to host; complete when it returns.
template <class B, class T>
void download(B& b, Span<const T> source, T* destination) {
  b.download_bytes(destination, source.data, static_cast<std::size_t>(source.size) * sizeof(T));
}
template <class B, class T>
std::vector<std::remove_const_t<T>> download(B& b, Span<T> source) {
  std::vector<std::remove_const_t<T>> host(static_cast<std::size_t>(source.size));
  download(b, Span<const std::remove_const_t<T>>{source.data, source.size}, host.data());
  return host;
}

/// One element, read back to the host: a synchronization, never inside a solver iteration.
template <class B, class T>
T fetch(B& b, const T* element) {
  T value;
  b.download_bytes(&value, element, sizeof(T));
  return value;
}

/// Where programs on the backend write a result for the host, which take_result() reads; one at a time.
inline constexpr std::size_t kMostResultBytes = 16 * 1024;
template <class T, class B>
T* result_place(B& b) {
  static_assert(std::is_trivially_copyable_v<T> && sizeof(T) <= kMostResultBytes);
  return static_cast<T*>(b.result());
}
/// A synchronization, without the transfer that fetch() takes.
template <class T, class B>
T take_result(B& b) {
  b.synchronize();
  return *result_place<T>(b);
}

/// A note to the host: fetch() in two parts, with other work between. What send_note() brings is what the queue leaves
/// there; read_note() waits for that alone, and costs little after any other synchronization. A note replaces the one before.
inline constexpr std::size_t kMostNoteBytes = 64;
template <class B, class T>
void send_note(B& b, const T* element) {
  static_assert(std::is_trivially_copyable_v<T> && sizeof(T) <= kMostNoteBytes);
  b.send_note(element, sizeof(T));
}
template <class T, class B>
T read_note(B& b) {
  T value;
  b.read_note(&value, sizeof(T));
  return value;
}

/// Marks in the queue of a backend, and the time between them: to know what stages take without waiting for each.
/// Each backend has its own: mark(), ms(k) between the mark with number k and the next, and clear(), which begins anew.
template <class B>
class StageMarks;

/// Element program: array[i] = value.
template <class T>
struct FillElements {
  static constexpr const char* name = "fill";
  Span<T> array;
  T value;
  SCREE_HD void operator()(Index i) const { array[i] = value; }
};

template <class B, class T>
void fill(B& b, Span<T> array, T value) {
  for_each(b, static_cast<Index>(array.size), FillElements<T>{array, value});
}

/// Does nothing with a finished reduction that f's own side effects made superfluous.
struct NoFinish {
  template <class R>
  SCREE_HD void operator()(const R&) const {}
};

/// Stores a finished reduction in backend memory.
template <class R>
struct StoreResult {
  R* result;
  SCREE_HD void operator()(const R& total) const { *result = total; }
};

/// Ends a reduction over several ranks. What is to be known of this one too has a keep_own(record) beside its
/// operator()(total).
template <class R, class G>
SCREE_HD void finish_over_ranks(const G& finish, const R& own, const R& total) {
  if constexpr (requires { finish.keep_own(own); }) finish.keep_own(own);
  finish(total);
}

/// A reduction whose total goes to the host: a synchronization.
template <class R, class B, class F>
R reduce_to_host(B& b, Index n, const F& f) {
  reduce<R>(b, n, f, StoreResult<R>{result_place<R>(b)});
  return take_result<R>(b);
}

/// Sum of K doubles: the usual reduction record.
template <int K>
struct Sums {
  double value[K] = {};
  SCREE_HD void combine(const Sums& o) {
    for (int k = 0; k < K; ++k) value[k] += o.value[k];
  }
};

/// Largest of many values, at least 0: the record of a reduction.
template <class T>
struct Largest {
  T value = 0;
  SCREE_HD void combine(const Largest& o) {
    if (o.value > value) value = o.value;
  }
};

/// Bits needed to tell `count` values apart, at least 1: the length of a radix sort.
inline int bits_for(std::uint64_t count) {
  int bits = 1;
  while (bits < 64 && (count - 1) >> bits) ++bits;
  return bits;
}

}  // namespace scree
