#pragma once
// Several processes, or threads, that simulate one scene together: who they are, and how data go from one to another. Data
// are in host memory; those of devices may have another way (device_messages.h, peer_window.h).

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

#include "kernels/types.h"

namespace scree {

/// How data go from the device of one rank to that of another.
enum class Transport : std::int32_t {
  automatic,  ///< the first of the others that works
  peer,       ///< each writes into the memory of the others: for GPUs of one host with peer access
  nccl,       ///< by NCCL: where each rank is a process with a GPU of its own
  hosts       ///< through the memory of hosts, as all data of a CPU
};

/// "auto", "peer", "nccl" or "hosts".
std::string to_string(Transport transport);

class DeviceMessages;

/// A group of ranks, as one of them sees it. Calls are collective: all ranks make the same ones in the same order, each
/// from one thread.
class Ranks {
 public:
  virtual ~Ranks() = default;

  virtual int rank() const = 0;   ///< number of this one, from 0
  virtual int count() const = 0;  ///< how many there are, >= 1
  /// How many of them are on the host of this one.
  virtual int count_here() const { return count(); }

  /// What every rank has, in the order of ranks. @param own  [bytes]  @param all  [bytes * count()] out
  virtual void gather(const void* own, std::size_t bytes, void* all) = 0;

  /// Bytes for one rank, or from one.
  struct Message {
    int rank = 0;
    void* data = nullptr;
    std::size_t bytes = 0;
  };
  /// Sends and receives; each message has its counterpart in the call of the other rank, with the same number of bytes, and
  /// two ranks have at most one for each other. Returns when all are there.
  virtual void exchange(const std::vector<Message>& send, const std::vector<Message>& receive) = 0;

  /// How devices send each other messages; null: they do not.
  virtual DeviceMessages* device_messages() { return nullptr; }

  /// Ends all ranks because this one cannot go on; the text names it and the reason. Ranks that wait for this one do not
  /// wait on.
  [[noreturn]] virtual void abort(const std::string& reason, int exit_code) = 0;

  /// Messages and bytes that this rank has sent so far, those of gather() to itself and what is written to peers not counted.
  struct Traffic {
    std::int64_t messages = 0;
    std::int64_t bytes = 0;
  };
  Traffic sent() const { return sent_; }
  /// Also for what devices send each other.
  void count_sent(std::int64_t messages, std::size_t bytes) {
    sent_.messages += messages;
    sent_.bytes += static_cast<std::int64_t>(bytes);
  }

  /// The same on all ranks, before a World is made with them.
  void set_transport(Transport transport) { transport_ = transport; }
  Transport transport() const { return transport_; }
  /// What devices use, once they have ghosts; else automatic.
  void note_transport(Transport used) { used_ = used; }
  Transport used_transport() const { return used_; }

  /// All ranks are about to end a World together, also where one of them does so because of an error.
  void set_ends_together(bool ends) { ends_together_ = ends; }
  bool ends_together() const { return ends_together_; }

 private:
  Traffic sent_;
  Transport transport_ = Transport::automatic;
  Transport used_ = Transport::automatic;
  bool ends_together_ = false;
};

/// One value of each rank, in their order.
template <class T>
std::vector<T> gather(Ranks& ranks, const T& own) {
  static_assert(std::is_trivially_copyable_v<T>);
  std::vector<T> all(static_cast<std::size_t>(ranks.count()));
  ranks.gather(&own, sizeof(T), all.data());
  return all;
}

/// Combines a record of each rank in their order: the same bits everywhere.
template <class R>
R combined(Ranks& ranks, const R& own) {
  R total;
  for (const R& record : gather(ranks, own)) total.combine(record);
  return total;
}

/// Whether it holds on any rank.
inline bool any(Ranks& ranks, bool own) {
  for (const std::uint8_t other : gather(ranks, static_cast<std::uint8_t>(own)))
    if (other != 0) return true;
  return false;
}

using Bytes = std::vector<unsigned char>;

/// Values as they go to another rank, and back.
template <class T>
Bytes bytes_of(const std::vector<T>& values) {
  static_assert(std::is_trivially_copyable_v<T>);
  const auto* first = reinterpret_cast<const unsigned char*>(values.data());
  return Bytes(first, first + values.size() * sizeof(T));
}
template <class T>
void append_values(const Bytes& bytes, std::vector<T>& values) {
  const std::size_t before = values.size();
  values.resize(before + bytes.size() / sizeof(T));
  if (!bytes.empty())
    std::memcpy(static_cast<void*>(values.data() + before), bytes.data(), bytes.size());
}

/// Sends bytes to every rank and gets those that others have for this one, by rank; what a rank sends itself is moved.
std::vector<Bytes> all_to_all(Ranks& ranks, std::vector<Bytes> to);

/// The bytes of every rank at `root`, by rank; elsewhere empty.
std::vector<Bytes> gather_bytes_at(Ranks& ranks, Bytes own, int root);
/// The bytes of every rank, everywhere.
std::vector<Bytes> gather_bytes(Ranks& ranks, const Bytes& own);

/// The values of every rank in the order of ranks, everywhere.
template <class T>
std::vector<T> gather_values(Ranks& ranks, const std::vector<T>& own) {
  std::vector<T> all;
  for (const Bytes& of_rank : gather_bytes(ranks, bytes_of(own))) append_values(of_rank, all);
  return all;
}
/// The text of every rank, everywhere.
std::vector<std::string> gather_texts(Ranks& ranks, const std::string& own);

/// The bytes that `root` has, everywhere.
Bytes broadcast(Ranks& ranks, Bytes bytes, int root);

}  // namespace scree
