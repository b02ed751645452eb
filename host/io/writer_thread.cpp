#include "host/io/writer_thread.h"

#include <algorithm>
#include <utility>

namespace scree {

WriterThread::WriterThread(std::size_t capacity)
    : capacity_(std::max<std::size_t>(capacity, 1)), thread_([this] { work(); }) {}

WriterThread::~WriterThread() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void WriterThread::throw_failure() const {
  if (failure_) std::rethrow_exception(failure_);
}

void WriterThread::post(std::function<void()> task) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return failure_ || tasks_.size() < capacity_; });
  throw_failure();
  tasks_.push_back(std::move(task));
  changed_.notify_all();
}

void WriterThread::check() {
  const std::lock_guard lock(mutex_);
  throw_failure();
}

void WriterThread::finish() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return tasks_.empty() && !busy_; });
  throw_failure();
}

void WriterThread::work() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return stopping_ || !tasks_.empty(); });
    if (tasks_.empty()) return;
    std::function<void()> task = std::move(tasks_.front());
    tasks_.pop_front();
    busy_ = true;
    changed_.notify_all();
    lock.unlock();
    std::exception_ptr failure;
    try {
      task();
    } catch (...) {
      failure = std::current_exception();
    }
    task = nullptr;  // what it holds is freed here, not while the lock is held
    lock.lock();
    busy_ = false;
    if (failure && !failure_) failure_ = failure;
    if (failure_) tasks_.clear();
    changed_.notify_all();
  }
}

}  // namespace scree
