#include "kernels/backend/ranks.h"

#include <utility>

namespace scree {
namespace {

/// The messages of one call of exchange() about bytes for each rank, empty ones left out.
std::vector<Ranks::Message> messages_of(std::vector<Bytes>& of_rank, int own) {
  std::vector<Ranks::Message> messages;
  for (std::size_t r = 0; r < of_rank.size(); ++r)
    if (static_cast<int>(r) != own && !of_rank[r].empty())
      messages.push_back({static_cast<int>(r), of_rank[r].data(), of_rank[r].size()});
  return messages;
}

}  // namespace

std::string to_string(Transport transport) {
  switch (transport) {
    case Transport::automatic:
      return "auto";
    case Transport::peer:
      return "peer";
    case Transport::nccl:
      return "nccl";
    case Transport::hosts:
      return "hosts";
  }
  return "";
}

std::vector<Bytes> all_to_all(Ranks& ranks, std::vector<Bytes> to) {
  const auto n = static_cast<std::size_t>(ranks.count());
  const auto me = static_cast<std::size_t>(ranks.rank());
  std::vector<std::uint64_t> own(n), all(n * n);
  for (std::size_t r = 0; r < n; ++r) own[r] = to[r].size();
  ranks.gather(own.data(), n * sizeof(std::uint64_t), all.data());
  std::vector<Bytes> from(n);
  for (std::size_t r = 0; r < n; ++r)
    if (r != me) from[r].resize(all[r * n + me]);
  from[me] = std::move(to[me]);
  ranks.exchange(messages_of(to, ranks.rank()), messages_of(from, ranks.rank()));
  return from;
}

std::vector<Bytes> gather_bytes_at(Ranks& ranks, Bytes own, int root) {
  std::vector<Bytes> to(static_cast<std::size_t>(ranks.count()));
  to[static_cast<std::size_t>(root)] = std::move(own);
  std::vector<Bytes> from = all_to_all(ranks, std::move(to));
  if (ranks.rank() != root) from.clear();
  return from;
}

std::vector<Bytes> gather_bytes(Ranks& ranks, const Bytes& own) {
  return all_to_all(ranks, std::vector<Bytes>(static_cast<std::size_t>(ranks.count()), own));
}

std::vector<std::string> gather_texts(Ranks& ranks, const std::string& own) {
  std::vector<std::string> texts;
  for (const Bytes& text : gather_bytes(ranks, {own.begin(), own.end()}))
    texts.emplace_back(text.begin(), text.end());
  return texts;
}

Bytes broadcast(Ranks& ranks, Bytes bytes, int root) {
  const auto n = static_cast<std::size_t>(ranks.count());
  const auto size =
      gather(ranks, static_cast<std::uint64_t>(bytes.size()))[static_cast<std::size_t>(root)];
  std::vector<Ranks::Message> send, receive;
  if (ranks.rank() == root) {
    for (std::size_t r = 0; size > 0 && r < n; ++r)
      if (static_cast<int>(r) != root) send.push_back({static_cast<int>(r), bytes.data(), size});
  } else {
    bytes.resize(size);
    if (size > 0) receive.push_back({root, bytes.data(), size});
  }
  ranks.exchange(send, receive);
  return bytes;
}

}  // namespace scree
