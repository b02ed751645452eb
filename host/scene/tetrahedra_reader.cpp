#include "host/scene/tetrahedra_reader.h"

#include <fmt/format.h>

#include <unordered_map>

#include "host/scene/mesh_text.h"
#include "host/scene/tetrahedra.h"

namespace scree {
namespace {

using mesh_text::fail;
using mesh_text::Lines;
using mesh_text::parsed;
using mesh_text::parsed_vector;

using Corners = std::array<int, 4>;

struct Cells {
  std::vector<Vec3d> vertices;
  std::vector<Corners> tetrahedra;
};

/// Numbers one after the other, wherever lines end.
class Numbers {
 public:
  /// @param first  word of this line to begin with; without it, the next line
  Numbers(const std::string& file, Lines& lines, std::size_t first)
      : file_(file), lines_(lines), next_(first) {}
  Numbers(const std::string& file, Lines& lines) : Numbers(file, lines, lines.words.size()) {}
  template <class T>
  T next(const char* what) {
    while (next_ >= lines_.words.size()) {
      lines_.require(file_, what);
      next_ = 0;
    }
    return parsed<T>(file_, lines_, lines_.words[next_++]);
  }

 private:
  const std::string& file_;
  Lines& lines_;
  std::size_t next_;
};

long long whole(const std::string& file, const Lines& lines, std::size_t word) {
  if (word >= lines.words.size())
    fail(file, fmt::format("line {}: {} numbers or more expected", lines.number, word + 1));
  return parsed<long long>(file, lines, lines.words[word]);
}

long long count_of(const std::string& file, const Lines& lines, std::size_t word) {
  const long long count = whole(file, lines, word);
  // Each takes two bytes of the file or more: a wrong count ends before memory does.
  if (count < 0 || count > 2'000'000'000)
    fail(file, fmt::format("line {}: {} is no number of things that a file can hold", lines.number,
                           count));
  return count;
}

/// Gmsh. Source: Gmsh Reference Manual, section "MSH file format".
class GmshFile {
 public:
  GmshFile(const std::string& name, const std::string& bytes) : name_(name), lines_(bytes) {}

  Cells read() {
    while (lines_.next()) {
      if (lines_.words.empty()) continue;
      const std::string section(lines_.words[0]);
      if (section == "$MeshFormat") {
        read_format();
      } else if (section == "$Nodes" || section == "$Elements") {
        if (version_ == 0) fail(name_, "no \"$MeshFormat\" at the start");
        if (section == "$Nodes") {
          version_ == 2 ? read_nodes_2() : read_nodes_4();
        } else {
          version_ == 2 ? read_elements_2() : read_elements_4();
        }
        require_end(section);
      }
    }
    if (version_ == 0) fail(name_, "no \"$MeshFormat\" at the start");
    return std::move(cells_);
  }

 private:
  static constexpr long long kTetrahedron = 4, kTetrahedronOfTen = 11;

  void read_format() {
    lines_.require(name_, "the number of the format");
    if (lines_.words.size() < 2)
      fail(name_, fmt::format("line {}: version and type of the file expected", lines_.number));
    const auto version = parsed<double>(name_, lines_, lines_.words[0]);
    version_ = version >= 2 && version < 3 ? 2 : version >= 4.1 && version < 5 ? 4 : 0;
    if (version_ == 0)
      fail(name_, fmt::format("format {} of Gmsh is not known: must be 2.2 or 4.1", version));
    if (whole(name_, lines_, 1) != 0)
      fail(name_, "is a binary file of Gmsh: must be text (Mesh.Binary = 0)");
  }

  /// What is counted must be all there is.
  void require_end(const std::string& section) {
    const std::string end = "$End" + section.substr(1);
    lines_.require(name_, end.c_str());
    if (lines_.words[0] != end)
      fail(name_, fmt::format("line {}: {} expected: the count of {} is too low", lines_.number,
                              end, section));
  }

  void add_node(long long tag, std::size_t first_word) {
    place_.emplace(tag, static_cast<int>(cells_.vertices.size()));
    cells_.vertices.push_back(parsed_vector(name_, lines_, first_word));
  }
  void read_nodes_2() {
    lines_.require(name_, "the number of nodes");
    const long long count = count_of(name_, lines_, 0);
    for (long long k = 0; k < count; ++k) {
      lines_.require(name_, "a node");
      add_node(whole(name_, lines_, 0), 1);
    }
  }
  void read_nodes_4() {
    lines_.require(name_, "the number of blocks of nodes");
    const long long blocks = count_of(name_, lines_, 0);
    for (long long b = 0; b < blocks; ++b) {
      lines_.require(name_, "a block of nodes");
      const long long count = count_of(name_, lines_, 3);
      std::vector<long long> tags;
      for (long long k = 0; k < count; ++k) {
        lines_.require(name_, "the number of a node");
        tags.push_back(whole(name_, lines_, 0));
      }
      for (const long long tag : tags) {
        lines_.require(name_, "a node");
        add_node(tag, 0);
      }
    }
  }

  void add_element(long long type, std::size_t first_word) {
    if (type == kTetrahedronOfTen)
      fail(name_, fmt::format("line {}: a tetrahedron of ten nodes: must be of four (order 1)",
                              lines_.number));
    if (type != kTetrahedron) return;
    Corners corners{};
    for (std::size_t k = 0; k < 4; ++k) {
      const long long tag = whole(name_, lines_, first_word + k);
      const auto found = place_.find(tag);
      if (found == place_.end())
        fail(name_, fmt::format("line {}: there is no node {}", lines_.number, tag));
      corners[k] = found->second;
    }
    cells_.tetrahedra.push_back(corners);
  }
  void read_elements_2() {
    lines_.require(name_, "the number of elements");
    const long long count = count_of(name_, lines_, 0);
    for (long long k = 0; k < count; ++k) {
      lines_.require(name_, "an element");
      const long long tags = count_of(name_, lines_, 2);
      add_element(whole(name_, lines_, 1), 3 + static_cast<std::size_t>(tags));
    }
  }
  void read_elements_4() {
    lines_.require(name_, "the number of blocks of elements");
    const long long blocks = count_of(name_, lines_, 0);
    for (long long b = 0; b < blocks; ++b) {
      lines_.require(name_, "a block of elements");
      const long long type = whole(name_, lines_, 2), count = count_of(name_, lines_, 3);
      for (long long k = 0; k < count; ++k) {
        lines_.require(name_, "an element");
        add_element(type, 1);
      }
    }
  }

  const std::string& name_;
  Lines lines_;
  int version_ = 0;
  std::unordered_map<long long, int> place_;  ///< of nodes by their numbers
  Cells cells_;
};

/// VTK. Source: VTK File Formats, section "Simple legacy formats".
class VtkFile {
 public:
  VtkFile(const std::string& name, const std::string& bytes) : name_(name), lines_(bytes) {}

  Cells read() {
    while (lines_.next()) {
      if (lines_.words.empty()) continue;
      const std::string word(lines_.words[0]);
      if (word == "BINARY") fail(name_, "is a binary file of VTK: must be text (ASCII)");
      if (word == "DATASET" && (lines_.words.size() < 2 || lines_.words[1] != "UNSTRUCTURED_GRID"))
        fail(name_, fmt::format("line {}: must be an UNSTRUCTURED_GRID", lines_.number));
      if (word == "POINTS") read_points();
      if (word == "CELLS") read_cells();
      if (word == "CELL_TYPES") read_types();
      if (word == "CELL_DATA" || word == "POINT_DATA") break;
    }
    const std::size_t cells = begin_.empty() ? 0 : begin_.size() - 1;
    if (types_.size() != cells)
      fail(name_, fmt::format("has {} cells and types of {}", cells, types_.size()));
    for (std::size_t cell = 0; cell < types_.size(); ++cell) add(cell);
    return std::move(cells_);
  }

 private:
  static constexpr long long kTetrahedron = 10, kTetrahedronOfTen = 24;

  void read_points() {
    const long long count = count_of(name_, lines_, 1);
    Numbers numbers(name_, lines_);
    for (long long k = 0; k < count; ++k) {
      Vec3d v;
      for (int axis = 0; axis < 3; ++axis) v[axis] = numbers.next<double>("a coordinate");
      cells_.vertices.push_back(v);
    }
  }
  void read_cells() {
    const long long first = count_of(name_, lines_, 1), second = count_of(name_, lines_, 2);
    lines_.require(name_, "cells");
    if (lines_.words[0] == "OFFSETS") {  // format 5: one offset more than cells, then all corners
      Numbers offsets(name_, lines_);
      for (long long k = 0; k < first; ++k) begin_.push_back(offsets.next<long long>("an offset"));
      lines_.require(name_, "CONNECTIVITY");
      Numbers corners(name_, lines_);
      for (long long k = 0; k < second; ++k) corner_.push_back(corners.next<long long>("a corner"));
      return;
    }
    Numbers numbers(name_, lines_, 0);
    for (long long cell = 0; cell < first; ++cell) {
      const auto count = numbers.next<long long>("a number of corners");
      begin_.push_back(static_cast<long long>(corner_.size()));
      for (long long k = 0; k < count; ++k) corner_.push_back(numbers.next<long long>("a corner"));
    }
    begin_.push_back(static_cast<long long>(corner_.size()));
  }
  void read_types() {
    const long long count = count_of(name_, lines_, 1);
    Numbers numbers(name_, lines_);
    for (long long k = 0; k < count; ++k)
      types_.push_back(numbers.next<long long>("the type of a cell"));
  }
  void add(std::size_t cell) {
    if (types_[cell] == kTetrahedronOfTen)
      fail(name_, fmt::format("cell {}: a tetrahedron of ten points: must be of four", cell));
    if (types_[cell] != kTetrahedron) return;
    const long long first = begin_[cell], end = begin_[cell + 1];
    if (first < 0 || end < first || end > std::ssize(corner_) || end - first != 4)
      fail(name_, fmt::format("cell {}: a tetrahedron must have four corners", cell));
    Corners corners{};
    for (std::size_t k = 0; k < 4; ++k) {
      const long long v = corner_[static_cast<std::size_t>(first) + k];
      if (v < 0 || v >= std::ssize(cells_.vertices))
        fail(name_, fmt::format("cell {}: there is no point {}", cell, v));
      corners[k] = static_cast<int>(v);
    }
    cells_.tetrahedra.push_back(corners);
  }

  const std::string& name_;
  Lines lines_;
  std::vector<long long> begin_;  ///< of the corners of cells, and their end
  std::vector<long long> corner_, types_;
  Cells cells_;
};

}  // namespace

bool is_tetrahedra_file(const std::string& kind) { return kind == ".msh" || kind == ".vtk"; }

TriangleMesh read_tetrahedra(const std::string& bytes, const std::string& kind,
                             const std::string& name) {
  Cells cells = kind == ".msh" ? GmshFile(name, bytes).read() : VtkFile(name, bytes).read();
  return mesh_of_tetrahedra(name, cells.vertices, std::move(cells.tetrahedra));
}

}  // namespace scree
