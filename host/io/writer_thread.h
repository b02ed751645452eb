#pragma once
// Output beside the stepping loop.

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

namespace scree {

/// Runs tasks one after the other, in order, on a thread of its own.
///
/// The queue is short: each waiting task holds a copy of all body states. When it is full,
/// post() waits, so that a slow disk slows the run down instead of filling the memory.
/// After a task has thrown, later tasks are dropped and every post(), check() and finish()
/// throws that first exception.
class WriterThread {
 public:
  /// @param capacity  tasks that may wait, >= 1
  explicit WriterThread(std::size_t capacity = 2);
  /// Runs what is queued and joins; an exception that nobody has seen is lost.
  ~WriterThread();
  WriterThread(const WriterThread&) = delete;
  WriterThread& operator=(const WriterThread&) = delete;

  /// Queues a task, waiting for room. @throws what the first failed task threw
  void post(std::function<void()> task);

  /// @throws what the first failed task threw, if one has
  void check();

  /// Waits until all tasks are done. More may be posted afterwards.
  /// @throws what the first failed task threw
  void finish();

 private:
  void work();
  void throw_failure() const;

  const std::size_t capacity_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> tasks_;
  bool busy_ = false;
  bool stopping_ = false;
  std::exception_ptr failure_;
  std::thread thread_;
};

}  // namespace scree
