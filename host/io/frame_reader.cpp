#include "host/io/frame_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <utility>

#include "host/error.h"
#include "host/io/frame_index.h"

namespace scree {
namespace {

struct ReadArray {
  const char* name;
  std::size_t columns;  ///< numbers a body
};
constexpr std::array<ReadArray, 4> read_arrays{{{"Points", 3},
                                                {"PointData/orientation", 4},
                                                {"PointData/velocity", 3},
                                                {"PointData/angular_velocity", 3}}};

/// One array for each of read_arrays. @throws InputError unless they have so many rows
FrameReader::Arrays read_all(const h5::Group& vtk, std::size_t rows) {
  FrameReader::Arrays all;
  for (std::size_t k = 0; k < all.size(); ++k) {
    const auto& [name, columns] = read_arrays[k];
    all[k] = vtk.read_converted<double>(name);
    if (all[k].size() != rows * columns)
      throw InputError(fmt::format("{} has {} numbers, expected {} for {} bodies of all frames",
                                   name, all[k].size(), rows * columns, rows));
  }
  return all;
}

/// What one rank wrote, and how far it is used.
struct Piece {
  std::vector<std::int64_t> id;
  FrameReader::Arrays arrays;
  std::size_t row = 0;
};

/// @param rows  that the index says it has; there are more of a run that goes on
Piece read_piece(const std::filesystem::path& path, std::uint64_t rows) {
  if (!std::filesystem::exists(path))
    throw InputError(fmt::format("its piece {} is missing", path.string()));
  try {
    const h5::File file = h5::File::open_foreign(path);
    const h5::Group vtk = file.root().open_group("VTKHDF");
    Piece piece{vtk.read_converted<std::int64_t>("PointData/id"), {}, 0};
    if (piece.id.size() < rows)
      throw InputError(fmt::format("has {} rows of bodies, expected {}", piece.id.size(), rows));
    piece.arrays = read_all(vtk, piece.id.size());
    return piece;
  } catch (const InputError& error) {
    throw InputError(fmt::format("its piece {}: {}", path.string(), error.what()));
  } catch (const h5::Error& error) {
    throw InputError(fmt::format("its piece {}", error.what()));
  }
}

std::map<int, Piece> read_pieces_of(const FramePieces& index, const std::filesystem::path& path) {
  std::map<int, std::uint64_t> rows;
  for (const FramePieces::Part& part : index.parts) rows[part.rank] += part.bodies;
  std::map<int, Piece> pieces;
  for (const auto& [rank, count] : rows)
    pieces.emplace(rank, read_piece(frame_piece_file(path, rank), count));
  return pieces;
}

std::size_t bodies_of(std::span<const FramePieces::Part> parts) {
  std::size_t bodies = 0;
  for (const FramePieces::Part& part : parts) bodies += part.bodies;
  return bodies;
}

[[noreturn]] void refuse_added_bodies() {
  throw InputError("bodies were added in the run, expected all of them from the start");
}

}  // namespace

FrameReader::FrameReader(const std::filesystem::path& path) {
  try {
    const h5::File file = h5::File::open_foreign(path);
    if (file.root().has(frame_pieces_group))
      read_pieces(file.root(), path);
    else
      read_one(file.root().open_group("VTKHDF"));
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", path.string(), error.what()));
  } catch (const h5::Error& error) {
    throw InputError(error.what());
  }
}

void FrameReader::read_one(const h5::Group& vtk) {
  times_ = vtk.read_converted<double>("Steps/Values");
  const auto of_parts = vtk.read_converted<std::int64_t>("NumberOfPoints");
  if (times_.empty()) throw InputError("holds no frames");
  if (of_parts.size() != 1) refuse_added_bodies();
  bodies_ = static_cast<std::size_t>(of_parts[0]);
  arrays_ = read_all(vtk, times_.size() * bodies_);
}

void FrameReader::read_pieces(const h5::Group& root, const std::filesystem::path& path) {
  const FramePieces index = read_frame_pieces(root);
  times_ = index.times;
  if (times_.empty()) throw InputError("holds no frames");
  bodies_ = bodies_of(index.of_frame(0));
  for (std::size_t frame = 1; frame < times_.size(); ++frame)
    if (bodies_of(index.of_frame(frame)) != bodies_) refuse_added_bodies();

  std::map<int, Piece> pieces = read_pieces_of(index, path);
  for (std::size_t k = 0; k < arrays_.size(); ++k)
    arrays_[k].resize(times_.size() * bodies_ * read_arrays[k].columns);
  std::vector<bool> found(bodies_);
  for (std::size_t frame = 0; frame < times_.size(); ++frame) {
    found.assign(bodies_, false);
    for (const FramePieces::Part& part : index.of_frame(frame)) {
      Piece& piece = pieces.at(part.rank);
      for (const std::size_t end = piece.row + part.bodies; piece.row < end; ++piece.row) {
        const std::int64_t id = piece.id[piece.row];
        const auto body = static_cast<std::size_t>(id);
        if (id < 0 || body >= bodies_ || found[body])
          throw InputError(
              fmt::format("frame {}: piece {} has body {}, expected each of 0 to {} once", frame,
                          frame_piece_file(path, part.rank).string(), id, bodies_ - 1));
        found[body] = true;
        for (std::size_t k = 0; k < arrays_.size(); ++k) {
          const std::size_t columns = read_arrays[k].columns;
          std::copy_n(piece.arrays[k].data() + piece.row * columns, columns,
                      arrays_[k].data() + (frame * bodies_ + body) * columns);
        }
      }
    }
  }
}

BodyStates FrameReader::states(std::size_t frame) const {
  const auto& [position, orientation, velocity, angular_velocity] = arrays_;
  BodyStates states;
  const auto vectors = [&](const std::vector<double>& from, std::vector<Vec3d>& to) {
    to.reserve(bodies_);
    for (std::size_t i = frame * bodies_; i < (frame + 1) * bodies_; ++i)
      to.push_back({from[3 * i], from[3 * i + 1], from[3 * i + 2]});
  };
  vectors(position, states.position);
  vectors(velocity, states.velocity);
  vectors(angular_velocity, states.angular_velocity);
  states.orientation.reserve(bodies_);
  for (std::size_t i = frame * bodies_; i < (frame + 1) * bodies_; ++i)
    states.orientation.push_back(normalized(Quatd{orientation[4 * i], orientation[4 * i + 1],
                                                  orientation[4 * i + 2], orientation[4 * i + 3]}));
  return states;
}

}  // namespace scree
