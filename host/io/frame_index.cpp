#include "host/io/frame_index.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <string_view>
#include <utility>

#include "host/error.h"
#include "host/io/atomic_file.h"
#include "host/io/frame_columns.h"
#include "host/io/vtkhdf.h"
#include "host/scene/scene_summary.h"

namespace scree {
namespace {

using vtkhdf::topologies;
using Clock = std::chrono::steady_clock;

/// Of the time of a run, what the index may take [-].
constexpr int kMostShare = 10;  // one in so many

template <class T>
void write_array(h5::Group& group, const std::string& name, const std::vector<T>& values) {
  group.write(name, std::span<const T>(values));
}
void append_numbers(h5::Group& group, const std::string& name,
                    const std::vector<std::int64_t>& values) {
  group.append(name, std::span<const std::int64_t>(values));
}

/// What steps say of the offsets of one kind of cells, for all kinds: others than vertices have none.
std::vector<std::int64_t> vertices_only(const std::vector<std::int64_t>& offsets) {
  std::vector<std::int64_t> all(offsets.size() * topologies.size(), 0);
  for (std::size_t i = 0; i < offsets.size(); ++i) all[i * topologies.size()] = offsets[i];
  return all;
}

/// How many of these frames there are up to a time.
std::int64_t count_until(const std::vector<double>& times, double time) {
  return std::upper_bound(times.begin(), times.end(), time) - times.begin();
}

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& what) {
  throw InputError(fmt::format("cannot continue {}: {}", path.string(), what));
}

/// @throws InputError unless a piece holds what the index says of it, up to a time, and nothing else
void check_piece(const std::filesystem::path& index, int rank, const FrameExtent& extent,
                 const FrameFormat& format, double time) {
  const std::filesystem::path path = frame_piece_file(index, rank);
  if (!std::filesystem::exists(path))
    refuse(index, fmt::format("its piece {} is missing", path.string()));
  const h5::File file = h5::File::open(path);
  const h5::Group root = file.root();
  require_filled(root, path, extent, format);
  const std::int64_t frames = count_until(root.read<double>("VTKHDF/Steps/Values"), time);
  if (frames != extent.frames)
    refuse(index, fmt::format("its piece {} has {} frames up to {} s, expected {}", path.string(),
                              frames, time, extent.frames));
}

}  // namespace

std::filesystem::path frame_piece_file(const std::filesystem::path& index, int rank) {
  return index.parent_path() / fmt::format("frames_{}.vtkhdf", rank);
}

std::optional<int> rank_of_frame_piece(const std::string& name) {
  constexpr std::string_view begin = "frames_";
  int rank = -1;
  if (!name.starts_with(begin)) return {};
  if (std::from_chars(name.data() + begin.size(), name.data() + name.size(), rank).ec !=
      std::errc{})
    return {};
  if (rank < 0 || name != frame_piece_file({}, rank).string()) return {};
  return rank;
}

FramePieces read_frame_pieces(const h5::Group& root) {
  const h5::Group vtk = root.open_group("VTKHDF");
  FramePieces pieces;
  pieces.times = vtk.read<double>("Steps/Values");
  const auto part_counts = vtk.read<std::int64_t>("Steps/NumberOfParts");
  const auto bodies = vtk.read<std::int64_t>("NumberOfPoints");
  const auto ranks = root.read<std::int32_t>(fmt::format("{}/rank", frame_pieces_group));
  const auto fault = [](const std::string& what) { throw InputError(what); };
  if (part_counts.size() != pieces.times.size() || ranks.size() != bodies.size())
    fault(fmt::format("it has {} frames with parts for {}, and {} parts with ranks for {}",
                      pieces.times.size(), part_counts.size(), bodies.size(), ranks.size()));
  pieces.begins.push_back(0);
  for (const std::int64_t count : part_counts) {
    const std::size_t begin = pieces.begins.back();
    if (count < 1 || static_cast<std::uint64_t>(count) > ranks.size() - begin)
      fault(fmt::format("frame {} has {} parts, expected 1 to {}", pieces.begins.size() - 1, count,
                        ranks.size() - begin));
    pieces.begins.push_back(begin + static_cast<std::size_t>(count));
  }
  for (std::size_t i = 0; i < pieces.begins.back(); ++i) {
    if (ranks[i] < 0 || bodies[i] < 1 || bodies[i] > std::numeric_limits<std::int32_t>::max())
      fault(fmt::format("part {} has {} bodies of rank {}", i, bodies[i], ranks[i]));
    pieces.parts.push_back({ranks[i], static_cast<std::uint64_t>(bodies[i])});
  }
  return pieces;
}

FrameIndex::FrameIndex(std::filesystem::path path, const Scene& scene, Precision precision,
                       int rank_count, std::optional<double> resume_time)
    : path_(std::move(path)),
      format_{dynamics_card(scene.dynamics.type).frame, precision, FrameBodies::own} {
  pieces_.begins = {0};
  if (resume_time) resume(*resume_time, rank_count, count_bodies(scene).all());
  std::error_code ignored;
  if (frame_count() == 0) std::filesystem::remove(path_, ignored);
}

void FrameIndex::resume(double time, int rank_count, std::uint64_t body_capacity) {
  std::int64_t frames_found = 0;
  try {
    if (std::filesystem::exists(path_)) {
      const h5::File file = h5::File::open(path_);
      const h5::Group root = file.root();
      if (!root.has(frame_pieces_group))
        refuse(path_, "it was written as one file (output.frame_pieces false), this run has true");
      const FramePieces found = [&] {
        try {
          return read_frame_pieces(root);
        } catch (const InputError& error) {
          refuse(path_, error.what());
        }
      }();
      frames_found = std::ssize(found.times);
      for (std::size_t frame = 0; frame < found.times.size() && found.times[frame] <= time; ++frame)
        add(found.times[frame], found.of_frame(frame));
    }
    for (const auto& [rank, extent] : filled_) check_piece(path_, rank, extent, format_, time);
  } catch (const h5::Error& error) {
    throw InputError(fmt::format("cannot continue {}", error.what()));
  }
  if (frame_count() > 0 && frame_count() < frames_found) {
    is_published_ = false;
    publish();
  }
  // Frames of a run that this one does not continue must not come back in a later one with more ranks.
  std::vector<int> gone;
  for (const auto& entry : std::filesystem::directory_iterator(path_.parent_path()))
    if (const auto rank = rank_of_frame_piece(entry.path().filename().string());
        rank && *rank >= rank_count)
      gone.push_back(*rank);
  for (const int rank : gone)
    FrameWriter(frame_piece_file(path_, rank), format_.fields, format_.precision, body_capacity,
                frame_count() > 0 ? std::optional<double>(time) : std::nullopt);
}

void FrameIndex::add(double time, std::span<const FramePieces::Part> parts) {
  pieces_.times.push_back(time);
  for (const FramePieces::Part& part : parts) {
    FrameExtent& piece = filled_[part.rank];
    piece = extended(piece, part.bodies);
    pieces_.parts.push_back(part);
    extents_.push_back(piece);
  }
  pieces_.begins.push_back(pieces_.parts.size());
}

void FrameIndex::append(double time, std::span<const std::int64_t> bodies) {
  if (frame_count() > 0 && time == pieces_.times.back()) return;
  std::vector<FramePieces::Part> parts;
  for (std::size_t rank = 0; rank < bodies.size(); ++rank)
    if (bodies[rank] > 0)
      parts.push_back({static_cast<int>(rank), static_cast<std::uint64_t>(bodies[rank])});
  if (parts.empty()) return;
  add(time, parts);
  is_published_ = false;
  if (Clock::now() - published_at_ >= (kMostShare - 1) * publishing_) publish();
}

void FrameIndex::publish() {
  if (is_published_) return;
  const Clock::time_point begin = Clock::now();
  AtomicFile target(path_);
  try {
    h5::File file = h5::File::create(target.temporary());
    if (format_.precision == Precision::double_precision)
      write<double>(file.root());
    else
      write<float>(file.root());
    file.close();
  } catch (const h5::Error& error) {
    throw RunError(fmt::format("cannot write frames {}: {}; the earlier frames are kept",
                               path_.string(), error.what()));
  }
  target.commit();
  is_published_ = true;
  published_at_ = Clock::now();
  publishing_ = published_at_ - begin;
}

template <class Real>
void FrameIndex::write(h5::Group root) const {
  const std::size_t part_count = pieces_.parts.size();
  // Rows of an array in the pieces, part by part.
  const auto rows = [&](const std::string& array, auto first, auto count) {
    std::vector<h5::RowsElsewhere> all;
    all.reserve(part_count);
    for (std::size_t i = 0; i < part_count; ++i)
      all.push_back({frame_piece_file({}, pieces_.parts[i].rank).string(), "/VTKHDF/" + array,
                     first(extents_[i]), count(pieces_.parts[i].bodies)});
    return all;
  };
  const auto same = [](std::uint64_t bodies) { return bodies; };
  const auto first_point = [](const FrameExtent& piece) {
    return piece.points - piece.last_bodies;
  };
  h5::Group vtk = vtkhdf::create_poly_data(root);
  const auto write_points = [&]<class T>(const std::string& array, T, std::uint64_t columns) {
    vtk.write_virtual<T>(array, rows(array, first_point, same), columns);
  };

  std::vector<std::int64_t> bodies;
  std::vector<std::int32_t> ranks;
  for (const FramePieces::Part& part : pieces_.parts) {
    bodies.push_back(static_cast<std::int64_t>(part.bodies));
    ranks.push_back(part.rank);
  }
  const std::vector<std::int64_t> none(part_count, 0);
  write_array(vtk, "NumberOfPoints", bodies);
  write_points("Points", double{}, 3);
  for (const char* name : topologies) {
    h5::Group topology = vtk.create_group(name);
    const bool used = name == topologies[0];
    for (const char* number : {"NumberOfCells", "NumberOfConnectivityIds"})
      write_array(topology, number, used ? bodies : none);
    if (used) {
      topology.write_virtual<std::int64_t>(
          "Offsets", rows(
                         "Vertices/Offsets", [](const FrameExtent& e) { return e.last_offset(); },
                         [](std::uint64_t cells) { return cells + 1; }));
      topology.write_virtual<std::int64_t>(
          "Connectivity",
          rows(
              "Vertices/Connectivity", [](const FrameExtent&) { return std::uint64_t{0}; }, same));
    } else {
      write_array(topology, "Offsets", none);
      write_array(topology, "Connectivity", std::vector<std::int64_t>{});
    }
  }

  vtk.create_group("PointData");
  std::vector<std::string> names;
  for_each_constant<Real>([&](const char* name, auto value) {
    using Row = NumbersOf<decltype(value)>;
    write_points(fmt::format("PointData/{}", name), typename Row::Type{}, Row::columns);
    names.emplace_back(name);
  });
  for (const FrameField& field : format_.fields) {
    write_points(fmt::format("PointData/{}", field.name), Real{},
                 field.columns > 1 ? static_cast<std::uint64_t>(field.columns) : 0);
    names.emplace_back(field.name);
  }

  vtkhdf::create_steps(vtk, "PointData", names);
  std::vector<std::int64_t> first_part, parts, first_body;
  std::int64_t before = 0;
  for (std::size_t frame = 0; frame < pieces_.times.size(); ++frame) {
    first_part.push_back(static_cast<std::int64_t>(pieces_.begins[frame]));
    parts.push_back(std::ssize(pieces_.of_frame(frame)));
    first_body.push_back(before);
    for (const FramePieces::Part& part : pieces_.of_frame(frame))
      before += static_cast<std::int64_t>(part.bodies);
  }
  h5::Group steps = vtk.open_group("Steps");
  steps.append("Values", std::span<const double>(pieces_.times));
  append_numbers(steps, "PartOffsets", first_part);
  append_numbers(steps, "NumberOfParts", parts);
  append_numbers(steps, "PointOffsets", first_body);
  for (const char* name : {"CellOffsets", "ConnectivityIdOffsets"})
    append_numbers(steps, name, vertices_only(first_body));
  h5::Group offsets = steps.open_group("PointDataOffsets");
  for (const std::string& name : names) append_numbers(offsets, name, first_body);
  steps.write_attribute<std::int64_t>("NSteps", frame_count());

  h5::Group own = root.create_group(frame_pieces_group);
  write_array(own, "rank", ranks);
}

}  // namespace scree
