// The parts of the CUDA backend that need no template: device set-up, memory, and CUB's scan and
// sort. CUB is included in this unit only, which keeps every other one quick to compile.
#include <thrust/iterator/transform_iterator.h>

#include <cstring>
#include <cub/device/device_radix_sort.cuh>
#include <cub/device/device_scan.cuh>

#include "kernels/backend/cuda.cuh"

namespace scree {

Cuda::Cuda(int device) : device_(device) {
  if (device == kCurrent) {
    check_cuda(cudaGetDevice(&device_), "current device");
  } else {
    check_cuda(cudaSetDevice(device), "select device");
  }
  check_cuda(cudaStreamCreateWithFlags(&stream_, cudaStreamNonBlocking), "create stream");
  // Freed blocks stay in the pool: buffers that grow during a run do not go back to
  // the driver each time.
  cudaMemPool_t pool = nullptr;
  check_cuda(cudaDeviceGetDefaultMemPool(&pool, device_), "memory pool");
  std::uint64_t keep = ~std::uint64_t{0};
  check_cuda(cudaMemPoolSetAttribute(pool, cudaMemPoolAttrReleaseThreshold, &keep), "memory pool");
  check_cuda(cudaMalloc(&partials_, kMaxReduceRecord * kReduceBlocks),
             "allocate reduction scratch");
  check_cuda(cudaMalloc(&ticket_, sizeof(unsigned)), "allocate reduction ticket");
  check_cuda(cudaMallocHost(&result_, kMostResultBytes), "allocate host memory for results");
  check_cuda(cudaMallocHost(&note_, kMostNoteBytes), "allocate host memory for notes");
  check_cuda(cudaEventCreateWithFlags(&note_sent_, cudaEventDisableTiming), "create event");
  check_cuda(cudaMemsetAsync(ticket_, 0, sizeof(unsigned), stream_), "clear reduction ticket");
}

Cuda::~Cuda() {
  if (stream_ != nullptr) cudaStreamSynchronize(stream_);
  cudaFree(partials_);
  cudaFree(ticket_);
  cudaFreeHost(result_);
  cudaFreeHost(note_);
  if (note_sent_ != nullptr) cudaEventDestroy(note_sent_);
  if (scan_space_ != nullptr) deallocate(scan_space_, scan_bytes_);
  if (stream_ != nullptr) cudaStreamDestroy(stream_);
}

void* Cuda::allocate(std::size_t bytes) {
  void* p = nullptr;
  const cudaError_t error = cudaMallocAsync(&p, std::max<std::size_t>(bytes, 1), stream_);
  if (error == cudaErrorMemoryAllocation) {
    cudaGetLastError();  // clear it: the caller may shrink and go on
    throw OutOfMemory(bytes, "device");
  }
  check_cuda(error, "allocate");
  allocated_ += bytes;
  peak_ = std::max(peak_, allocated_);
  return p;
}

void Cuda::deallocate(void* p, std::size_t bytes) noexcept {
  cudaFreeAsync(p, stream_);
  allocated_ -= bytes;
}

unsigned Cuda::reduce_blocks(const void* kernel, const char* name, int threads) {
  unsigned& blocks = reduce_blocks_[kernel];  // zero when new
  if (blocks == 0) blocks = resident_blocks(kernel, name, 0, threads);
  return blocks;
}

void* Cuda::scan_space(std::size_t bytes) {
  if (bytes > scan_bytes_) {
    if (scan_space_ != nullptr) deallocate(scan_space_, scan_bytes_);
    scan_space_ = allocate(bytes);
    scan_bytes_ = bytes;
  }
  return scan_space_;
}

void Cuda::copy_bytes(void* destination, const void* source, std::size_t bytes) {
  if (bytes == 0) return;
  check_cuda(cudaMemcpyAsync(destination, source, bytes, cudaMemcpyDeviceToDevice, stream_),
             "copy");
}

void Cuda::upload_bytes(void* destination, const void* source, std::size_t bytes) {
  if (bytes == 0) return;
  check_cuda(cudaMemcpyAsync(destination, source, bytes, cudaMemcpyHostToDevice, stream_),
             "upload");
  synchronize();  // the source may be a temporary
}

void Cuda::download_bytes(void* destination, const void* source, std::size_t bytes) {
  if (bytes == 0) return;
  // Small results go through page-locked memory, which the device reaches without the help of the driver.
  const bool is_small = bytes <= kMostResultBytes;
  check_cuda(cudaMemcpyAsync(is_small ? result_ : destination, source, bytes,
                             cudaMemcpyDeviceToHost, stream_),
             "download");
  synchronize();
  if (is_small) std::memcpy(destination, result_, bytes);
}

void Cuda::send_note(const void* source, std::size_t bytes) {
  check_cuda(cudaMemcpyAsync(note_, source, bytes, cudaMemcpyDeviceToHost, stream_), "send note");
  check_cuda(cudaEventRecord(note_sent_, stream_), "send note");
}

void Cuda::read_note(void* destination, std::size_t bytes) {
  check_cuda(cudaEventSynchronize(note_sent_), "read note");
  std::memcpy(destination, note_, bytes);
}

namespace {

/// Terms that one block adds up: CUB takes three launches, this one, which is what few terms wait for. On an H200 it takes 8 us of
/// 2^14, as CUB does, and 24 us of 2^16.
constexpr Offset kFewTerms = 1 << 14;
constexpr int kScanThreads = 1024, kScanWarps = kScanThreads / 32;
constexpr unsigned kAllLanes = 0xffffffffu;

/// Inclusive sums over the lanes of a warp.
template <class Sum>
__device__ Sum warp_sums(Sum mine) {
  const int lane = static_cast<int>(threadIdx.x % 32);
#pragma unroll
  for (int step = 1; step < 32; step *= 2) {
    const Sum before = __shfl_up_sync(kAllLanes, mine, step);
    if (lane >= step) mine += before;
  }
  return mine;
}

/// Each warp has as many terms as the others, which it reads twice. @param out one element more than in
template <class Sum>
__global__ void __launch_bounds__(kScanThreads)
    few_terms_kernel(const Index* in, Index count, Sum* out) {
  __shared__ Sum of_warp[kScanWarps];
  const Index lane = static_cast<Index>(threadIdx.x % 32);
  const Index warp = static_cast<Index>(threadIdx.x / 32);
  const Index share = (count + kScanThreads - 1) / kScanThreads * 32;
  const Index begin = min(warp * share, count), end = min(begin + share, count);
  Sum sum = 0;
#pragma unroll 4
  for (Index i = begin + lane; i < end; i += 32) sum += in[i];
  sum = warp_sums(sum);
  if (lane == 31) of_warp[warp] = sum;
  __syncthreads();
  if (warp == 0) {
    const Sum own = of_warp[lane];
    of_warp[lane] = warp_sums(own) - own;
  }
  __syncthreads();
  Sum before = of_warp[warp];
#pragma unroll 4
  for (Index first = begin; first < end; first += 32) {
    const Index i = first + lane;
    const Sum own = i < end ? in[i] : 0, to_here = warp_sums(own);
    if (i < end) out[i] = before + to_here - own;
    before += __shfl_sync(kAllLanes, to_here, 31);
  }
  if (warp == kScanWarps - 1 && lane == 31) out[count] = before;
}

struct Widen {
  __host__ __device__ Offset operator()(Index i) const { return i; }
};

/// @param terms  iterator over the terms, of the type of the sum
template <class Terms, class Sum>
void scan(Cuda& cuda, Span<const Index> in, Terms terms, Sum* out) {
  const Offset count = in.size;
  if (count <= kFewTerms) {
    few_terms_kernel<<<1, kScanThreads, 0, cuda.stream()>>>(in.data, static_cast<Index>(count),
                                                            out);
    cuda.check_launch("exclusive_scan");
    return;
  }
  // The total lands in out[n]: an inclusive scan shifted by one, behind a leading zero.
  check_cuda(cudaMemsetAsync(out, 0, sizeof(Sum), cuda.stream()), "exclusive_scan");
  std::size_t bytes = 0;
  check_cuda(cub::DeviceScan::InclusiveSum(nullptr, bytes, terms, out + 1, count, cuda.stream()),
             "exclusive_scan");
  check_cuda(cub::DeviceScan::InclusiveSum(cuda.scan_space(bytes), bytes, terms, out + 1, count,
                                           cuda.stream()),
             "exclusive_scan");
}
}  // namespace

void exclusive_scan(Cuda& cuda, Span<const Index> in, Span<Offset> out) {
  scan(cuda, in, thrust::make_transform_iterator(in.data, Widen{}), out.data);
}

void exclusive_scan(Cuda& cuda, Span<const Index> in, Span<Index> out) {
  scan(cuda, in, in.data, out.data);
}

void sort_pairs(Cuda& cuda, SortSpace<Cuda>& space, Span<std::uint64_t> keys, Span<Index> values,
                int bits) {
  const Offset n = keys.size;
  if (n < 2) return;
  space.keys.reserve_discard(n);
  space.values.reserve_discard(n);
  cub::DoubleBuffer<std::uint64_t> key_buffers(keys.data, space.keys.data());
  cub::DoubleBuffer<Index> value_buffers(values.data, space.values.data());
  std::size_t bytes = 0;
  check_cuda(cub::DeviceRadixSort::SortPairs(nullptr, bytes, key_buffers, value_buffers, n, 0, bits,
                                             cuda.stream()),
             "sort_pairs");
  space.temporary.reserve_discard(static_cast<Offset>(bytes));
  check_cuda(cub::DeviceRadixSort::SortPairs(space.temporary.data(), bytes, key_buffers,
                                             value_buffers, n, 0, bits, cuda.stream()),
             "sort_pairs");
  if (key_buffers.Current() != keys.data) {
    copy(cuda, Span<const std::uint64_t>{key_buffers.Current(), n}, keys);
    copy(cuda, Span<const Index>{value_buffers.Current(), n}, values);
  }
}

}  // namespace scree
