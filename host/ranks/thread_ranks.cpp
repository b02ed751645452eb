#include "host/ranks/thread_ranks.h"

#include <condition_variable>
#include <cstring>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

namespace scree {
namespace {

/// What the threads share: a place for each rank's data, and a barrier that an error opens for good.
class Meeting {
 public:
  explicit Meeting(int count) : count_(count), gathered_(count), sent_(count) {}

  int count() const { return count_; }

  /// Waits for all. @throws RankAborted when one of them will not come
  void wait() {
    std::unique_lock lock(mutex_);
    if (reason_) throw RankAborted(*reason_);
    const std::int64_t round = round_;
    if (++here_ == count_) {
      here_ = 0;
      ++round_;
      changed_.notify_all();
    } else {
      changed_.wait(lock, [&] { return round_ != round || reason_; });
    }
    if (reason_ && round_ == round) throw RankAborted(*reason_);
  }

  void abort(const std::string& reason) {
    const std::lock_guard lock(mutex_);
    if (!reason_) reason_ = reason;
    changed_.notify_all();
  }

  /// Between two calls of wait() each rank may write its own place, and all may read.
  const void*& gathered(int rank) { return gathered_[static_cast<std::size_t>(rank)]; }
  const std::vector<Ranks::Message>*& sent(int rank) {
    return sent_[static_cast<std::size_t>(rank)];
  }

 private:
  int count_;
  std::mutex mutex_;
  std::condition_variable changed_;
  int here_ = 0;
  std::int64_t round_ = 0;
  std::optional<std::string> reason_;
  std::vector<const void*> gathered_;
  std::vector<const std::vector<Ranks::Message>*> sent_;
};

class ThreadRanks final : public Ranks {
 public:
  ThreadRanks(std::shared_ptr<Meeting> meeting, int rank)
      : meeting_(std::move(meeting)), rank_(rank) {}

  int rank() const override { return rank_; }
  int count() const override { return meeting_->count(); }

  void gather(const void* own, std::size_t bytes, void* all) override {
    meeting_->gathered(rank_) = own;
    meeting_->wait();
    for (int r = 0; r < count(); ++r)
      std::memcpy(static_cast<unsigned char*>(all) + static_cast<std::size_t>(r) * bytes,
                  meeting_->gathered(r), bytes);
    meeting_->wait();
    count_sent(count() - 1, bytes * static_cast<std::size_t>(count() - 1));
  }

  void exchange(const std::vector<Message>& send, const std::vector<Message>& receive) override {
    meeting_->sent(rank_) = &send;
    meeting_->wait();
    for (const Message& message : receive) {
      const Message* source = nullptr;
      for (const Message& other : *meeting_->sent(message.rank))
        if (other.rank == rank_) source = &other;
      if (source == nullptr || source->bytes != message.bytes)
        throw std::logic_error("rank " + std::to_string(rank_) + " waits for " +
                               std::to_string(message.bytes) + " bytes of rank " +
                               std::to_string(message.rank) + ", which sends others");
      std::memcpy(message.data, source->data, message.bytes);
    }
    meeting_->wait();
    for (const Message& message : send) count_sent(1, message.bytes);
  }

  [[noreturn]] void abort(const std::string& reason, int) override {
    const std::string text = "rank " + std::to_string(rank_) + ": " + reason;
    meeting_->abort(text);
    throw RankAborted(text);
  }

 private:
  std::shared_ptr<Meeting> meeting_;
  int rank_;
};

}  // namespace

void run_thread_ranks(int count, const std::function<void(const std::shared_ptr<Ranks>&)>& body) {
  if (count < 1) throw std::invalid_argument("run_thread_ranks(): there must be a rank");
  const auto meeting = std::make_shared<Meeting>(count);
  std::mutex mutex;
  std::exception_ptr first;
  const auto run = [&](int rank) {
    try {
      body(std::make_shared<ThreadRanks>(meeting, rank));
    } catch (const std::exception& error) {
      {
        const std::lock_guard lock(mutex);
        if (first == nullptr) first = std::current_exception();
      }
      meeting->abort("rank " + std::to_string(rank) + ": " + error.what());
    }
  };
  std::vector<std::thread> threads;
  threads.reserve(static_cast<std::size_t>(count));
  for (int rank = 0; rank < count; ++rank) threads.emplace_back(run, rank);
  for (std::thread& thread : threads) thread.join();
  if (first != nullptr) std::rethrow_exception(first);
}

}  // namespace scree
