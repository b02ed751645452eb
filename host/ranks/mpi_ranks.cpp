#include "host/ranks/mpi_ranks.h"

// The C interface alone: the one for C++ is deprecated.
#define OMPI_SKIP_MPICXX 1
#define MPICH_SKIP_MPICXX 1
#include <mpi.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <functional>
#include <sstream>
#include <utility>

#include "host/error.h"
#include "host/io/printable.h"
#include "host/io/streams.h"
#include "host/ranks/launch.h"
#include "host/ranks/nccl_messages.h"

namespace scree {
namespace {

constexpr std::size_t kMostBytes = std::size_t{1} << 30;  // of one message: MPI counts with an int
constexpr int kTag = 1;

void require(int code, const char* call) {
  if (code == MPI_SUCCESS) return;
  char text[MPI_MAX_ERROR_STRING] = "";
  int length = 0;
  MPI_Error_string(code, text, &length);
  throw RunError(std::string(call) + ": " + text);
}

bool is_started() {
  int started = 0;
  MPI_Initialized(&started);
  return started != 0;
}

bool is_ended() {
  int ended = 0;
  MPI_Finalized(&ended);
  return ended != 0;
}

/// MPI from its start to its end, unless the program that this library is in has started it.
class Session {
 public:
  Session() {
    if (is_started()) return;
    int provided = MPI_THREAD_SINGLE;
    require(MPI_Init_thread(nullptr, nullptr, MPI_THREAD_SERIALIZED, &provided), "MPI_Init_thread");
    is_own_ = true;
  }
  ~Session() {
    if (is_own_ && !is_ended()) MPI_Finalize();
  }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  bool is_own() const { return is_own_; }
  /// It is not ended: the launcher then ends all ranks.
  void give_up() { is_own_ = false; }

 private:
  bool is_own_ = false;
};

/// A communicator whose errors are returned, so that they have no effect on others.
class Communicator {
 public:
  Communicator() { require(MPI_Comm_dup(MPI_COMM_WORLD, &comm_), "MPI_Comm_dup"); }
  explicit Communicator(MPI_Comm comm) : comm_(comm) {}
  ~Communicator() {
    if (comm_ != MPI_COMM_NULL && !is_ended()) MPI_Comm_free(&comm_);
  }
  Communicator(const Communicator&) = delete;
  Communicator& operator=(const Communicator&) = delete;

  void give_up() { comm_ = MPI_COMM_NULL; }
  MPI_Comm get() const { return comm_; }
  int rank() const {
    int rank = 0;
    require(MPI_Comm_rank(comm_, &rank), "MPI_Comm_rank");
    return rank;
  }
  int size() const {
    int size = 0;
    require(MPI_Comm_size(comm_, &size), "MPI_Comm_size");
    return size;
  }

 private:
  MPI_Comm comm_ = MPI_COMM_NULL;
};

class MpiRanks final : public Ranks {
 public:
  MpiRanks() {
    require(MPI_Comm_set_errhandler(world_.get(), MPI_ERRORS_RETURN), "MPI_Comm_set_errhandler");
    rank_ = world_.rank();
    count_ = world_.size();
    MPI_Comm host = MPI_COMM_NULL;
    require(MPI_Comm_split_type(world_.get(), MPI_COMM_TYPE_SHARED, rank_, MPI_INFO_NULL, &host),
            "MPI_Comm_split_type");
    const Communicator on_host(host);
    local_ = {on_host.rank(), on_host.size()};
  }

  /// Others wait at the end of MPI for all; after an error they might wait for good.
  ~MpiRanks() override {
    if (!is_broken_) return;
    world_.give_up();
    session_.give_up();
  }
  MpiRanks(const MpiRanks&) = delete;
  MpiRanks& operator=(const MpiRanks&) = delete;

  int rank() const override { return rank_; }
  int count() const override { return count_; }
  int count_here() const override { return local_.count; }
  LocalRank local() const { return local_; }
  void set_before_abort(std::function<void(const std::string&)> act) {
    before_abort_ = std::move(act);
  }
  bool is_own_session() const { return session_.is_own(); }

  void gather(const void* own, std::size_t bytes, void* all) override {
    require_intact();
    if (bytes == 0) return;
    if (bytes > kMostBytes) return gather_large(own, bytes, all);
    const int n = static_cast<int>(bytes);
    check(MPI_Allgather(own, n, MPI_BYTE, all, n, MPI_BYTE, world_.get()), "MPI_Allgather");
    count_sent(count_ - 1, bytes * static_cast<std::size_t>(count_ - 1));
  }

  void exchange(const std::vector<Message>& send, const std::vector<Message>& receive) override {
    require_intact();
    std::vector<MPI_Request> requests;
    std::vector<int> expected;  // bytes of the parts that this rank receives, which come first
    for (const Message& message : receive) {
      for_parts(message, [&](unsigned char* data, int bytes) {
        requests.push_back(MPI_REQUEST_NULL);
        expected.push_back(bytes);
        check(MPI_Irecv(data, bytes, MPI_BYTE, message.rank, kTag, world_.get(), &requests.back()),
              "MPI_Irecv");
      });
    }
    for (const Message& message : send) {
      for_parts(message, [&](unsigned char* data, int bytes) {
        requests.push_back(MPI_REQUEST_NULL);
        check(MPI_Isend(data, bytes, MPI_BYTE, message.rank, kTag, world_.get(), &requests.back()),
              "MPI_Isend");
      });
      count_sent(1, message.bytes);
    }
    wait(requests, expected);
  }

  DeviceMessages* device_messages() override { return messages_.get(); }

  [[noreturn]] void abort(const std::string& reason, int exit_code) override {
    constexpr std::size_t most_printed = 4000;
    const std::string text = "rank " + std::to_string(rank_) + ": " + reason;
    say("scree: " + printable(text, most_printed));
    try {
      if (before_abort_) before_abort_(text);
    } catch (const std::exception&) {
      // The reason to end is what counts, and it is told.
    }
    MPI_Abort(world_.get(), exit_code);
    std::_Exit(exit_code);
  }

 private:
  /// After an error ranks no longer know what others wait for: each call fails from then on.
  void require_intact() const {
    if (is_broken_) throw RunError("a call of MPI failed before");
  }
  void check(int code, const char* call) {
    is_broken_ = is_broken_ || code != MPI_SUCCESS;
    require(code, call);
  }

  /// Calls for_part(data, bytes) for each part of a message that MPI can count.
  template <class ForPart>
  static void for_parts(const Message& message, const ForPart& for_part) {
    auto* data = static_cast<unsigned char*>(message.data);
    for (std::size_t left = message.bytes; left > 0;) {
      const std::size_t bytes = std::min(left, kMostBytes);
      for_part(data, static_cast<int>(bytes));
      data += bytes;
      left -= bytes;
    }
  }

  void wait(std::vector<MPI_Request>& requests, const std::vector<int>& expected) {
    std::vector<MPI_Status> statuses(requests.size());
    int code = MPI_Waitall(static_cast<int>(requests.size()), requests.data(), statuses.data());
    if (code == MPI_ERR_IN_STATUS) {
      for (const MPI_Status& status : statuses)
        if (status.MPI_ERROR != MPI_SUCCESS && status.MPI_ERROR != MPI_ERR_PENDING)
          code = status.MPI_ERROR;
    }
    check(code, "MPI_Waitall");
    for (std::size_t k = 0; k < expected.size(); ++k) {
      int bytes = 0;
      check(MPI_Get_count(&statuses[k], MPI_BYTE, &bytes), "MPI_Get_count");
      if (bytes == expected[k]) continue;
      is_broken_ = true;
      throw std::logic_error("rank " + std::to_string(rank_) + " waits for " +
                             std::to_string(expected[k]) + " bytes of rank " +
                             std::to_string(statuses[k].MPI_SOURCE) + ", which sends " +
                             std::to_string(bytes));
    }
  }

  void gather_large(const void* own, std::size_t bytes, void* all) {
    auto* out = static_cast<unsigned char*>(all);
    std::vector<Message> send, receive;
    for (int r = 0; r < count_; ++r) {
      unsigned char* place = out + static_cast<std::size_t>(r) * bytes;
      if (r == rank_) {
        std::memcpy(place, own, bytes);
        continue;
      }
      send.push_back({r, out + static_cast<std::size_t>(rank_) * bytes, bytes});
      receive.push_back({r, place, bytes});
    }
    exchange(send, receive);
  }

  Session session_;  // first: it ends last
  Communicator world_;
  int rank_ = 0;
  int count_ = 1;
  LocalRank local_;
  std::unique_ptr<DeviceMessages> messages_ = nccl_messages();
  bool is_broken_ = false;
  std::function<void(const std::string&)> before_abort_;
};

}  // namespace

std::shared_ptr<Ranks> mpi_ranks() {
  const Launch launch = launch_of_environment();
  if (launch.count == 1 && !is_started()) return nullptr;
  auto ranks = std::make_shared<MpiRanks>();
  if (ranks->is_own_session() && launch.count > 0 && ranks->count() != launch.count) {
    throw InputError("started as " + std::to_string(launch.count) + " processes, but " +
                     mpi_version() + " of this scree finds " + std::to_string(ranks->count()) +
                     "; use the launcher that belongs to it");
  }
  if (ranks->count() == 1) return nullptr;
  return ranks;
}

LocalRank local_rank(const Ranks& ranks) {
  if (const auto* mpi = dynamic_cast<const MpiRanks*>(&ranks)) return mpi->local();
  return {ranks.rank(), ranks.count()};
}

void set_before_abort(Ranks& ranks, std::function<void(const std::string&)> act) {
  if (auto* mpi = dynamic_cast<MpiRanks*>(&ranks)) mpi->set_before_abort(std::move(act));
}

std::string mpi_version() {
  char text[MPI_MAX_LIBRARY_VERSION_STRING] = "";
  int length = 0;
  if (MPI_Get_library_version(text, &length) != MPI_SUCCESS) return "unknown";
  // "Open MPI v4.1.4, package: ..." or "MPICH Version:      4.0.2\nMPICH Release date: ..."
  const std::string whole(text, static_cast<std::size_t>(length));
  std::istringstream words(whole.substr(0, whole.find_first_of(",\n")));
  std::string version;
  for (std::string word; words >> word;) {
    if (word == "Version:") continue;
    const bool has_v = word.size() > 1 && word[0] == 'v' && word[1] >= '0' && word[1] <= '9';
    if (!version.empty()) version += ' ';
    version += has_v ? word.substr(1) : word;
  }
  return version;
}

}  // namespace scree
