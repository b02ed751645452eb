#pragma once
// The CUDA backend: one device, one stream. The device must be the current one of the thread that
// works with it: CudaDeviceScope (host/engine/cuda_device.h) sees to that. Element programs run as
// grid-stride kernels; reductions combine in a fixed order, so the same input gives the same bits on
// every run.

#include <cuda_runtime.h>

#include <algorithm>
#include <stdexcept>
#include <unordered_map>

#include "kernels/backend/backend.h"

namespace scree {

inline void check_cuda(cudaError_t error, const char* what) {
  if (error != cudaSuccess) {
    throw DeviceError(std::string("CUDA: ") + cudaGetErrorString(error) + " (" + what + ")");
  }
}

class PeerMeetings;

class Cuda : public InRanks {
 public:
  static constexpr bool kIsDevice = true;
  static constexpr const char* kName = "cuda";
  static constexpr int kBlock = 256;
  /// Most blocks of a reduction.
  static constexpr int kReduceBlocks = 4096;
  static constexpr std::size_t kMaxReduceRecord = 128;

  /// Stands for the device that is the current one of the thread.
  static constexpr int kCurrent = -1;

  /// @param device  stays the current one of the thread
  explicit Cuda(int device = kCurrent);
  ~Cuda();
  Cuda(const Cuda&) = delete;
  Cuda& operator=(const Cuda&) = delete;

  int device() const { return device_; }
  cudaStream_t stream() const { return stream_; }
  int threads() const { return 0; }
  void synchronize() { check_cuda(cudaStreamSynchronize(stream_), "synchronize"); }

  void* allocate(std::size_t bytes);
  void deallocate(void* p, std::size_t bytes) noexcept;
  std::size_t allocated() const { return allocated_; }
  std::size_t peak() const { return peak_; }

  void copy_bytes(void* destination, const void* source, std::size_t bytes);
  void upload_bytes(void* destination, const void* source, std::size_t bytes);
  void download_bytes(void* destination, const void* source, std::size_t bytes);

  void send_note(const void* source, std::size_t bytes);
  void read_note(void* destination, std::size_t bytes);

  /// Page-locked host memory that kernels may write into: for small results, read when the stream has been waited for.
  /// Void after the next download.
  void* result() { return result_; }

  /// Temporary storage of a scan; grows, and is valid until the next call.
  void* scan_space(std::size_t bytes);

  /// Partial results of a reduction, kReduceBlocks records; and its ticket counter,
  /// zero between calls.
  void* partials() { return partials_; }
  unsigned* ticket() { return ticket_; }

  /// How this GPU meets those of other ranks; null: by their hosts.
  PeerMeetings* peers() const { return peers_; }
  /// @throws std::logic_error when there are others: one window at a time, whose words have the numbers of its meetings
  void set_peers(PeerMeetings* peers) {
    if (peers != nullptr && peers_ != nullptr) throw std::logic_error("two windows to peers");
    peers_ = peers;
  }

  /// Blocks that the device runs at a time, at most kReduceBlocks.
  /// @param shared_bytes  dynamic shared memory of a block
  /// @param threads       of a block
  unsigned resident_blocks(const void* kernel, const char* name, std::size_t shared_bytes = 0,
                           int threads = kBlock) const {
    int per_processor = 0, processors = 0;
    check_cuda(cudaOccupancyMaxActiveBlocksPerMultiprocessor(&per_processor, kernel, threads,
                                                             shared_bytes),
               name);
    check_cuda(cudaDeviceGetAttribute(&processors, cudaDevAttrMultiProcessorCount, device_), name);
    return static_cast<unsigned>(std::clamp(per_processor * processors, 1, kReduceBlocks));
  }

  /// Blocks of a reduction that the device runs at a time. It is asked for at each launch, so it is
  /// remembered; here and not beside the kernel, because it is a property of the device.
  unsigned reduce_blocks(const void* kernel, const char* name, int threads);

  /// Reports a failed launch under the kernel's name; with SCREE_CHECK_SYNC also waits for it.
  void check_launch(const char* name) {
    check_cuda(cudaGetLastError(), name);
#ifdef SCREE_CHECK_SYNC
    check_cuda(cudaStreamSynchronize(stream_), name);
#endif
  }

 private:
  int device_ = 0;
  cudaStream_t stream_ = nullptr;
  void* partials_ = nullptr;
  unsigned* ticket_ = nullptr;
  std::unordered_map<const void*, unsigned> reduce_blocks_;
  void* result_ = nullptr;
  void* note_ = nullptr;             ///< page-locked
  cudaEvent_t note_sent_ = nullptr;  ///< when it has arrived
  void* scan_space_ = nullptr;
  std::size_t scan_bytes_ = 0;
  std::size_t allocated_ = 0;
  std::size_t peak_ = 0;
  PeerMeetings* peers_ = nullptr;
};

template <>
class StageMarks<Cuda> {
 public:
  explicit StageMarks(Cuda& cuda) : cuda_(&cuda) {}
  ~StageMarks() {
    for (const cudaEvent_t each : events_) cudaEventDestroy(each);
  }
  StageMarks(const StageMarks&) = delete;
  StageMarks& operator=(const StageMarks&) = delete;

  void clear() { used_ = 0; }
  void mark() {
    if (used_ == events_.size()) {
      events_.push_back(nullptr);
      check_cuda(cudaEventCreate(&events_.back()), "create event");
    }
    check_cuda(cudaEventRecord(events_[used_++], cuda_->stream()), "mark");
  }
  /// Once the device has come to both.
  double ms(std::size_t k) const {
    float between = 0;
    check_cuda(cudaEventElapsedTime(&between, events_[k], events_[k + 1]), "time between marks");
    return static_cast<double>(between);
  }

 private:
  Cuda* cuda_;
  std::vector<cudaEvent_t> events_;
  std::size_t used_ = 0;
};

/// Blocks a multiprocessor should hold: programs that wait for memory name a number, and get as few
/// registers as that takes.
template <class F>
constexpr int least_blocks() {
  if constexpr (requires { F::kLeastBlocks; }) {
    return F::kLeastBlocks;
  } else {
    return 1;
  }
}

/// Threads of a block: programs that take long for few elements name a smaller number, so that these are spread
/// over more multiprocessors.
template <class F>
constexpr int block_threads() {
  if constexpr (requires { F::kBlockThreads; }) {
    return F::kBlockThreads;
  } else {
    return Cuda::kBlock;
  }
}

// A program is read where the launch left it: without __grid_constant__ a function that is not inlined would get a copy
// of it in each thread.
template <class F>
__global__ void __launch_bounds__(block_threads<F>(), least_blocks<F>())
    for_each_kernel(Index n, const __grid_constant__ F f) {
  const Offset stride = static_cast<Offset>(gridDim.x) * blockDim.x;
  for (Offset i = static_cast<Offset>(blockIdx.x) * blockDim.x + threadIdx.x; i < n; i += stride) {
    f(static_cast<Index>(i));
  }
}

template <class F>
void for_each(Cuda& cuda, Index n, F f) {
  if (n <= 0) return;  // an empty launch is an error
  constexpr int kThreads = block_threads<F>();
  const auto blocks = static_cast<unsigned>((static_cast<Offset>(n) + kThreads - 1) / kThreads);
  for_each_kernel<<<blocks, kThreads, 0, cuda.stream()>>>(n, f);
  cuda.check_launch(F::name);
}

/// Combines one record per thread into thread 0's, by a fixed tree.
template <int kThreads, class R>
__device__ R block_combine(R mine) {
  __shared__ alignas(R) unsigned char storage[sizeof(R) * kThreads];
  R* shared = reinterpret_cast<R*>(storage);
  shared[threadIdx.x] = mine;
  __syncthreads();
  for (int half = kThreads / 2; half > 0; half /= 2) {
    if (threadIdx.x < half) shared[threadIdx.x].combine(shared[threadIdx.x + half]);
    __syncthreads();
  }
  return shared[0];
}

/// Each block reduces its share; the block that finishes last combines the partial results
/// in block order and runs `finish`. The ticket is an integer, so its order of arrival
/// does not touch the sums.
template <class R, class F, class G>
__global__ void __launch_bounds__(block_threads<F>())
    reduce_kernel(Index n, const __grid_constant__ F f, G finish, R* partials, unsigned* ticket) {
  R mine;
  const Offset stride = static_cast<Offset>(gridDim.x) * blockDim.x;
  for (Offset i = static_cast<Offset>(blockIdx.x) * blockDim.x + threadIdx.x; i < n; i += stride) {
    mine.combine(f(static_cast<Index>(i)));
  }
  const R block_total = block_combine<block_threads<F>()>(mine);
  __shared__ bool is_last;
  if (threadIdx.x == 0) {
    partials[blockIdx.x] = block_total;
    __threadfence();
    is_last = atomicInc(ticket, gridDim.x - 1) == gridDim.x - 1;  // wraps to zero for the next call
  }
  __syncthreads();
  if (!is_last) return;
  __threadfence();
  R rest;
  for (unsigned k = threadIdx.x; k < gridDim.x; k += blockDim.x) rest.combine(partials[k]);
  __syncthreads();
  const R total = block_combine<block_threads<F>()>(rest);
  if (threadIdx.x == 0) finish(total);
}

/// As many blocks as the device holds at once, so that none is left over for a last,
/// half empty wave.
template <class R, class F, class G = NoFinish>
void reduce(Cuda& cuda, Index n, F f, G finish = {}) {
  static_assert(sizeof(R) <= Cuda::kMaxReduceRecord);
  constexpr int kThreads = block_threads<F>();
  const unsigned resident =
      cuda.reduce_blocks(reinterpret_cast<const void*>(&reduce_kernel<R, F, G>), F::name, kThreads);
  const Offset wanted = (static_cast<Offset>(n) + kThreads - 1) / kThreads;
  const auto blocks = static_cast<unsigned>(std::clamp<Offset>(wanted, 1, resident));
  reduce_kernel<<<blocks, kThreads, 0, cuda.stream()>>>(
      n, f, finish, static_cast<R*>(cuda.partials()), cuda.ticket());
  cuda.check_launch(F::name);
}

/// Adds up in 64 bits (CUB), the second one in 32. @param out one element more than in
void exclusive_scan(Cuda& cuda, Span<const Index> in, Span<Offset> out);
void exclusive_scan(Cuda& cuda, Span<const Index> in, Span<Index> out);

template <>
struct SortSpace<Cuda> {
  explicit SortSpace(Cuda& cuda) : keys(cuda), values(cuda), temporary(cuda) {}
  Buffer<Cuda, std::uint64_t> keys;
  Buffer<Cuda, Index> values;
  Buffer<Cuda, unsigned char> temporary;
};

/// Stable radix sort of the low `bits` of the keys (CUB).
void sort_pairs(Cuda& cuda, SortSpace<Cuda>& space, Span<std::uint64_t> keys, Span<Index> values,
                int bits);

}  // namespace scree
