#include "host/ranks/nccl_messages.h"

#include <cuda_runtime.h>
#include <nccl.h>

#include <algorithm>
#include <chrono>
#include <future>
#include <thread>

#include "kernels/backend/backend.h"
#include "kernels/backend/rank_devices.h"

namespace scree {
namespace {

constexpr std::chrono::seconds kLongestStart{25};  // all ranks end within 30 s of a fault

void check(cudaError_t error, const char* what) {
  if (error != cudaSuccess)
    throw DeviceError(std::string("CUDA: ") + cudaGetErrorString(error) + " (" + what + ")");
}

/// Ends a group of calls, however it is left: one that stays open would take in all later calls of the thread.
class Group {
 public:
  Group() { note(ncclGroupStart()); }
  ~Group() {
    if (!is_ended_) ncclGroupEnd();
  }
  Group(const Group&) = delete;
  Group& operator=(const Group&) = delete;

  void note(ncclResult_t result) {
    if (result_ == ncclSuccess) result_ = result;
  }
  /// What went wrong first.
  ncclResult_t end() {
    is_ended_ = true;
    note(ncclGroupEnd());
    return result_;
  }

 private:
  ncclResult_t result_ = ncclSuccess;
  bool is_ended_ = false;
};

class NcclMessages final : public DeviceMessages {
 public:
  // A communicator is destroyed by all ranks together, or not at all: a rank that failed would wait for others. It serves until
  // the process ends, which frees it.

  bool open(Ranks& ranks) override {
    if (comm_ != nullptr) return true;
    if (!fault_.empty()) return false;
    ranks_ = &ranks;
    const RankDevice own = this_device();
    if (!have_own_cards(gather(ranks, own))) {
      fault_ = "ranks share a GPU";
      return false;
    }
    ncclUniqueId id{};
    ncclResult_t result = ranks.rank() == 0 ? ncclGetUniqueId(&id) : ncclSuccess;
    id = gather(ranks, id)[0];
    if (!any(ranks, result != ncclSuccess)) result = connect(id, own.number);
    std::string fault;
    if (result != ncclSuccess) {
      fault = ncclGetErrorString(result);
    } else if (cudaStreamCreateWithFlags(&stream_, cudaStreamNonBlocking) != cudaSuccess ||
               cudaEventCreateWithFlags(&ready_, cudaEventDisableTiming) != cudaSuccess ||
               cudaEventCreateWithFlags(&done_, cudaEventDisableTiming) != cudaSuccess) {
      fault = cudaGetErrorString(cudaGetLastError());
    }
    const std::vector<std::string> faults = gather_texts(ranks, fault);
    const auto first = std::find_if(faults.begin(), faults.end(),
                                    [](const std::string& text) { return !text.empty(); });
    if (first == faults.end()) return true;
    fault_ = "rank " + std::to_string(first - faults.begin()) + ": " + *first;
    comm_ = nullptr;
    return false;
  }

  const std::string& fault() const override { return fault_; }

  void exchange(const std::vector<Ranks::Message>& send, const std::vector<Ranks::Message>& receive,
                void* stream) override {
    check(cudaEventRecord(ready_, static_cast<cudaStream_t>(stream)), "record event");
    check(cudaStreamWaitEvent(stream_, ready_, 0), "wait for event");
    Group group;
    for (const Ranks::Message& m : send)
      group.note(ncclSend(m.data, m.bytes, ncclUint8, m.rank, comm_, stream_));
    for (const Ranks::Message& m : receive)
      group.note(ncclRecv(m.data, m.bytes, ncclUint8, m.rank, comm_, stream_));
    const ncclResult_t result = group.end();
    if (result != ncclSuccess)
      throw DeviceError(std::string("NCCL: ") + ncclGetErrorString(result) + "; " +
                        ncclGetLastError(comm_));
    for (const Ranks::Message& m : send) ranks_->count_sent(1, m.bytes);
    check(cudaEventRecord(done_, stream_), "record event");
  }

  void wait(void* stream) override {
    check(cudaStreamWaitEvent(static_cast<cudaStream_t>(stream), done_, 0), "wait for event");
  }

 private:
  /// NCCL waits for good where hosts cannot reach each other: a thread of its own, so that this one can say so.
  ncclResult_t connect(const ncclUniqueId& id, int device) {
    std::promise<ncclResult_t> made;
    std::future<ncclResult_t> result = made.get_future();
    std::thread([this, id, device, count = ranks_->count(), rank = ranks_->rank(),
                 promise = std::move(made)]() mutable {
      ncclResult_t end = cudaSetDevice(device) == cudaSuccess ? ncclSuccess : ncclSystemError;
      if (end == ncclSuccess) end = ncclCommInitRank(&comm_, count, id, rank);
      promise.set_value(end);
    }).detach();
    if (result.wait_for(kLongestStart) != std::future_status::ready)
      throw DeviceError("NCCL does not connect the ranks within " +
                        std::to_string(kLongestStart.count()) +
                        " s; NCCL_DEBUG=INFO tells more, and --transport hosts goes without it");
    return result.get();
  }

  Ranks* ranks_ = nullptr;
  ncclComm_t comm_ = nullptr;
  cudaStream_t stream_ = nullptr;
  cudaEvent_t ready_ = nullptr, done_ = nullptr;
  std::string fault_;
};

}  // namespace

std::unique_ptr<DeviceMessages> nccl_messages() { return std::make_unique<NcclMessages>(); }

std::string nccl_version() {
  int version = 0;
  if (ncclGetVersion(&version) != ncclSuccess) return "unknown";
  constexpr int kMajor = 10000, kMinor = 100;  // as NCCL numbers them since 2.9
  return std::to_string(version / kMajor) + "." + std::to_string(version % kMajor / kMinor) + "." +
         std::to_string(version % kMinor);
}

}  // namespace scree
