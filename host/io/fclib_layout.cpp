#include "host/io/fclib_layout.h"

#include <fmt/format.h>

#include <array>
#include <limits>
#include <span>
#include <string>

#include "host/error.h"

namespace scree {
namespace {

constexpr const char* local_group = "fclib_local";
constexpr const char* global_group = "fclib_global";
constexpr const char* rolling_group = "fclib_global_rolling";
constexpr std::int64_t max_index = std::numeric_limits<std::int32_t>::max();

// ---- reading -----------------------------------------------------------------------------------

std::int64_t read_integer(const h5::Group& group, const std::string& name) {
  const auto values = group.read_converted<std::int64_t>(name);
  if (values.size() != 1)
    throw InputError(fmt::format("{} has {} values, expected one", name, values.size()));
  return values.front();
}

std::vector<double> read_vector(const h5::Group& group, const std::string& name) {
  return group.read_converted<double>(name);
}

/// Text up to the zero byte that ends it; empty when it is not there or not of a fixed length.
/// Those of variable length lie in a heap that HDF5 reads unchecked: a damaged one
/// would end the program.
std::string read_text(const h5::Group& group, const std::string& name) {
  if (!group.has(name)) return {};
  try {
    const std::string text = group.read_text(name);
    return text.substr(0, text.find('\0'));
  } catch (const h5::Error&) {
    return {};
  }
}

/// Decodes one matrix of a known size.
class MatrixReader {
 public:
  MatrixReader(const h5::Group& group, std::string name, std::size_t rows, std::size_t columns)
      : name_(std::move(name)), matrix_(group.open_group(name_)) {
    rows_ = size("m", rows);
    columns_ = size("n", columns);
    i_ = matrix_.read_converted<std::int64_t>("i");
    p_ = matrix_.read_converted<std::int64_t>("p");
    x_ = read_vector(matrix_, "x");
  }

  SparseMatrix read() {
    const bool packed = matrix_.has_attribute("symmetric_packed") &&
                        matrix_.integer_attribute("symmetric_packed") != 0;
    return packed ? unpacked(stored()) : stored();
  }

 private:
  SparseMatrix stored() {
    const std::int64_t nz = read_integer(matrix_, "nz");
    if (nz >= 0) return triplets(static_cast<std::size_t>(nz));
    if (nz == -1) return transpose(compressed(columns_, "n", rows_));
    if (nz == -2) return compressed(rows_, "m", columns_);
    refuse(fmt::format("nz is {}, expected 0 or more (triplets), -1 (columns) or -2 (rows)", nz));
  }

  /// The whole of a symmetric matrix of which one triangle is stored.
  SparseMatrix unpacked(const SparseMatrix& triangle) const {
    bool upper = false, lower = false;
    for (std::int32_t row = 0; row < triangle.row_count; ++row)
      for (std::int32_t k = triangle.row_start[row]; k < triangle.row_start[row + 1]; ++k) {
        upper = upper || triangle.column[k] > row;
        lower = lower || triangle.column[k] < row;
      }
    if (rows_ != columns_ || (upper && lower))
      refuse(
          "attribute symmetric_packed is set, expected a square matrix with one triangle stored");
    return with_both_triangles(triangle);
  }

  [[noreturn]] void refuse(const std::string& what) const {
    throw InputError(fmt::format("{}/{}", name_, what));
  }

  std::int32_t size(const char* name, std::size_t expected) const {
    const std::int64_t found = read_integer(matrix_, name);
    if (found < 0 || static_cast<std::uint64_t>(found) != expected || found > max_index)
      refuse(fmt::format("{} is {}, expected {} (the size of the vectors)", name, found, expected));
    return static_cast<std::int32_t>(found);
  }

  /// Arrays may be longer than what is used of them.
  void require_length(std::size_t found, std::size_t needed, const char* name) const {
    if (found < needed)
      refuse(fmt::format("{} has {} values, expected at least {}", name, found, needed));
  }

  std::int32_t index(const std::vector<std::int64_t>& values, std::size_t k, std::int32_t limit,
                     const char* name) const {
    if (values[k] < 0 || values[k] >= limit)
      refuse(fmt::format("{}[{}] is {}, expected 0 to {}", name, k, values[k], limit - 1));
    return static_cast<std::int32_t>(values[k]);
  }

  SparseMatrix triplets(std::size_t count) const {
    require_length(i_.size(), count, "i");
    require_length(p_.size(), count, "p");
    require_length(x_.size(), count, "x");
    std::vector<MatrixEntry> entries(count);
    for (std::size_t k = 0; k < count; ++k)
      entries[k] = {index(i_, k, rows_, "i"), index(p_, k, columns_, "p"), x_[k]};
    return compress(rows_, columns_, entries);
  }

  /// Compressed along the outer dimension: rows as stored, or columns, then the result
  /// is the transpose.
  SparseMatrix compressed(std::int32_t outer, const char* outer_name, std::int32_t inner) const {
    if (p_.size() != static_cast<std::size_t>(outer) + 1)
      refuse(
          fmt::format("p has {} values, expected {} ({} + 1)", p_.size(), outer + 1LL, outer_name));
    if (p_.front() != 0) refuse(fmt::format("p[0] is {}, expected 0", p_.front()));
    for (std::size_t k = 1; k < p_.size(); ++k) {
      // Beyond the end and beyond what is there: this one, and not its neighbors, is wrong.
      if (p_[k] > p_.back() && p_[k] > static_cast<std::int64_t>(i_.size()))
        refuse(
            fmt::format("p[{}] is {}, expected at most {} (the last of p)", k, p_[k], p_.back()));
      if (p_[k] < p_[k - 1])
        refuse(fmt::format("p[{}] is {} after {} in p[{}], expected ascending numbers", k, p_[k],
                           p_[k - 1], k - 1));
      if (p_[k] > max_index)
        refuse(fmt::format("p[{}] is {}, expected at most {}", k, p_[k], max_index));
    }
    const auto count = static_cast<std::size_t>(p_.back());
    require_length(i_.size(), count, "i");
    require_length(x_.size(), count, "x");
    std::vector<MatrixEntry> entries(count);
    for (std::int32_t o = 0; o < outer; ++o) {
      for (auto k = static_cast<std::size_t>(p_[o]); k < static_cast<std::size_t>(p_[o + 1]); ++k)
        entries[k] = {o, index(i_, k, inner, "i"), x_[k]};
    }
    return compress(outer, inner, entries);
  }

  std::string name_;
  h5::Group matrix_;
  std::int32_t rows_ = 0;
  std::int32_t columns_ = 0;
  std::vector<std::int64_t> i_, p_;
  std::vector<double> x_;
};

SparseMatrix read_matrix(const h5::Group& group, const char* name, std::size_t rows,
                         std::size_t columns) {
  return MatrixReader(group, name, rows, columns).read();
}

int read_dimension(const h5::Group& group) {
  const std::int64_t dimension = read_integer(group, "spacedim");
  if (dimension != 2 && dimension != 3 && dimension != 5)
    throw InputError(
        fmt::format("spacedim is {}, expected 2, 3, or 5 with rolling friction", dimension));
  return static_cast<int>(dimension);
}

/// Of problems with rolling friction; others have none.
std::vector<double> read_rolling(const h5::Group& group, int dimension) {
  if (dimension != 5 && !group.has("vectors/mu_r")) return {};
  return read_vector(group, "vectors/mu_r");
}

LocalProblem read_local(const h5::Group& group) {
  LocalProblem p;
  p.dimension = read_dimension(group);
  p.q = read_vector(group, "vectors/q");
  p.mu = read_vector(group, "vectors/mu");
  p.mu_r = read_rolling(group, p.dimension);
  p.W = read_matrix(group, "W", p.q.size(), p.q.size());
  if (group.has("V") != group.has("R"))
    throw InputError("only one of V and R is there, expected both or none");
  if (group.has("V")) {
    p.s = read_vector(group, "vectors/s");
    p.V = read_matrix(group, "V", p.q.size(), p.s.size());
    p.R = read_matrix(group, "R", p.s.size(), p.s.size());
  }
  return p;
}

GlobalProblem read_global(const h5::Group& group) {
  GlobalProblem p;
  p.dimension = read_dimension(group);
  p.f = read_vector(group, "vectors/f");
  p.w = read_vector(group, "vectors/w");
  p.mu = read_vector(group, "vectors/mu");
  p.mu_r = read_rolling(group, p.dimension);
  p.M = with_both_triangles(read_matrix(group, "M", p.f.size(), p.f.size()));
  p.H = read_matrix(group, "H", p.f.size(), p.w.size());
  if (group.has("G")) {
    p.b = read_vector(group, "vectors/b");
    p.G = read_matrix(group, "G", p.f.size(), p.b.size());
  }
  return p;
}

ProblemPoint read_point(const h5::Group& group, bool is_global) {
  const auto read = [&](const char* name) {
    return group.has(name) ? read_vector(group, name) : std::vector<double>{};
  };
  ProblemPoint point;
  if (is_global) point.v = read("v");
  point.u = read("u");
  point.r = read("r");
  point.l = read("l");
  return point;
}

std::vector<ProblemPoint> read_guesses(const h5::Group& group, bool is_global) {
  const std::int64_t count = read_integer(group, "number_of_guesses");
  if (count < 0)
    throw InputError(fmt::format("guesses/number_of_guesses is {}, expected 0 or more", count));
  std::vector<ProblemPoint> guesses;
  for (std::int64_t k = 1; k <= count; ++k)
    guesses.push_back(read_point(group.open_group(std::to_string(k)), is_global));
  return guesses;
}

// ---- writing -----------------------------------------------------------------------------------

void write_integer(h5::Group& group, const std::string& name, std::int32_t value) {
  group.write(name, std::span<const std::int32_t>(&value, 1));
}

void write_vector(h5::Group& group, const std::string& name, const std::vector<double>& values) {
  group.write(name, std::span<const double>(values));
}

void write_matrix(h5::Group& parent, const char* name, const SparseMatrix& a,
                  FclibStorage storage) {
  h5::Group group = parent.create_group(name);
  const SparseMatrix columns = storage == FclibStorage::columns ? transpose(a) : SparseMatrix{};
  const SparseMatrix& stored = storage == FclibStorage::columns ? columns : a;
  const auto put = [&](const char* key, const std::vector<std::int32_t>& values) {
    group.write(key, std::span<const std::int32_t>(values));
  };
  write_integer(group, "m", a.row_count);
  write_integer(group, "n", a.column_count);
  write_integer(group, "nzmax", a.entry_count());
  if (storage == FclibStorage::triplets) {
    std::vector<std::int32_t> row;
    row.reserve(a.value.size());
    for (std::int32_t r = 0; r < a.row_count; ++r)
      row.insert(row.end(), static_cast<std::size_t>(a.row_start[r + 1] - a.row_start[r]), r);
    write_integer(group, "nz", a.entry_count());
    put("i", row);
    put("p", a.column);
  } else {
    write_integer(group, "nz", storage == FclibStorage::columns ? -1 : -2);
    put("i", stored.column);
    put("p", stored.row_start);
  }
  write_vector(group, "x", stored.value);
}

/// Ends in a zero byte, which readers written in C rely on.
void write_text(h5::Group& group, const std::string& name, const std::string& text) {
  if (!text.empty()) group.write_text(name, text + '\0');
}

void write_info(h5::Group& group, const ProblemInfo& info) {
  if (info == ProblemInfo{}) return;
  h5::Group texts = group.create_group("info");
  write_text(texts, "title", info.title);
  write_text(texts, "description", info.description);
  write_text(texts, "math_info", info.math_info);
}

h5::Group write_form(h5::Group& root, const LocalProblem& p, FclibStorage storage) {
  h5::Group group = root.create_group(local_group);
  write_integer(group, "spacedim", p.dimension);
  write_matrix(group, "W", p.W, storage);
  h5::Group vectors = group.create_group("vectors");
  write_vector(vectors, "q", p.q);
  write_vector(vectors, "mu", p.mu);
  if (!p.mu_r.empty()) write_vector(vectors, "mu_r", p.mu_r);
  if (!p.s.empty()) {
    write_matrix(group, "V", p.V, storage);
    write_matrix(group, "R", p.R, storage);
    write_vector(vectors, "s", p.s);
  }
  return group;
}

h5::Group write_form(h5::Group& root, const GlobalProblem& p, FclibStorage storage) {
  h5::Group group = root.create_group(p.dimension == 5 ? rolling_group : global_group);
  write_integer(group, "spacedim", p.dimension);
  write_matrix(group, "M", p.M, storage);
  write_matrix(group, "H", p.H, storage);
  h5::Group vectors = group.create_group("vectors");
  write_vector(vectors, "f", p.f);
  write_vector(vectors, "w", p.w);
  write_vector(vectors, "mu", p.mu);
  if (!p.mu_r.empty()) write_vector(vectors, "mu_r", p.mu_r);
  if (!p.b.empty()) {
    write_matrix(group, "G", p.G, storage);
    write_vector(vectors, "b", p.b);
  }
  return group;
}

h5::Group write_form(h5::Group&, const BodyProblem&, FclibStorage) {
  throw InputError("FCLIB files hold no bodies: turn the problem into matrices first");
}

void write_point(h5::Group group, const ProblemPoint& point) {
  const auto write = [&](const char* name, const std::vector<double>& values) {
    if (!values.empty()) write_vector(group, name, values);
  };
  write("v", point.v);
  write("u", point.u);
  write("r", point.r);
  write("l", point.l);
}

}  // namespace

bool is_fclib(const h5::Group& root) {
  return root.has(local_group) || root.has(global_group) || root.has(rolling_group);
}

StoredProblem read_fclib(const h5::Group& root) {
  std::vector<const char*> found;
  for (const char* name : {local_group, global_group, rolling_group})
    if (root.has(name)) found.push_back(name);
  if (found.size() > 1)
    throw InputError(
        fmt::format("it holds both {} and {}, expected one problem", found[0], found[1]));
  const bool is_global = found.at(0) != local_group;
  const h5::Group group = root.open_group(found[0]);
  StoredProblem stored;
  if (is_global) {
    GlobalProblem global = read_global(group);
    if ((found[0] == rolling_group) != (global.dimension == 5))
      throw InputError(fmt::format("spacedim is {} in {}, expected 5 in {} and there alone",
                                   global.dimension, found[0], rolling_group));
    stored.form = std::move(global);
  } else {
    stored.form = read_local(group);
  }
  if (group.has("info")) {
    const h5::Group info = group.open_group("info");
    stored.info = {read_text(info, "title"), read_text(info, "description"),
                   read_text(info, "math_info")};
  }
  if (root.has("solution")) stored.solution = read_point(root.open_group("solution"), is_global);
  if (root.has("guesses")) stored.guesses = read_guesses(root.open_group("guesses"), is_global);
  return stored;
}

void write_fclib(h5::Group& root, const StoredProblem& problem, FclibStorage storage) {
  h5::Group group =
      std::visit([&](const auto& form) { return write_form(root, form, storage); }, problem.form);
  write_info(group, problem.info);
  if (problem.solution) write_point(root.create_group("solution"), *problem.solution);
  if (problem.guesses.empty()) return;
  h5::Group guesses = root.create_group("guesses");
  write_integer(guesses, "number_of_guesses", static_cast<std::int32_t>(problem.guesses.size()));
  for (std::size_t k = 0; k < problem.guesses.size(); ++k)
    write_point(guesses.create_group(std::to_string(k + 1)), problem.guesses[k]);
}

}  // namespace scree
